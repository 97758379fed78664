// A figure to zoom and to hover: panels above each other over one abscissa.
//
// spec: { name, x: {label, kind, view?}, panels: [{label, kind, curves, symbols, levels, view?}], height,
//         zoomY, describe(curve, index) -> lines, onHover(curve, index), onChoose(curve, index), table() -> [names, rows] }
// curve: { key, x, y, color, dash, width, breaks: Set of indices at which the curve does not come from the one before,
//          corners: Set of indices at which it may turn; without it the curve is straight from point to point }

const MARGIN = { left: 74, right: 16, top: 10, bottom: 46, gap: 14 };
const REACH = 40;
let chartCount = 0;

class Chart {
  constructor(box, spec) {
    Object.assign(this, { box, spec, hidden: new Set(), hovered: null, chosen: null, cursor: null, drag: null });
    this.clip = "clip-" + ++chartCount;
    this.full = { x: spec.x.view || this.extent("x"), y: spec.panels.map((panel, p) => panel.view || this.extent("y", p)) };
    this.reset(false);
    this.tools();
    const described = spec.name + ". Arrow keys go from point to point, plus and minus zoom, 0 shows all again.";
    this.svg = svg(box, "svg", { class: "chart", tabindex: 0, role: "application", "aria-label": described });
    this.tip = html(box, "div", { class: "tip", hidden: "" });
    this.said = html(box, "div", { class: "unseen", "aria-live": "polite" });
    this.listen();
    // The first report comes at once, about what is drawn already.
    this.observer = new ResizeObserver(() => Math.max(280, this.box.clientWidth || 640) !== this.size.width && this.draw());
    this.observer.observe(box);
    this.draw();
  }

  /// Takes the figure away.
  end() { this.observer.disconnect(); this.box.replaceChildren(); }

  extent(axis, p) {
    const panels = p === undefined ? this.spec.panels : [this.spec.panels[p]];
    const kind = axis === "x" ? this.spec.x.kind : panels[0].kind;
    const levels = axis === "y" ? panels[0].levels || [] : [];
    const places = panels.flatMap(panel => panel.curves.flatMap(curve => curve[axis].map(v => toPlace(kind, v))));
    return span(places.concat(levels.map(level => level.y)), axis === "x" ? this.spec.x.room ?? 0.04 : 0.07);
  }

  tools() {
    const bar = html(this.box, "div", { class: "tools" });
    const button = (text, name, act) => html(bar, "button", { type: "button", title: name, "aria-label": name }, text)
      .addEventListener("click", act);
    button("+", "Zoom in", () => this.zoom(0.6));
    button("−", "Zoom out", () => this.zoom(1 / 0.6));
    button("All", "All: show everything again (double click)", () => this.reset());
    button("SVG", "SVG: save this figure", () => saveFigure(this.svg, this.spec.name));
    if (this.spec.table) button("CSV", "CSV: save the numbers of this figure", () => saveTable(this.spec.table(), this.spec.name));
  }

  reset(draw = true) {
    this.view = { x: [...this.full.x], y: this.full.y.map(view => [...view]) };
    if (draw) this.draw();
  }

  isReset() {
    return this.view.x[0] === this.full.x[0] && this.view.x[1] === this.full.x[1]
      && this.view.y.every((view, p) => view[0] === this.full.y[p][0] && view[1] === this.full.y[p][1]);
  }

  // --- geometry

  layout() {
    const width = Math.max(280, this.box.clientWidth || 640);
    const n = this.spec.panels.length;
    const height = this.spec.height;
    this.size = { width, height: MARGIN.top + n * height + (n - 1) * MARGIN.gap + MARGIN.bottom };
    // Beside the name of the axis there is room for its longest number.
    const labels = this.spec.panels.flatMap((panel, p) => this.yTicks(panel, p, height)).filter(tick => tick.label);
    const left = Math.max(MARGIN.left, ...labels.map(tick => 32 + 2 * halfLabel(tick.label)));
    this.frames = this.spec.panels.map((_, p) => ({
      left, width: width - left - MARGIN.right, top: MARGIN.top + p * (height + MARGIN.gap), height,
    }));
  }

  yTicks(panel, p, height) { return ticks(panel.kind, this.view.y[p], Math.max(3, Math.round(height / 45))); }

