// The branches over each other: frequency over energy, or any column over any other.

const AMPLITUDE_LABEL = "modal amplitude in m √kg";
const CORNERS_AT = ["kink", "contact-change", "branch-point"];

/// What there is to say about a point: pairs of name and value.
/// Number of a point in the table of all branches.
const numberOf = (branch, index) => (branch.first || 0) + index;

function facts(branch, index) {
  // Stops of one point are compared: all have the unit of the largest.
  const most = id => largest(branch.stops.map(stop => stop[id][index]));
  const force = Math.max(most("force"), branch.force[index] || 0);
  const rows = [
    ["frequency", hertz(branch.frequency[index])],
    ...quantitiesOf(branch, index),
    ["averaged kinetic energy", significant(branch.energy[index], 5) + " J"],
    ["modal amplitude", significant(branch.amplitude[index], 5) + " m √kg"],
    ["largest contact force*", withUnit(branch.force[index], "N", prefixed, force)],
    [branch.stops.length > 1 ? "largest displacement toward stop 0" : "largest displacement toward the stop", withUnit(branch.peak[index], "m", fine)],
    ["total energy", significant(branch.totalEnergy[index], 5) + " J"],
    ["contacts a period", String(branch.contactIntervals[index])],
    ["residual", significant(branch.residual[index], 2)],
  ];
  // The impulse converges with harmonics, the largest force of a short blow need not.
  const stops = branch.stops.length > EACH ? [allStops(branch, index, force)] : branch.stops.map((stop, number) => {
    const impulse = withUnit(stop.impulse[index], "N s", prefixed, most("impulse"));
    if (branch.stops.length === 1) return ["impulse a period", impulse];
    const closed = significant(100 * stop.closed[index], 3);
    return [`stop ${number}`, stop.closed[index] > 0 ? `impulse ${impulse}, closed ${closed} %, force* up to ${withUnit(stop.force[index], "N", prefixed, force)}` : "open"];
  });
  const closed = ["contact fraction", significant(100 * branch.contactFraction[index], 4) + " %"];
  rows.splice(rows.findIndex(([name]) => name.startsWith("largest contact force")), 0, ...(branch.stops.length > 1 ? stops : [...stops, closed]));
  for (const event of branch.events[index] || []) rows.push(["event", eventText(event)]);
  if (branch.resonance[index]) rows.push(["internal resonance", branch.resonance[index]]);
  if (branch.multiplier[index] !== undefined) {
    const state = branch.unstable.includes(index) ? "unstable" : "stable";
    rows.push(["stability", `${state}, largest Floquet multiplier ${significant(branch.multiplier[index], 7)}`]);
  }
  return rows;
}

/// Stops that have a row each; more, as the nodes of a face, have one together.
const EACH = 6;

/// All stops in one row: how many are touched, the impulse in all, and which is closed longest and is pressed most.
function allStops(branch, index, force) {
  const numbers = branch.stops.map((_, number) => number).filter(number => branch.stops[number].closed[index] > 0);
  const name = `${branch.stops.length} stops`;
  if (!numbers.length) return [name, "all open"];
  const top = id => numbers.reduce((most, number) => (branch.stops[number][id][index] > branch.stops[most][id][index] ? number : most));
  const [longest, hardest] = [top("closed"), top("force")];
  const impulse = numbers.reduce((sum, number) => sum + branch.stops[number].impulse[index], 0);
  const closed = significant(100 * branch.stops[longest].closed[index], 3);
  const most = withUnit(branch.stops[hardest].force[index], "N", prefixed, force);
  return [name, `${numbers.length} touched, impulse in all ${withUnit(impulse, "N s", prefixed)}, closed up to ${closed} % (stop ${longest}), force* up to ${most} (stop ${hardest})`];
}

/// Name of an event and what it means.
function eventText(event) {
  const known = typeof DATA === "undefined" ? null : DATA.eventSymbols.find(entry => entry.name === event);
  return event.replaceAll("-", " ") + (known && known.meaning ? `: ${known.meaning}` : "");
}

