// A structure in space as it moves over one period: its edges, and the force at each contact. Drag to turn it.

const WIRE = { height: 460, margin: 40, turn: 0.02 };

class Wire {
  constructor(box, data) {
    Object.assign(this, { data, azimuth: 0.6, elevation: 0.45, zoom: 1 });
    this.places = unpacked(data.places);
    Object.assign(this, { cosines: unpackedRows(data.cosines), sines: unpackedRows(data.sines), forces: unpackedRows(data.forces) });
    this.measure();
    this.canvas = html(box, "canvas", { class: "wire", tabindex: 0, role: "img", "aria-label": `Wireframe of the motion at ${data.name}; arrows turn it` });
    const controls = html(box, "div", { class: "controls" });
    this.player = new Player(controls, () => this.draw());
    this.player.slider("displacement", { min: -2, max: 1, step: 0.05, value: 0 }, power => { this.scale = this.natural * 10 ** power; });
    this.reading = html(controls, "output", { class: "reading" });
    this.listen();
  }

  /// Middle and half of the diagonal of the structure, and by how much displacements are drawn larger.
  measure() {
    const low = [0, 1, 2].map(a => this.places.reduce((least, v, i) => (i % 3 === a ? Math.min(least, v) : least), Infinity));
    const high = [0, 1, 2].map(a => this.places.reduce((most, v, i) => (i % 3 === a ? Math.max(most, v) : most), -Infinity));
    this.middle = low.map((v, a) => (v + high[a]) / 2);
    this.radius = Math.hypot(...high.map((v, a) => v - low[a])) / 2 || 1;
    const most = this.cosines.concat(this.sines).reduce((sum, row) => sum + largest(row), 0);
    this.natural = most > 0 ? 0.3 * this.radius / most : 1;
    this.strongest = Math.max(...this.forces.map(largest), 0);
    this.scale = this.natural;
  }

  listen() {
    const canvas = this.canvas;
    canvas.addEventListener("pointerdown", event => { canvas.setPointerCapture(event.pointerId); this.held = [event.clientX, event.clientY]; });
    canvas.addEventListener("pointermove", event => {
      if (!this.held) return;
      this.turn(0.5 * (event.clientX - this.held[0]), 0.5 * (event.clientY - this.held[1]));
      this.held = [event.clientX, event.clientY];
    });
    for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, () => { this.held = null; });
    canvas.addEventListener("wheel", event => { event.preventDefault(); this.zoom *= 1.001 ** -event.deltaY; this.draw(); }, { passive: false });
    canvas.addEventListener("dblclick", () => { Object.assign(this, { azimuth: 0.6, elevation: 0.45, zoom: 1 }); this.draw(); });
    canvas.addEventListener("keydown", event => {
      const by = { ArrowLeft: [-4, 0], ArrowRight: [4, 0], ArrowUp: [0, -4], ArrowDown: [0, 4] }[event.key];
      if (by) { event.preventDefault(); this.turn(...by); }
    });
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  turn(across, down) {
    this.azimuth += WIRE.turn * across;
    this.elevation = Math.max(-Math.PI / 2, Math.min(Math.PI / 2, this.elevation + WIRE.turn * down));
    this.draw();
  }

  /// Displacements at this phase, x, y, z of one corner after the other.
  displacements() {
    const u = new Float64Array(this.places.length);
    const add = (row, factor) => row.forEach((q, i) => { u[i] += factor * q; });
    this.cosines.forEach((row, n) => add(row, Math.cos(2 * Math.PI * n * this.player.phase)));
    this.sines.forEach((row, n) => add(row, Math.sin(2 * Math.PI * (n + 1) * this.player.phase)));
    return u;
  }

  /// Forces at this phase, between the phases that are known in proportion.
  forcesNow() {
    const phases = this.data.phases, last = phases.length - 1, at = this.player.phase;
    let before = 0;
    while (before < last && phases[before + 1] <= at) before += 1;
    const next = before === last ? 1 : phases[before + 1], share = (at - phases[before]) / Math.max(1e-12, next - phases[before]);
    const after = this.forces[before === last ? 0 : before + 1] || [];
    return (this.forces[before] || []).map((f, i) => (1 - share) * f + share * (after[i] || 0));
  }