  px(place) { const f = this.frames[0], [a, b] = this.view.x; return f.left + f.width * (place - a) / (b - a); }
  py(p, place) { const f = this.frames[p], [a, b] = this.view.y[p]; return f.top + f.height * (1 - (place - a) / (b - a)); }
  at(p, curve, index) {
    return [this.px(toPlace(this.spec.x.kind, curve.x[index])), this.py(p, toPlace(this.spec.panels[p].kind, curve.y[index]))];
  }

  // --- drawing

  draw() {
    this.layout();
    const { width, height } = this.size;
    fill(this.svg, null, { width, height, viewBox: `0 0 ${width} ${height}` });
    this.svg.replaceChildren();
    this.spec.panels.forEach((panel, p) => this.drawPanel(panel, p));
    const f = this.frames[0], last = this.frames[this.frames.length - 1];
    const place = { x: f.left + f.width / 2, y: last.top + last.height + 40, "text-anchor": "middle", class: "label" };
    svg(this.svg, "text", place, this.spec.x.label);
    this.overlay = svg(this.svg, "g", { class: "overlay" });
    this.drawOverlay();
  }

  drawPanel(panel, p) {
    const f = this.frames[p], lowest = p === this.frames.length - 1, bottom = f.top + f.height;
    const id = `${this.clip}-${p}`;
    svg(svg(this.svg, "clipPath", { id }), "rect", { x: f.left, y: f.top - 4, width: f.width, height: f.height + 8 });
    for (const tick of roomyTicks(this.spec.x.kind, this.view.x, f.width)) {
      const x = this.px(tick.place);
      svg(this.svg, "line", { x1: x, x2: x, y1: f.top, y2: bottom, class: tick.label ? "grid" : "grid fine" });
      if (!tick.label || !lowest) continue;
      const inside = Math.min(x, this.size.width - halfLabel(tick.label) - 2);
      svg(this.svg, "text", { x: inside, y: bottom + 18, "text-anchor": "middle", class: "tick x", "data-value": tick.value }, tick.label);
    }
    for (const tick of this.yTicks(panel, p, f.height)) {
      const y = this.py(p, tick.place);
      svg(this.svg, "line", { x1: f.left, x2: f.left + f.width, y1: y, y2: y, class: tick.label ? "grid" : "grid fine" });
      const label = { x: f.left - 7, y: y + 4, "text-anchor": "end", class: "tick y", "data-value": tick.value, "data-panel": p };
      if (tick.label) svg(this.svg, "text", label, tick.label);
    }
    svg(this.svg, "rect", { x: f.left, y: f.top, width: f.width, height: f.height, class: "frame" });
    const middle = `translate(16 ${f.top + f.height / 2}) rotate(-90)`;
    svg(this.svg, "text", { transform: middle, "text-anchor": "middle", class: "label" }, panel.label);
    const inside = svg(this.svg, "g", { "clip-path": `url(#${id})` });
    for (const level of panel.levels || []) {
      const y = this.py(p, level.y);
      svg(inside, "line", { x1: f.left, x2: f.left + f.width, y1: y, y2: y, class: level.class, stroke: level.stroke });
    }
    const taken = { places: [], symbols: [], boxes: [] };
    for (const curve of panel.curves) if (!this.hidden.has(curve.key)) this.drawCurve(inside, p, curve, taken);
    const marks = (panel.symbols || []).filter(mark => !this.hidden.has(mark.key));
    const named = marks.filter(mark => this.drawSymbol(inside, p, mark, taken) && mark.name);
    // What must be there takes its place first.
    for (const optional of [false, true]) {
      named.filter(mark => Boolean(mark.optional) === optional).forEach(mark => this.drawName(inside, p, mark, taken));
    }
  }

  drawCurve(parent, p, curve, taken) {
    let piece = [], corners = [];
    const finish = () => {
      const look = { class: "curve", stroke: curve.color, "stroke-dasharray": curve.dash, "stroke-width": curve.width || 2 };
      if (piece.length && curve.corners) svg(parent, "path", { d: smoothCourse(piece, corners), ...look });
      else if (piece.length) svg(parent, "polyline", { points: piece.map(at => at.map(v => v.toFixed(2)).join(",")).join(" "), ...look });
      // Of a cloud of many curves the names need not keep clear.
      if (taken.places.length < 8e3) for (const place of along(piece)) taken.places.push(place);
      [piece, corners] = [[], []];
    };
    curve.x.forEach((_, index) => {
      const [x, y] = this.at(p, curve, index);
      if (!Number.isFinite(x + y) || (curve.breaks && curve.breaks.has(index))) finish();
      // Browsers lose precision in coordinates that are millions of pixels away.
      const near = value => Math.max(-1e5, Math.min(1e5, value));
      if (!Number.isFinite(x + y)) return;
      if (curve.corners && curve.corners.has(index)) corners.push(piece.length);
      piece.push([near(x), near(y)]);
    });
    finish();
  }

