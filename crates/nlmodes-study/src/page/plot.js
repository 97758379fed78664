// A figure on a canvas with linear axes.

const PAD = { left: 78, right: 14, top: 10, bottom: 44 };

/// Round numbers between two others.
function ticks([low, high], wanted) {
  const raw = (high - low) / wanted, size = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map(factor => factor * size).find(s => s >= raw);
  const found = [];
  for (let k = Math.ceil(low / step); k * step <= high + 1e-9 * step; k++) found.push(Number((k * step).toPrecision(12)));
  return found;
}

/// The interval of all numbers, a little wider.
function span(values, share = 0.04) {
  let low = Infinity, high = -Infinity;
  for (const v of values) if (Number.isFinite(v)) { low = Math.min(low, v); high = Math.max(high, v); }
  if (low > high) return [0, 1];
  const room = high > low ? share * (high - low) : 0.02 * Math.abs(low) || 0.5;
  return [low - room, high + room];
}

class Plot {
  /// `paint(plot)` draws what lies within the axes; `near(plot, x, y)` says which row is at a place of the canvas.
  constructor(box, height, paint, near) {
    Object.assign(this, { height, paint, near, x: [0, 1], y: [0, 1], names: ["", ""] });
    this.canvas = element(box, "canvas", { tabindex: 0, role: "img" });
    this.said = element(box, "div", { class: "said", "aria-live": "polite" });
    this.canvas.addEventListener("mousemove", event => this.point(event, row => this.tell(row)));
    this.canvas.addEventListener("click", event => this.point(event, row => { if (row !== null) openCase(row); }));
    new ResizeObserver(() => this.draw()).observe(box);
  }

  point(event, act) {
    const place = this.canvas.getBoundingClientRect();
    act(this.near ? this.near(this, event.clientX - place.left, event.clientY - place.top) : null);
  }

  tell(row) {
    if (row === this.told) return;
    this.told = row;
    this.said.textContent = row === null ? "" : describe(row) + (DATA.links[row] ? " — click opens it" : "");
    this.draw();
  }

  px(x) { return PAD.left + (this.width - PAD.left - PAD.right) * (x - this.x[0]) / (this.x[1] - this.x[0]); }
  py(y) { return this.height - PAD.bottom - (this.height - PAD.top - PAD.bottom) * (y - this.y[0]) / (this.y[1] - this.y[0]); }

  draw() {
    const scale = window.devicePixelRatio || 1, style = getComputedStyle(document.documentElement);
    this.color = name => style.getPropertyValue("--" + name).trim();
    this.width = Math.max(280, this.canvas.parentElement.clientWidth - 24);
    Object.assign(this.canvas, { width: this.width * scale, height: this.height * scale });
    this.canvas.style.height = this.height + "px";
    const pen = this.pen = this.canvas.getContext("2d");
    pen.setTransform(scale, 0, 0, scale, 0, 0);
    pen.clearRect(0, 0, this.width, this.height);
    this.axes(pen);
    pen.save();
    pen.beginPath();
    pen.rect(PAD.left, PAD.top, this.width - PAD.left - PAD.right, this.height - PAD.top - PAD.bottom);
    pen.clip();
    this.paint(this);
    pen.restore();
  }

  axes(pen) {
    const bottom = this.height - PAD.bottom, right = this.width - PAD.right;
    pen.font = "13px system-ui, sans-serif";
    pen.strokeStyle = this.color("grid");
    pen.fillStyle = this.color("ink");
    const line = (a, b, c, d) => { pen.beginPath(); pen.moveTo(a, b); pen.lineTo(c, d); pen.stroke(); };
    pen.textAlign = "center";
    for (const x of ticks(this.x, Math.max(2, this.width / 110))) {
      line(this.px(x), PAD.top, this.px(x), bottom);
      pen.fillText(shown(x), this.px(x), bottom + 17);
    }
    pen.textAlign = "right";
    for (const y of ticks(this.y, Math.max(3, this.height / 55))) {
      line(PAD.left, this.py(y), right, this.py(y));
      pen.fillText(shown(y), PAD.left - 6, this.py(y) + 4);
    }
    pen.strokeStyle = this.color("quiet");
    pen.strokeRect(PAD.left, PAD.top, right - PAD.left, bottom - PAD.top);
    pen.textAlign = "center";
    pen.fillText(this.names[0], (PAD.left + right) / 2, this.height - 8);
    pen.save();
    pen.translate(13, (PAD.top + bottom) / 2);
    pen.rotate(-Math.PI / 2);
    pen.fillText(this.names[1], 0, 0);
    pen.restore();
  }

  path(x, y) {
    this.pen.beginPath();
    x.forEach((value, k) => this.pen[k ? "lineTo" : "moveTo"](this.px(value), this.py(y[k])));
    this.pen.stroke();
  }
}