  draw() {
    const { canvas, data } = this, width = canvas.clientWidth || 760, height = WIRE.height, dots = window.devicePixelRatio || 1;
    if (canvas.width !== Math.round(width * dots)) { canvas.width = Math.round(width * dots); canvas.height = Math.round(height * dots); }
    const pen = canvas.getContext("2d"), style = getComputedStyle(canvas), ink = name => style.getPropertyValue(name).trim();
    pen.setTransform(dots, 0, 0, dots, 0, 0);
    pen.clearRect(0, 0, width, height);
    const [ca, sa, ce, se] = [Math.cos(this.azimuth), Math.sin(this.azimuth), Math.cos(this.elevation), Math.sin(this.elevation)];
    const size = this.zoom * (Math.min(width, height) / 2 - WIRE.margin) / this.radius * 1.25;
    const screen = (x, y, z) => [width / 2 + size * (x * ca - y * sa), height / 2 - size * (z * ce + (x * sa + y * ca) * se)];
    const u = this.displacements(), [mx, my, mz] = this.middle, p = this.places;
    const at = (i, k) => screen(p[3 * i] - mx + k * u[3 * i], p[3 * i + 1] - my + k * u[3 * i + 1], p[3 * i + 2] - mz + k * u[3 * i + 2]);
    const lines = (k, color, thickness, opacity) => {
      pen.beginPath();
      for (let e = 0; e < data.edges.length; e += 2) { pen.moveTo(...at(data.edges[e], k)); pen.lineTo(...at(data.edges[e + 1], k)); }
      Object.assign(pen, { strokeStyle: color, lineWidth: thickness, globalAlpha: opacity });
      pen.stroke();
      pen.globalAlpha = 1;
    };
    lines(0, ink("--quiet"), 1, 0.35);
    lines(this.scale, ink("--accent"), 1.4, 1);
    this.drawForces(pen, at, screen, ink, this.forcesNow());
  }

  /// A dot at each contact, filled where it is closed, with an arrow as long as its force is large.
  drawForces(pen, at, screen, ink, forces) {
    let most = 0;
    const origin = screen(0, 0, 0), arrow = this.strongest > 0 ? 0.45 * this.radius / this.strongest : 0;
    this.data.contacts.forEach((corner, k) => {
      const f = [forces[3 * k] || 0, forces[3 * k + 1] || 0, forces[3 * k + 2] || 0], force = Math.hypot(...f);
      const [x, y] = at(corner, this.scale), closed = force > 1e-3 * this.strongest;
      most = Math.max(most, force);
      pen.beginPath();
      pen.arc(x, y, closed ? 4 : 2.5, 0, 2 * Math.PI);
      pen.fillStyle = closed ? ink("--contact") : ink("--quiet");
      pen.fill();
      if (!closed) return;
      // The arrow pushes: it ends where it acts.
      const [dx, dy] = screen(...f.map(v => v * arrow)).map((v, a) => v - origin[a]), length = Math.hypot(dx, dy);
      pen.beginPath();
      pen.moveTo(x - dx, y - dy);
      pen.lineTo(x, y);
      if (length > 6) {
        const [tx, ty] = [dx / length * 7, dy / length * 7];
        pen.moveTo(x - tx - ty / 2, y - ty + tx / 2);
        pen.lineTo(x, y);
        pen.lineTo(x - tx + ty / 2, y - ty - tx / 2);
      }
      Object.assign(pen, { strokeStyle: ink("--contact"), lineWidth: 2 });
      pen.stroke();
    });
    const unit = prefixed("N", this.strongest), drawn = significant(this.scale, 2);
    this.reading.textContent = `largest force ${significant(most * unit.perSi, 3)} ${unit.symbol}; displacements × ${drawn}`;
  }
}
