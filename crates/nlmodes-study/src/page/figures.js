// Scatter, histogram, and all branches.

/// What there is to say about a case.
function describe(row) {
  const names = [...DATA.variables, ...DATA.quantities, "status"];
  const value = name => { const cell = column(name).cells[row]; return typeof cell === "number" ? shown(cell) : cell ?? "–"; };
  return `${caseName(row)}: ` + names.map(name => `${name} ${value(name)}`).join(", ");
}

/// Rows that have both numbers.
const rowsOf = (a, b) => a.map((_, row) => row).filter(row => a[row] !== null && b[row] !== null);

function scatter(box) {
  element(box, "h3", {}, "One over the other");
  const controls = element(box, "div", { class: "controls" });
  const names = numeric.map(found => found.name);
  const chosen = { x: names.find(name => DATA.variables.includes(name)) || names[0], y: DATA.quantities[0] || names[names.length - 1] };
  let rows = [], x = [], y = [], band = null;
  const near = (plot, px, py) => {
    let best = null, least = 12 ** 2;
    for (const row of rows) {
      const d = (plot.px(x[row]) - px) ** 2 + (plot.py(y[row]) - py) ** 2;
      if (d < least) [best, least] = [row, d];
    }
    return best;
  };
  const plot = new Plot(box, 360, plot => {
    const pen = plot.pen, size = rows.length > 3000 ? 1.2 : rows.length > 600 ? 1.8 : 2.6;
    pen.fillStyle = plot.color("accent");
    pen.globalAlpha = rows.length > 600 ? 0.45 : 0.8;
    for (const row of rows) { pen.beginPath(); pen.arc(plot.px(x[row]), plot.py(y[row]), size, 0, 7); pen.fill(); }
    pen.globalAlpha = 1;
    if (band) {
      pen.strokeStyle = plot.color("band");
      band.lines.forEach((line, k) => { pen.lineWidth = k === 1 ? 2.2 : 1.4; pen.setLineDash(k === 1 ? [] : [5, 4]); plot.path(band.x, line); });
      pen.setLineDash([]);
    }
    if (plot.told !== null && plot.told !== undefined && rows.includes(plot.told)) {
      pen.strokeStyle = plot.color("band");
      pen.lineWidth = 2;
      pen.beginPath(); pen.arc(plot.px(x[plot.told]), plot.py(y[plot.told]), 7, 0, 7); pen.stroke();
    }
  }, near);
  const update = () => {
    [x, y] = [column(chosen.x).cells, column(chosen.y).cells];
    rows = rowsOf(x, y);
    band = percentiles(rows, x, y);
    Object.assign(plot, { names: [label(chosen.x), label(chosen.y)], x: span(rows.map(row => x[row])), y: span(rows.map(row => y[row])) });
    plot.draw();
  };
  choice(controls, "across", names, chosen.x, name => { chosen.x = name; update(); });
  choice(controls, "up", names, chosen.y, name => { chosen.y = name; update(); });
  element(controls, "span", { class: "quiet" }, "lines: median, 5 and 95 % of neighbours");
  update();
}

/// Percentiles of neighbours in x: groups of as many rows.
function percentiles(rows, x, y) {
  const sorted = [...rows].sort((a, b) => x[a] - x[b]);
  const groups = Math.min(24, Math.floor(sorted.length / 20));
  if (groups < 3) return null;
  const found = { x: [], lines: [[], [], []] };
  for (let g = 0; g < groups; g++) {
    const own = sorted.slice(Math.floor(g * sorted.length / groups), Math.floor((g + 1) * sorted.length / groups));
    const values = own.map(row => y[row]).sort((a, b) => a - b);
    found.x.push(own.reduce((sum, row) => sum + x[row], 0) / own.length);
    [0.05, 0.5, 0.95].forEach((share, k) => found.lines[k].push(quantile(values, share)));
  }
  return found;
}