/// Values of the quantities that this page adds to those of all points: amplitude, level …
function quantitiesOf(branch, index) {
  const known = typeof DATA === "undefined" ? [] : DATA.quantities || [];
  const rows = known.map((label, k) => [label, branch.extra && branch.extra[k] ? branch.extra[k][index] : null]);
  return rows.filter(([, value]) => Number.isFinite(value)).map(([label, value]) => {
    const unit = label.slice(withoutUnit(label).length + 4);
    return [withoutUnit(label), ["m", "N"].includes(unit) ? withUnit(value, unit, fine) : `${significant(value, 5)} ${unit}`];
  });
}

/// `like`: the size by which the unit is chosen, where that is not the value's own.
function withUnit(value, name, choice, like = 0) {
  if (value === null) return "–";
  const unit = choice(name, like || Math.abs(value));
  return significant(value * unit.perSi, 5) + " " + unit.symbol;
}

const tipRows = new Set(["total energy", "residual", "contacts a period", "largest displacement toward the stop", "largest displacement toward stop 0"]);

function describePoint(curve, index) {
  const branch = DATA.branches[curve.key];
  const rows = facts(branch, index).filter(([name]) => !tipRows.has(name));
  return [`${branch.label}: point ${numberOf(branch, index)}`, ...rows.map(([name, value]) => `${name}: ${value}`)];
}

/// Indices of the points at which a branch may turn.
const cornersOf = branch => new Set(Object.keys(branch.events).map(Number).filter(k => branch.events[k].some(event => CORNERS_AT.includes(event))));

function branchSpec(columns, kinds, onHover, onChoose) {
  const curves = [], symbols = [];
  const happening = [];
  const shapes = Object.fromEntries(DATA.eventSymbols.map(entry => [entry.name, entry]));
  DATA.branches.forEach((branch, key) => {
    const [x, y] = columns.map(column => valuesOf(column, branch));
    if (branch.scattered) {
      // Nothing was measured between the points.
      curves.push({ key, x, y, color: branch.color, width: 0.01, breaks: new Set(x.keys()) });
      x.forEach((value, index) => symbols.push({ key, x: value, y: y[index], shape: "circle", fill: branch.color, open: true }));
      return;
    }
    // What leaves an unstable point is drawn by itself, dashed.
    const unstable = branch.unstable.filter(index => index + 1 < x.length && !branch.resumed.includes(index + 1));
    const corners = cornersOf(branch);
    curves.push({ key, x, y, corners, color: branch.color, breaks: new Set([...branch.resumed, ...unstable.map(index => index + 1)]) });
    for (const [from, to] of stretches(unstable)) {
      const own = new Set([...corners].map(k => k - from));
      curves.push({ key, x: x.slice(from, to + 2), y: y.slice(from, to + 2), corners: own, color: branch.color, dash: "3 3", describes: false });
    }
    const thin = { key, color: branch.color, width: 1.2, dash: "6 4", describes: false };
    for (const index of branch.resumed) if (index > 0) curves.push({ ...thin, x: [x[index - 1], x[index]], y: [y[index - 1], y[index]] });
    for (const [index, names] of Object.entries(branch.events)) {
      for (const event of names) {
        const entry = shapes[event] || { shape: "pentagon", fill: "#777777", layer: 0 };
        happening.push({ key, x: x[index], y: y[index], shape: entry.shape, fill: entry.fill, open: true, layer: entry.layer });
      }
    }
    for (const [index, text] of branch.tongues) {
      symbols.push({ key, x: x[index], y: y[index], shape: "dot", fill: "currentColor", name: text, optional: true });
    }
  });
  for (const [key, index, text] of DATA.marks) {
    const [x, y] = columns.map(column => valuesOf(column, DATA.branches[key]));
    symbols.push({ key, x: x[index], y: y[index], shape: "dot", fill: "currentColor", name: text });
  }
  // What happens lies above the dots that only carry names, and what is rare above what may hide it.
  symbols.push(...happening.sort((a, b) => a.layer - b.layer));
  const view = span(curves.flatMap(curve => curve.x.map(value => toPlace(kinds[0], value))), 0.04);
  if (columns[1].id === "frequency" && ["energy", "amplitude"].includes(columns[0].id)) {
    const whole = [...view];
    DATA.branches.forEach((branch, key) => addLinearMode(curves, branch, key, branch[columns[0].id], kinds[0], whole, view));
  }
  const name = titleOf(columns);
  return {
    name, x: { label: columns[0].label, kind: kinds[0], view }, panels: [{ label: columns[1].label, kind: kinds[1], curves, symbols }],
    height: 330, zoomY: true, describe: describePoint, onHover, onChoose, table: () => tableOf(DATA.branches),
  };
}

