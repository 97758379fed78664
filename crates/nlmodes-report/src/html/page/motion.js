// The structure as it moves over one period.

const TRAIL = 16;
const SIZE = { width: 620, height: 320, left: 74, right: 26, top: 16, bottom: 46, bar: 64 };

class Motion {
  constructor(box, controls) {
    Object.assign(this, { box, frame: null });
    this.svg = svg(box, "svg", { class: "motion", viewBox: `0 0 ${SIZE.width} ${SIZE.height}`, role: "img" });
    this.player = new Player(controls, () => this.draw());
    this.player.slider("speed", { min: -2, max: 2, step: 0.25, value: 0, class: "speed" }, power => { this.player.speed = 2 ** power; });
    this.reading = html(controls, "output", { class: "reading" });
  }

  /// Shows the motion of a point, or of the nearest one that the page holds; returns which.
  show(branch, point) {
    const motion = branch.motion;
    this.frame = null;
    if (!motion || !motion.points.length) { this.svg.replaceChildren(); return null; }
    const k = motion.points.reduce((best, at, i) => (Math.abs(at - point) < Math.abs(motion.points[best] - point) ? i : best), 0);
    const packed = motion.frames[k], coefficients = rows => rows && unpackedRows(rows, motion.x.length);
    this.motion = motion;
    this.frame = { re: coefficients(packed.motion[0]), im: coefficients(packed.motion[1]) };
    this.frame.contacts = packed.contacts.map(c => c && { t: unpacked(c.phase), u: unpacked(c.displacement), f: unpacked(c.force) });
    this.prepare();
    this.draw();
    return motion.points[k];
  }

  /// Displacements of all stations at a phase from 0 to 1.
  shape(phase) {
    const { re, im } = this.frame, { stops, x } = this.motion;
    const cos = [], sin = [];
    const width = [...re, ...(im || [])].reduce((most, row) => Math.max(most, row.length), 0);
    for (let n = 0; n < width; n++) { cos.push(Math.cos(2 * Math.PI * n * phase)); sin.push(Math.sin(2 * Math.PI * n * phase)); }
    const values = x.map((_, d) => {
      let sum = 0;
      re[d].forEach((q, n) => { sum += q * cos[n]; });
      if (im) im[d].forEach((q, n) => { sum -= q * sin[n]; });
      return sum;
    });
    // Contacts as the contact problem gives them, which no few harmonics do.
    stops.forEach((stop, k) => {
      const exact = this.frame.contacts[k];
      if (exact) values[stop.station] = between(exact.t, exact.u, phase);
    });
    return values;
  }

  prepare() {
    const { x, stops, isAxial, word } = this.motion, s = SIZE;
    const shapes = Array.from({ length: TRAIL }, (_, k) => this.shape(k / TRAIL));
    const all = shapes.flat().concat(stops.map(stop => stop.at));
    const dense = Array.from({ length: 96 }, (_, k) => this.shape(k / 96)).flat();
    const [low, high] = span(all.concat(dense, [0]), 0.12);
    this.unit = fine(word === "rotation" ? "rad" : "m", largest([low, high]));
    const top = s.top + (isAxial ? s.bar + 34 : 0), bottom = s.height - s.bottom;
    const [x0, x1] = [Math.min(...x), Math.max(...x)];
    this.px = value => s.left + (s.width - s.left - s.right) * (value - x0) / (x1 - x0 || 1);
    this.py = value => bottom - (bottom - top) * (value - low) / (high - low);
    this.svg.replaceChildren();
    this.svg.setAttribute("aria-label", `Motion over one period: ${word} over position along the structure`);
    const lengthUnit = fine("m", x1);
    for (const tick of ticks("linear", [low * this.unit.perSi, high * this.unit.perSi], isAxial ? 4 : 6)) {
      const y = this.py(tick.value / this.unit.perSi);
      svg(this.svg, "line", { x1: s.left, x2: s.width - s.right, y1: y, y2: y, class: tick.value === 0 ? "grid rest" : "grid" });
      svg(this.svg, "text", { x: s.left - 7, y: y + 4, "text-anchor": "end", class: "tick" }, tick.label);
    }
    for (const tick of ticks("linear", [x0 * lengthUnit.perSi, x1 * lengthUnit.perSi], 8)) {
      const at = { x: this.px(tick.value / lengthUnit.perSi), y: bottom + 18, "text-anchor": "middle", class: "tick" };
      svg(this.svg, "text", at, tick.label);
    }
    const middle = (s.left + s.width - s.right) / 2;
    svg(this.svg, "text", { x: middle, y: bottom + 40, "text-anchor": "middle", class: "label" }, `position in ${lengthUnit.symbol}`);
    const turned = `translate(16 ${(top + bottom) / 2}) rotate(-90)`;
    svg(this.svg, "text", { transform: turned, "text-anchor": "middle", class: "label" }, `${word} in ${this.unit.symbol}`);
    for (const shape of shapes) svg(this.svg, "polyline", { points: this.line(shape), class: "trail" });
    if (isAxial) this.prepareBar(dense, x0, x1);
    this.drawStops(bottom, top);
    this.now = svg(this.svg, "polyline", { class: "structure" });
    this.clamps();
    this.dots = stops.map(() => svg(this.svg, "circle", { class: "contact", r: 6 }));
    this.arrows = stops.map(() => svg(this.svg, "path", { class: "force" }));
    this.mostForce = largest(this.frame.contacts.flatMap(contact => (contact ? contact.f : [])));
  }

