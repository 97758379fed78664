// Frequency over energy and over amplitude, all branches in each.

const ENERGY = { name: "Frequency over averaged kinetic energy", label: "averaged kinetic energy in J", kind: "log", column: "energy" };
const AMPLITUDE = { name: "Frequency over modal amplitude", label: "modal amplitude in m √kg", kind: "linear", column: "amplitude" };

/// What there is to say about a point: pairs of name and value.
function facts(branch, index) {
  const rows = [
    ["frequency", hertz(branch.frequency[index])],
    ["averaged kinetic energy", significant(branch.energy[index], 5) + " J"],
    ["modal amplitude", significant(branch.amplitude[index], 5) + " m √kg"],
    ["contact fraction", significant(100 * branch.contactFraction[index], 4) + " %"],
    ["largest contact force", withUnit(branch.force[index], "N", prefixed)],
    ["largest displacement", withUnit(branch.peak[index], "m", fine)],
    ["total energy", significant(branch.totalEnergy[index], 5) + " J"],
    ["contacts a period", String(branch.contactIntervals[index])],
    ["residual", significant(branch.residual[index], 2)],
  ];
  branch.stops.forEach((stop, number) => {
    const name = branch.stops.length > 1 ? `stop ${number}` : "stop";
    const impulse = withUnit(stop.impulse[index], "N s", prefixed);
    if (branch.stops.length === 1) rows.push(["impulse a period", impulse]);
    else rows.push([name, `${significant(100 * stop.closed[index], 3)} %, impulse ${impulse}, force up to ${withUnit(stop.force[index], "N", prefixed)}`]);
  });
  if (branch.events[index]) rows.push(["event", branch.events[index].join(", ").replaceAll("-", " ")]);
  if (branch.resonance[index]) rows.push(["internal resonance", branch.resonance[index]]);
  if (branch.multiplier[index] !== undefined) {
    const state = branch.unstable.includes(index) ? "unstable" : "stable";
    rows.push(["stability", `${state}, largest Floquet multiplier ${significant(branch.multiplier[index], 7)}`]);
  }
  return rows;
}

function withUnit(value, name, choice) {
  if (value === null) return "–";
  const unit = choice(name, Math.abs(value));
  return significant(value * unit.perSi, 5) + " " + unit.symbol;
}

const tipRows = new Set(["total energy", "residual", "contacts a period", "largest displacement"]);

function describePoint(curve, index) {
  const branch = DATA.branches[curve.key];
  const rows = facts(branch, index).filter(([name]) => !tipRows.has(name));
  return [`${branch.label}: point ${index}`, ...rows.map(([name, value]) => `${name}: ${value}`)];
}

function branchSpec({ name, label, kind, column }, onHover, onChoose) {
  const curves = [], symbols = [];
  const happening = [];
  const shapes = Object.fromEntries(DATA.eventSymbols.map(entry => [entry.name, entry]));
  DATA.branches.forEach((branch, key) => {
    const [x, y] = [branch[column], branch.frequency];
    // What leaves an unstable point is drawn by itself, dashed.
    if (branch.scattered) {
      // Nothing was measured between the points.
      curves.push({ key, x, y, color: branch.color, width: 0.01, breaks: new Set(x.keys()) });
      x.forEach((value, index) => symbols.push({ key, x: value, y: y[index], shape: "dot", fill: branch.color }));
      return;
    }
    const unstable = branch.unstable.filter(index => index + 1 < x.length && !branch.resumed.includes(index + 1));
    curves.push({ key, x, y, color: branch.color, breaks: new Set([...branch.resumed, ...unstable.map(index => index + 1)]) });
    for (const [from, to] of stretches(unstable)) {
      curves.push({ key, x: x.slice(from, to + 2), y: y.slice(from, to + 2), color: branch.color, dash: "3 3", describes: false });
    }
    const thin = { key, color: branch.color, width: 1.2, dash: "6 4", describes: false };
    for (const index of branch.resumed) if (index > 0) curves.push({ ...thin, x: [x[index - 1], x[index]], y: [y[index - 1], y[index]] });
    for (const [index, names] of Object.entries(branch.events)) {
      for (const event of names) {
        const entry = shapes[event];
        happening.push({ key, x: x[index], y: y[index], shape: entry.shape, fill: entry.fill, open: true, layer: entry.layer });
      }
    }
    for (const [index, text] of branch.tongues) symbols.push({ key, x: x[index], y: y[index], shape: "dot", fill: "currentColor", name: text });
  });
  for (const [key, index, text] of DATA.marks) {
    const branch = DATA.branches[key];
    symbols.push({ key, x: branch[column][index], y: branch.frequency[index], shape: "dot", fill: "currentColor", name: text });
  }
  // What happens lies above the dots that only carry names, and what is rare above what may hide it.
  symbols.push(...happening.sort((a, b) => a.layer - b.layer));
  const view = span(curves.flatMap(curve => curve.x.map(value => toPlace(kind, value))), 0.04);
  DATA.branches.forEach((branch, key) => addLinearMode(curves, branch, key, branch[column], kind, view));
  return {
    name, x: { label, kind, view }, panels: [{ label: "frequency in Hz", kind: "linear", curves, symbols }], height: 330, zoomY: true,
    describe: describePoint, onHover, onChoose,
  };
}