function histogram(box) {
  element(box, "h3", {}, "How often");
  const controls = element(box, "div", { class: "controls" });
  let bars = [], marks = [];
  const plot = new Plot(box, 360, plot => {
    const pen = plot.pen;
    pen.fillStyle = plot.color("accent");
    for (const [low, high, n] of bars) pen.fillRect(plot.px(low), plot.py(n), Math.max(1, plot.px(high) - plot.px(low) - 1), plot.py(0) - plot.py(n));
    pen.strokeStyle = plot.color("band");
    pen.lineWidth = 1.8;
    marks.forEach((mark, k) => { pen.setLineDash(k === 1 ? [] : [5, 4]); plot.path([mark, mark], plot.y); });
    pen.setLineDash([]);
  });
  const update = name => {
    const values = column(name).cells.filter(value => value !== null).sort((a, b) => a - b);
    const [low, high] = [values[0] ?? 0, values[values.length - 1] ?? 1];
    // Freedman and Diaconis.
    const wide = 2 * (quantile(values, 0.75) - quantile(values, 0.25)) / Math.cbrt(values.length);
    const n = Math.min(80, Math.max(1, Math.ceil(wide > 0 ? (high - low) / wide : 1)));
    const step = (high - low) / n || Math.abs(low) * 0.01 || 1;
    bars = Array.from({ length: n }, (_, k) => [low + k * step, low + (k + 1) * step, 0]);
    for (const value of values) bars[Math.min(n - 1, Math.floor((value - low) / step))][2]++;
    marks = values.length ? [0.05, 0.5, 0.95].map(share => quantile(values, share)) : [];
    const most = Math.max(1, ...bars.map(bar => bar[2]));
    Object.assign(plot, { names: [label(name), "cases"], x: span([low, low + n * step]), y: [0, 1.05 * most] });
    plot.said.textContent = marks.length ? `5 %: ${shown(marks[0])}, median ${shown(marks[1])}, 95 %: ${shown(marks[2])}, ${values.length} cases` : "";
    plot.draw();
  };
  const first = DATA.quantities[0] || numeric[0].name;
  choice(controls, "of", numeric.map(found => found.name), first, update);
  update(first);
}

function branches(box) {
  element(box, "h3", {}, DATA.of_responses ? "All responses: amplitude of the first stop over frequency, with their envelope" : "All branches: frequency over energy, of grazing energies");
  const controls = element(box, "div", { class: "controls" });
  const rowOf = new Map(column("case").cells.map((name, row) => [name, row]));
  const log = { on: false };
  const place = value => (log.on ? Math.log10(value) : value);
  const near = (plot, px, py) => {
    let best = null, least = 12 ** 2;
    for (const drawn of DATA.drawn) drawn.x.forEach((x, k) => {
      const d = (plot.px(place(x)) - px) ** 2 + (plot.py(drawn.y[k]) - py) ** 2;
      if (d < least) [best, least] = [rowOf.get(drawn.case), d];
    });
    return best;
  };
  const plot = new Plot(box, 420, plot => {
    const pen = plot.pen;
    pen.strokeStyle = plot.color("accent");
    pen.globalAlpha = Math.max(0.06, Math.min(0.7, 30 / DATA.drawn.length));
    pen.lineWidth = 1;
    for (const drawn of DATA.drawn) plot.path(drawn.x.map(place), drawn.y);
    pen.globalAlpha = 1;
    pen.strokeStyle = plot.color("band");
    const x = DATA.band.x.map(place);
    DATA.band.y.forEach((line, k) => { pen.lineWidth = k === 2 ? 2.4 : 1.4; pen.setLineDash([[5, 4], [2, 3], [], [2, 3], [5, 4]][k]); plot.path(x, line); });
    pen.setLineDash([]);
    if (DATA.envelope) { pen.lineWidth = 2.4; DATA.envelope.forEach(line => plot.path(x, line)); }
    for (const told of DATA.drawn.filter(drawn => rowOf.get(drawn.case) === plot.told)) { pen.strokeStyle = plot.color("ink"); pen.lineWidth = 2.4; plot.path(told.x.map(place), told.y); }
  }, near);
  const update = () => {
    const x = DATA.drawn.flatMap(drawn => drawn.x.map(place)), y = DATA.drawn.flatMap(drawn => drawn.y);
    const energy = log.on ? "decimal logarithm of the averaged kinetic energy over that at grazing" : "averaged kinetic energy over that at grazing";
    const frequency = log.on ? "decimal logarithm of the frequency in Hz" : "frequency in Hz";
    const names = DATA.of_responses ? [frequency, "amplitude of the first stop in m"] : [energy, "frequency in Hz"];
    Object.assign(plot, { names, x: span(x, 0.02), y: span(y) });
    plot.draw();
  };
  choice(controls, DATA.of_responses ? "frequency" : "energy", ["linear", "logarithmic"], "linear", name => { log.on = name !== "linear"; update(); });
  const all = column("case").cells.length;
  const some = !DATA.of_responses && DATA.drawn.length < all ? `${DATA.drawn.length} of ${all} cases; ` : "";
  element(controls, "span", { class: "quiet" }, some + "lines: 5, 25, 50, 75 and 95 %" + (DATA.of_responses ? " of the largest amplitude of each case; full lines: its smallest and largest of all cases" : ""));
  update();
}