  drawSymbol(parent, p, mark, taken) {
    const [x, y] = [this.px(toPlace(this.spec.x.kind, mark.x)), this.py(p, toPlace(this.spec.panels[p].kind, mark.y))];
    const f = this.frames[p];
    if (!(x > f.left - 20 && x < f.left + f.width + 20 && y > f.top - 20 && y < f.top + f.height + 20)) return false;
    symbol(parent, mark.shape, x, y, mark.fill, mark.title, mark.open);
    taken.symbols.push([x, y]);
    return true;
  }

  /// The name of a symbol where it covers least.
  drawName(parent, p, mark, taken) {
    const at = [this.px(toPlace(this.spec.x.kind, mark.x)), this.py(p, toPlace(this.spec.panels[p].kind, mark.y))];
    const box = namePlace(at, { width: 7.4 * mark.name.length + 4, height: 15 }, this.frames[p], taken, !mark.optional);
    if (!box) return;
    taken.boxes.push(box);
    if (box.far) {
      const end = { x2: Math.max(box.x, Math.min(box.x + box.width, at[0])), y2: Math.max(box.y, Math.min(box.y + box.height, at[1])) };
      svg(parent, "line", { x1: at[0], y1: at[1], ...end, class: "leader" });
    }
    svg(parent, "text", { x: box.x + box.width / 2, y: box.y + 12, "text-anchor": "middle", class: "name" }, mark.name);
  }

  drawOverlay() {
    this.overlay.replaceChildren();
    const ring = (found, name, radius) => {
      if (!found || this.hidden.has(found.key)) return;
      const p = found.panel || 0, curve = this.spec.panels[p].curves.find(c => c.key === found.key && c.describes !== false);
      if (!curve) return;
      const [x, y] = this.at(p, curve, found.index), f = this.frames[p];
      const inside = x >= f.left - 1 && x <= f.left + f.width + 1 && y >= f.top - 5 && y <= f.top + f.height + 5;
      if (inside) svg(this.overlay, "circle", { cx: x, cy: y, r: radius, class: name, stroke: curve.color });
    };
    ring(this.chosen, "chosen", 8);
    ring(this.hovered, "hovered", 5.5);
    if (this.cursor !== null) {
      const x = this.px(this.cursor), f = this.frames[0], last = this.frames[this.frames.length - 1];
      const inside = x >= f.left && x <= f.left + f.width;
      if (inside) svg(this.overlay, "line", { x1: x, x2: x, y1: f.top, y2: last.top + last.height, class: "cursor" });
    }
    if (this.drag && this.drag.box) svg(this.overlay, "rect", { ...this.drag.box, class: "selection" });
  }

  moveCursor(place) { this.cursor = place; this.drawOverlay(); }
  choose(key, index) { this.chosen = { key, index }; this.drawOverlay(); }
  hide(key, hidden) { this.hidden[hidden ? "add" : "delete"](key); this.draw(); }

  // --- hovering

  nearest(x, y) {
    let best = null, least = REACH ** 2;
    const single = this.spec.panels.length === 1 && !this.spec.alongX;
    this.spec.panels.forEach((panel, p) => {
      const f = this.frames[p];
      if (y < f.top - 6 || y > f.top + f.height + 6) return;
      for (const curve of panel.curves) {
        if (this.hidden.has(curve.key) || curve.describes === false) continue;
        for (let index = 0; index < curve.x.length; index++) {
          const [cx, cy] = this.at(p, curve, index);
          const distance = (cx - x) ** 2 + (single ? (cy - y) ** 2 : 1e-3 * (cy - y) ** 2);
          if (distance < least) { least = distance; best = { key: curve.key, index, panel: p, curve }; }
        }
      }
    });
    return best && { ...best, at: [x, y] };
  }