  line(shape) {
    return shape.map((value, d) => this.px(this.motion.x[d]).toFixed(2) + "," + this.py(value).toFixed(2)).join(" ");
  }

  /// A wall at each stop, hatched on its far side.
  drawStops() {
    for (const stop of this.motion.stops) {
      const [x, y] = [this.px(this.motion.x[stop.station]), this.py(stop.at)], away = stop.side > 0 ? -1 : 1;
      const right = Math.min(SIZE.width - 4, x + 22), left = x - 22;
      svg(this.svg, "line", { x1: left, x2: right, y1: y, y2: y, class: "stop", stroke: stopColor(stop.number) });
      for (let at = left + 4; at <= right; at += 8) {
        svg(this.svg, "line", { x1: at, y1: y, x2: Math.min(right, at + 6), y2: y + away * 8, class: "hatch", stroke: stopColor(stop.number) });
      }
    }
  }

  clamps() {
    const { x, held } = this.motion;
    for (const d of held) {
      const [at, y] = [this.px(x[d]), this.py(0)];
      svg(this.svg, "rect", { x: at - 5, y: y - 14, width: 5, height: 28, class: "clamp" });
    }
  }

  /// The body itself, displaced along its axis, in pieces that are shaded by their strain.
  prepareBar(dense, x0, x1) {
    const { x, stops } = this.motion, s = SIZE, [top, bottom] = [s.top + 22, s.top + s.bar + 4];
    const room = (x1 - x0) * 0.16 / Math.max(largest(dense.concat(stops.map(stop => stop.at))), 1e-300);
    const low = x0 - 0.02 * (x1 - x0), high = x1 + 0.2 * (x1 - x0);
    this.bx = value => s.left + (s.width - s.left - s.right) * (value - low) / (high - low);
    this.barScale = room;
    this.pieces = x.slice(1).map(() => svg(this.svg, "polygon", { class: "piece" }));
    this.barEnds = [top, bottom];
    for (const stop of stops) {
      const at = this.bx(x[stop.station] + room * stop.at), away = stop.side > 0 ? 1 : -1;
      svg(this.svg, "line", { x1: at, x2: at, y1: top - 8, y2: bottom + 8, class: "stop", stroke: stopColor(stop.number) });
      for (let y = top - 6; y <= bottom + 4; y += 8) svg(this.svg, "line", { x1: at, y1: y, x2: at + away * 8, y2: y + 6, class: "hatch", stroke: stopColor(stop.number) });
    }
    for (const d of this.motion.held) {
      svg(this.svg, "rect", { x: this.bx(x[d]) - (d === 0 ? 6 : 0), y: top - 8, width: 6, height: bottom - top + 16, class: "clamp" });
    }
    const key = { x: s.width - s.right, y: s.top + 6, "text-anchor": "end", class: "tick" };
    svg(this.svg, "text", key, "blue: compressed, orange: stretched, motion enlarged or reduced to fit");
    const strains = Array.from({ length: 24 }, (_, k) => this.strains(this.shape(k / 24))).flat();
    this.mostStrain = largest(strains) || 1;
  }