function titleOf(columns) {
  const [x, y] = columns.map(column => withoutUnit(column.label));
  return `${y[0].toUpperCase()}${y.slice(1)} over ${x}`;
}

/// A column in the multiple of its unit that is easy to read, for lengths, forces and impulses.
function readable(column, branches) {
  const unit = (column.label.match(/ in (m|N|N s)$/) || [])[1];
  if (!unit) return column;
  const { symbol, perSi } = fine(unit, largest(branches.map(branch => largest(column.of(branch) || []))));
  const scaled = values => values && values.map(value => (value === null ? null : value * perSi));
  return { ...column, label: column.label.slice(0, -unit.length) + symbol, of: branch => scaled(column.of(branch)) };
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

/// Share of a linear axis below which the points begin if it goes down to zero; else the linear mode has a fifth of it, as on logarithmic ones.
const FROM_ZERO = 0.5;

/// The linear mode below grazing: a dashed line, for which the view of the `whole` is made wider.
function addLinearMode(curves, branch, key, x, kind, whole, view) {
  if (branch.grazing === null) return;
  const [place, frequency] = [toPlace(kind, x[branch.grazing]), branch.frequency[branch.grazing]];
  if (!Number.isFinite(place)) return;
  const fifth = kind === "log" ? place - 0.2 * (whole[1] - whole[0]) : place - 0.25 * (whole[1] - place);
  const start = kind === "log" || whole[0] > FROM_ZERO * whole[1] ? fifth : 0;
  view[0] = Math.min(view[0], start);
  const ends = { x: [fromPlace(kind, view[0]), x[branch.grazing]], y: [frequency, frequency] };
  curves.unshift({ key, ...ends, color: branch.color, width: 1.6, dash: "6 4", describes: false });
}

/// Names of curves and symbols; a branch can be hidden where there are several.
function legend(box, charts) {
  box.replaceChildren();
  const list = html(box, "div", { class: "legend" });
  const sample = parent => svg(parent, "svg", { width: 28, height: 14, viewBox: "0 0 28 14", "aria-hidden": "true" });
  const line = (parent, color, dash) =>
    svg(sample(parent), "line", { x1: 2, x2: 26, y1: 7, y2: 7, stroke: color, "stroke-width": 2.4, "stroke-dasharray": dash });
  const key = (parent, branch) => (branch.scattered ? symbol(sample(parent), "circle", 14, 7, branch.color, undefined, true) : line(parent, branch.color));
  DATA.branches.forEach((branch, number) => {
    const several = DATA.branches.length > 1;
    const entry = several ? html(list, "button", { type: "button", "aria-pressed": "true", title: "Show or hide this branch" }) : html(list, "span");
    key(entry, branch);
    html(entry, "span", {}, branch.label);
    if (several) entry.addEventListener("click", () => {
      const shown = entry.getAttribute("aria-pressed") === "true";
      entry.setAttribute("aria-pressed", String(!shown));
      charts().forEach(chart => chart.hide(number, shown));
    });
  });
  const note = (dash, text) => { const entry = html(list, "span"); line(entry, "currentColor", dash); html(entry, "span", {}, text); };
  if (DATA.branches.some(branch => branch.grazing !== null)) note("6 4", "linear mode");
  if (DATA.branches.some(branch => branch.unstable.length > 0)) note("3 3", "unstable");
  // What an event means is shown where it is asked for.
  const said = html(box, "p", { class: "hint", role: "status" });
  for (const { name, shape, fill: color, meaning } of DATA.eventSymbols) {
    const entry = meaning ? html(list, "button", { type: "button", class: "event", "aria-expanded": "false", title: meaning }) : html(list, "span");
    symbol(sample(entry), shape, 14, 7, color, undefined, true);
    html(entry, "span", {}, name.replaceAll("-", " "));
    if (meaning) entry.addEventListener("click", () => {
      const opens = entry.getAttribute("aria-expanded") === "false";
      list.querySelectorAll(".event").forEach(other => other.setAttribute("aria-expanded", String(opens && other === entry)));
      said.textContent = opens ? eventText(name) : "";
    });
  }
}

/// A figure whose axes are chosen: `ids` and `kinds` of abscissa and ordinate at first.
class Choice {
  constructor(box, ids, onHover, onChoose) {
    Object.assign(this, { box, ids, onHover, onChoose, chart: null });
    this.title = box.closest(".box").querySelector("h3");
    this.bar = html(null, "div", { class: "controls axes" });
    box.before(this.bar);
    this.draw();
  }

  draw() {
    const all = allColumns(), columns = this.ids.map(id => all.find(column => column.id === id) || all[0]);
    this.kinds = this.kinds || columns.map(column => column.kind);
    const chosen = this.chart && this.chart.chosen, hidden = this.chart ? this.chart.hidden : new Set();
    if (this.chart) this.chart.end();
    this.title.textContent = titleOf(columns);
    this.bar.replaceChildren();
    [1, 0].forEach(axis => this.selector(all, columns, axis));
    const shown = columns.map(column => readable(column, DATA.branches));
    this.chart = new Chart(this.box, branchSpec(shown, this.kinds, this.onHover, this.onChoose));
    hidden.forEach(key => this.chart.hide(key, true));
    if (chosen) this.chart.choose(chosen.key, chosen.index);
  }

  selector(all, columns, axis) {
    const label = html(this.bar, "label", {}, axis ? "vertical " : "horizontal ");
    const select = html(label, "select");
    all.forEach(column => html(select, "option", { value: column.id, selected: column === columns[axis] ? "" : null }, column.label));
    const change = act => { act(); this.draw(); this.bar.querySelectorAll("select")[1 - axis].focus(); };
    select.addEventListener("change", () => change(() => {
      this.ids[axis] = select.value;
      this.kinds[axis] = all.find(column => column.id === select.value).kind;
    }));
    const scale = html(this.bar, "label"), box = html(scale, "input", { type: "checkbox" });
    box.checked = this.kinds[axis] === "log";
    scale.append(" log");
    box.addEventListener("change", () => change(() => { this.kinds[axis] = box.checked ? "log" : "linear"; }));
  }
}

/// Both figures, and that of the participation if there is one; what is hovered or chosen in one is so in the others.
function branchFigures(boxes, participationBox, legendBox, onChoose) {
  const choices = [], fixed = [];
  const charts = () => [...choices.map(choice => choice.chart), ...fixed];
  const onHover = found => charts().forEach(chart => {
    if (!chart.tip.hidden && found) return;
    chart.hover(found && { key: found.key, index: found.index }, false);
  });
  boxes.forEach(([box, id]) => choices.push(new Choice(box, id === "main" ? [...DATA.mainAxes] : [id, "frequency"], onHover, onChoose)));
  if (participationBox) fixed.push(new Chart(participationBox, participationSpec(onHover, onChoose)));
  legend(legendBox, charts);
  const redraw = () => { choices.forEach(choice => choice.draw()); legend(legendBox, charts); };
  return { charts, redraw };
}