  hover(found, tell = true) {
    this.hovered = found;
    this.drawOverlay();
    this.tip.hidden = !found || !tell;
    if (found && tell) this.showTip(found);
    if (tell && this.spec.onHover) this.spec.onHover(found);
  }

  showTip(found) {
    const curve = found.curve || this.spec.panels[found.panel || 0].curves.find(c => c.key === found.key);
    const lines = this.spec.describe(curve, found.index);
    this.tip.replaceChildren();
    lines.forEach((line, k) => html(this.tip, "div", { class: k ? "" : "head" }, line));
    this.said.textContent = lines.join(", ");
    // At the pointer, or at the point where the keyboard chose it.
    const [x, y] = found.at || this.at(found.panel || 0, curve, found.index);
    const offset = this.svg.getBoundingClientRect().top - this.box.getBoundingClientRect().top, room = this.tip.offsetWidth + 18, tall = this.tip.offsetHeight;
    this.tip.style.left = (x + room > this.size.width ? Math.max(0, x - room) : x + 16) + "px";
    // Above the pointer, below it, or beside it: wherever it is in view.
    const top = this.svg.getBoundingClientRect().top, above = y - tall - 12, below = y + 18;
    const inView = place => top + place >= 4 && top + place + tall <= window.innerHeight - 4;
    const beside = Math.max(4 - top, Math.min(window.innerHeight - 4 - tall - top, y - tall / 2));
    const place = above >= 0 && inView(above) ? above : inView(below) ? below : inView(above) ? above : beside;
    this.tip.style.top = offset + place + "px";
  }

  // --- zooming

  /// Scales the view about a pixel, the middle if there is none; the values there stay.
  zoom(factor, x, y) {
    const f = this.frames[0];
    this.view.x = rescaled(this.view.x, this.full.x, x === undefined ? 0.5 : (x - f.left) / f.width, factor);
    if (this.spec.zoomY) {
      const share = y === undefined ? 0.5 : (f.top + f.height - y) / f.height;
      this.view.y[0] = rescaled(this.view.y[0], this.full.y[0], share, factor);
    }
    this.hover(null);
    this.draw();
  }

  pan(dx, dy) {
    const f = this.frames[0], shift = (view, full, share) => {
      const way = Math.max(full[0] - view[0], Math.min(full[1] - view[1], share * (view[1] - view[0])));
      return [view[0] + way, view[1] + way];
    };
    this.view.x = shift(this.view.x, this.full.x, -dx / f.width);
    if (this.spec.zoomY) this.view.y[0] = shift(this.view.y[0], this.full.y[0], dy / f.height);
    this.draw();
  }

  zoomTo({ x, y, width, height }) {
    const f = this.frames[0], part = (view, from, to) => {
      const length = view[1] - view[0], next = [view[0] + from * length, view[0] + to * length];
      return isFine(next) ? next : view;
    };
    this.view.x = part(this.view.x, (x - f.left) / f.width, (x + width - f.left) / f.width);
    if (this.spec.zoomY && height < f.height) {
      const bottom = f.top + f.height;
      this.view.y[0] = part(this.view.y[0], (bottom - y - height) / f.height, (bottom - y) / f.height);
    }
    this.draw();
  }

  // --- input

  listen() {
    const place = event => { const r = this.svg.getBoundingClientRect(); return [event.clientX - r.left, event.clientY - r.top]; };
    this.svg.addEventListener("wheel", event => {
      const [x, y] = place(event), f = this.frames[0];
      // At full view the wheel outwards scrolls the page.
      if (x < f.left || x > f.left + f.width || (event.deltaY > 0 && this.isReset())) return;
      event.preventDefault();
      this.zoom(Math.exp(Math.max(-0.5, Math.min(0.5, event.deltaY * 0.002))), x, y);
    }, { passive: false });
    this.svg.addEventListener("pointerdown", event => {
      if (event.button !== 0) return;
      const [x, y] = place(event);
      this.drag = { from: [x, y], last: [x, y], pans: event.shiftKey || event.pointerType === "touch", box: null };
      this.svg.setPointerCapture(event.pointerId);
    });
    this.svg.addEventListener("pointermove", event => this.pointerMoves(...place(event)));
    this.svg.addEventListener("pointerup", event => this.pointerUp(...place(event)));
    this.svg.addEventListener("pointercancel", () => { this.drag = null; this.drawOverlay(); });
    this.svg.addEventListener("pointerleave", () => this.hover(null));
    this.svg.addEventListener("dblclick", () => this.reset());
    this.svg.addEventListener("keydown", event => this.key(event));
    this.svg.addEventListener("blur", () => this.hover(null));
  }