/// First and last of each run of numbers that follow each other.
function stretches(numbers) {
  const found = [];
  for (const number of numbers) {
    const last = found[found.length - 1];
    if (last && last[1] + 1 === number) last[1] = number;
    else found.push([number, number]);
  }
  return found;
}

/// The linear mode below grazing: a dashed line, for which the view is made wider.
function addLinearMode(curves, branch, key, x, kind, view) {
  if (branch.grazing === null) return;
  const [place, frequency] = [toPlace(kind, x[branch.grazing]), branch.frequency[branch.grazing]];
  if (!Number.isFinite(place)) return;
  const start = kind === "log" ? place - 0.2 * (view[1] - view[0]) : 0;
  view[0] = Math.min(view[0], start);
  const ends = { x: [fromPlace(kind, view[0]), x[branch.grazing]], y: [frequency, frequency] };
  curves.unshift({ key, ...ends, color: branch.color, width: 1.6, dash: "6 4", describes: false });
}

/// Names of curves and symbols; a branch can be hidden where there are several.
function legend(box, charts) {
  const list = html(box, "div", { class: "legend" });
  const sample = parent => svg(parent, "svg", { width: 28, height: 14, viewBox: "0 0 28 14", "aria-hidden": "true" });
  const line = (parent, color, dash) =>
    svg(sample(parent), "line", { x1: 2, x2: 26, y1: 7, y2: 7, stroke: color, "stroke-width": 2.4, "stroke-dasharray": dash });
  DATA.branches.forEach((branch, key) => {
    if (DATA.branches.length === 1) {
      const entry = html(list, "span");
      line(entry, branch.color);
      html(entry, "span", {}, branch.label);
      return;
    }
    const entry = html(list, "button", { type: "button", "aria-pressed": "true", title: "Show or hide this branch" });
    line(entry, branch.color);
    html(entry, "span", {}, branch.label);
    entry.addEventListener("click", () => {
      const shown = entry.getAttribute("aria-pressed") === "true";
      entry.setAttribute("aria-pressed", String(!shown));
      charts.forEach(chart => chart.hide(key, shown));
    });
  });
  if (DATA.branches.some(branch => branch.grazing !== null)) {
    const entry = html(list, "span");
    line(entry, "currentColor", "6 4");
    html(entry, "span", {}, "linear mode");
  }
  if (DATA.branches.some(branch => branch.unstable.length > 0)) {
    const entry = html(list, "span");
    line(entry, "currentColor", "3 3");
    html(entry, "span", {}, "unstable");
  }
  for (const { name, shape, fill: color } of DATA.eventSymbols) {
    const entry = html(list, "span");
    symbol(sample(entry), shape, 14, 7, color, undefined, true);
    html(entry, "span", {}, name.replaceAll("-", " "));
  }
}

/// Both figures, and that of the participation if there is one; what is hovered or chosen in one is so in the others.
function branchFigures(boxes, participationBox, legendBox, onChoose) {
  const charts = [];
  const onHover = found => charts.forEach(chart => {
    if (!chart.tip.hidden && found) return;
    chart.hover(found && { key: found.key, index: found.index }, false);
  });
  boxes.forEach((box, k) => charts.push(new Chart(box, branchSpec(k ? AMPLITUDE : ENERGY, onHover, onChoose))));
  if (participationBox) charts.push(new Chart(participationBox, participationSpec(onHover, onChoose)));
  legend(legendBox, charts);
  return charts;
}