  strains(shape) {
    const { x } = this.motion;
    return x.slice(1).map((at, d) => (shape[d + 1] - shape[d]) / (at - x[d]));
  }

  draw() {
    if (!this.frame) return;
    const phase = this.player.phase, shape = this.shape(phase), { stops, x, isAxial } = this.motion;
    this.now.setAttribute("points", this.line(shape));
    if (isAxial) this.drawBar(shape);
    stops.forEach((stop, k) => {
      const contact = this.frame.contacts[k], force = contact ? between(contact.t, contact.f, phase) : 0;
      const closed = contact ? force > 1e-6 * this.mostForce && this.mostForce > 0 : false;
      const [at, y] = [this.px(x[stop.station]), this.py(shape[stop.station])];
      fill(this.dots[k], null, { cx: at.toFixed(2), cy: y.toFixed(2), class: closed ? "contact closed" : "contact" });
      const length = this.mostForce > 0 ? 46 * force / this.mostForce : 0, away = stop.side > 0 ? 1 : -1;
      const tip = y + away * (8 + length), head = tip - away * 7;
      const path = `M${at} ${y + away * 7}V${tip}M${at - 4.5} ${head}L${at} ${tip}L${at + 4.5} ${head}`;
      this.arrows[k].setAttribute("d", length > 1 ? path : "");
    });
    this.read(shape);
    if (this.onPhase) this.onPhase(phase);
  }

  drawBar(shape) {
    const [top, bottom] = this.barEnds, { x } = this.motion;
    const at = x.map((place, d) => this.bx(place + this.barScale * shape[d]).toFixed(2));
    this.strains(shape).forEach((strain, d) => {
      const share = Math.max(-1, Math.min(1, strain / this.mostStrain));
      const attributes = { points: `${at[d]},${top} ${at[d + 1]},${top} ${at[d + 1]},${bottom} ${at[d]},${bottom}` };
      fill(this.pieces[d], null, { ...attributes, fill: strainColor(share), stroke: strainColor(share) });
    });
  }

  read(shape) {
    const degrees = Math.round(360 * this.player.phase) % 360;
    const stop = this.motion.stops[0];
    const value = stop && shape[stop.station] * this.unit.perSi;
    const node = this.motion.stops.length > 1 ? `contact node of stop ${stop.number}` : "contact node";
    this.reading.textContent = `${degrees}°` + (stop ? `, ${node} at ${significant(value, 4)} ${this.unit.symbol}` : "");
  }
}

const STOP_COLORS = ["#332288", "#882255", "#117733", "#999933", "#aa4499", "#44aa99", "#661100"];
/// The colours repeat; what has one again is dashed.
const stopDash = number => (number >= STOP_COLORS.length ? "6 3" : undefined);
const stopColor = number => STOP_COLORS[number % STOP_COLORS.length];

/// Value of a series over one period, given at ascending phases from 0 to 1.
function between(phases, values, phase) {
  const at = phase - Math.floor(phase);
  let [low, high] = [0, phases.length - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (phases[middle] <= at) low = middle; else high = middle;
  }
  const width = phases[high] - phases[low];
  return values[low] + (width > 0 ? (values[high] - values[low]) * (at - phases[low]) / width : 0);
}

/// Blue in compression, grey at rest, orange in tension.
function strainColor(share) {
  const [r, g, b] = share < 0 ? [0, 114, 178] : [213, 94, 0], weight = Math.abs(share) ** 0.8;
  const mixed = channel => Math.round(205 + (channel - 205) * weight);
  return `rgb(${mixed(r)},${mixed(g)},${mixed(b)})`;
}