  pointerMoves(x, y) {
    if (!this.drag) { this.hover(this.nearest(x, y)); return; }
    const [x0, y0] = this.drag.from;
    if (Math.hypot(x - x0, y - y0) < 6 && !this.drag.moved) return;
    this.drag.moved = true;
    if (this.drag.pans) {
      this.pan(x - this.drag.last[0], y - this.drag.last[1]);
      this.drag.last = [x, y];
      return;
    }
    const f = this.frames[0], last = this.frames[this.frames.length - 1], bottom = last.top + last.height;
    const inX = v => Math.max(f.left, Math.min(f.left + f.width, v)), inY = v => Math.max(f.top, Math.min(bottom, v));
    const flat = !this.spec.zoomY || Math.abs(y - y0) < 12;
    const [left, right] = [inX(Math.min(x, x0)), inX(Math.max(x, x0))];
    const [top, low] = flat ? [f.top, bottom] : [inY(Math.min(y, y0)), inY(Math.max(y, y0))];
    this.drag.box = { x: left, y: top, width: right - left, height: low - top };
    this.hover(null);
  }

  pointerUp(x, y) {
    const drag = this.drag;
    this.drag = null;
    if (!drag) return;
    if (drag.box && drag.box.width > 5) this.zoomTo(drag.box);
    else if (!drag.moved) {
      const found = this.nearest(x, y);
      if (found && this.spec.onChoose) this.spec.onChoose(found.key, found.index);
    }
    this.drawOverlay();
  }

  key(event) {
    const steps = { ArrowRight: 1, ArrowLeft: -1, PageDown: 10, PageUp: -10, End: Infinity, Home: -Infinity };
    const acts = {
      "+": () => this.zoom(0.6), "=": () => this.zoom(0.6), "-": () => this.zoom(1 / 0.6), 0: () => this.reset(),
      Escape: () => this.hover(null),
      ArrowUp: () => this.stepCurve(1), ArrowDown: () => this.stepCurve(-1),
      Enter: () => this.hovered && this.spec.onChoose && this.spec.onChoose(this.hovered.key, this.hovered.index),
    };
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (steps[event.key]) {
      if (event.shiftKey && event.key.startsWith("Arrow")) this.pan(-0.2 * steps[event.key] * this.frames[0].width, 0);
      else this.step(steps[event.key]);
    } else if (acts[event.key]) acts[event.key]();
    else return;
    event.preventDefault();
  }

  described() { return this.spec.panels[0].curves.filter(c => c.describes !== false && !this.hidden.has(c.key)); }

  step(by) {
    const curves = this.described();
    const now = this.hovered || this.chosen;
    const curve = curves.find(c => now && c.key === now.key) || curves[0];
    if (!curve) return;
    const from = now && now.key === curve.key ? now.index : by > 0 ? -1 : curve.x.length;
    this.hover({ key: curve.key, curve, index: Math.max(0, Math.min(curve.x.length - 1, from + by)) });
  }

  stepCurve(by) {
    const curves = this.described(), now = this.hovered || this.chosen;
    const at = curves.findIndex(c => now && c.key === now.key), next = curves[at + by];
    if (next) this.hover({ key: next.key, curve: next, index: Math.min(next.x.length - 1, now.index) });
  }
}

/// An interval scaled about its point at `share`, within the full one.
function rescaled(view, full, share, factor) {
  const pivot = view[0] + share * (view[1] - view[0]);
  const next = [pivot + (view[0] - pivot) * factor, pivot + (view[1] - pivot) * factor];
  if (factor > 1 && next[1] - next[0] >= full[1] - full[0]) return [...full];
  if (!isFine(next)) return view;
  const shift = Math.max(0, full[0] - next[0]) - Math.max(0, next[1] - full[1]);
  return [next[0] + shift, next[1] + shift];
}

/// Whether doubles resolve the interval well enough for its ticks.
const isFine = ([a, b]) => b - a > 1e-11 * Math.max(1, Math.abs(a), Math.abs(b));
