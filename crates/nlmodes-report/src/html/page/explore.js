// A scene that is changed by sliders: its branch is computed anew while one drags.

const SETTINGS = JSON.parse(document.getElementById("settings").textContent);
const place = location.pathname.replace(/[^/]*$/, "");
const byId = id => document.getElementById(id);
const KEPT = 6;
// A response answers a load of a frequency; a mode has its frequency at an energy.
const IS_FORCED = SETTINGS.some(slider => /^(response|force|base_motion)\b/.test(slider.key));
const AXES = IS_FORCED
  ? [{ id: "frequency", label: "frequency in Hz", kind: "linear" }, { id: "peak", label: "largest displacement at the first stop in m", kind: "linear" }]
  : [{ id: "energy", label: "averaged kinetic energy in J", kind: "log" }, { id: "frequency", label: "frequency in Hz", kind: "linear" }];
const TITLE = IS_FORCED ? "Response over frequency" : "Frequency over averaged kinetic energy";

const live = { values: {}, kept: [], branches: [], key: 0, share: 0.6, running: null, latest: 0 };

function say(text, wrong) {
  byId("state").textContent = text;
  byId("state").classList.toggle("wrong", Boolean(wrong));
}

/// Between the ends of a slider: 0 to 1000.
function valueAt(slider, position) {
  const share = position / 1000;
  if (slider.kind === "log") return slider.from * (slider.to / slider.from) ** share;
  if (slider.kind === "choice") return slider.choices[Math.round(share * (slider.choices.length - 1))];
  const value = slider.from + share * (slider.to - slider.from);
  return slider.kind === "whole" ? Math.round(value) : value;
}

function positionOf(slider, value) {
  if (slider.kind === "log") return 1000 * Math.log(value / slider.from) / Math.log(slider.to / slider.from);
  if (slider.kind === "choice") return 1000 * slider.choices.indexOf(value) / Math.max(1, slider.choices.length - 1);
  return 1000 * (value - slider.from) / (slider.to - slider.from);
}

/// The multiple of the unit of a slider that is easy to read; ratios in per cent.
function unitOf(slider) {
  if (slider.kind === "whole") return { symbol: "", perSi: 1 };
  if (slider.unit === "") return { symbol: "%", perSi: 100 };
  const size = Math.abs(slider.value);
  if (slider.unit === "m") return fine("m", size);
  return ["N", "Pa", "N/m"].includes(slider.unit) ? prefixed(slider.unit, size) : { symbol: slider.unit, perSi: 1 };
}

/// A typed value as the scene can have it: whole numbers, and places that there are.
function possible(slider, value) {
  if (slider.kind === "whole") return Math.max(1, Math.round(value));
  if (slider.kind !== "choice") return value;
  return slider.choices.reduce((near, one) => (Math.abs(one - value) < Math.abs(near - value) ? one : near));
}

function addSliders(form) {
  form.addEventListener("submit", event => event.preventDefault());
  for (const slider of SETTINGS) {
    const unit = unitOf(slider), row = html(form, "div", { class: "slider" }), id = `value-${slider.key}`;
    html(row, "label", { for: id }, slider.label);
    const typed = html(row, "input", { type: "number", id, step: "any" });
    html(row, "span", { class: "unit" }, unit.symbol);
    const input = html(row, "input", {
      type: "range", min: 0, max: 1000, step: "any", value: positionOf(slider, slider.value), "data-key": slider.key, "aria-label": slider.label,
    });
    if (IS_FORCED) html(row, "div", { class: "arrow", "data-key": slider.key });
    const show = value => { typed.value = Number((value * unit.perSi).toPrecision(5)); };
    show(slider.value);
    const take = value => { live.values[slider.key] = Number(value.toPrecision(6)); compute(); };
    input.addEventListener("input", () => {
      const value = valueAt(slider, Number(input.value));
      show(value);
      take(value);
    });
    typed.addEventListener("change", () => {
      const read = Number(typed.value) / unit.perSi;
      if (!Number.isFinite(read) || (slider.kind === "log" && read <= 0)) { say(`${slider.label}: a ${slider.kind === "log" ? "positive " : ""}number is needed`, true); return; }
      const value = possible(slider, read);
      // What is typed may lie beyond the ends.
      if (slider.kind !== "choice") Object.assign(slider, { from: Math.min(slider.from, value), to: Math.max(slider.to, value) });
      input.value = positionOf(slider, value);
      show(value);
      take(value);
    });
  }
  const button = html(form, "button", { type: "button" }, "Save as a scene");
  button.addEventListener("click", () => save());
}

async function ask(what, signal) {
  const answer = await fetch(place + what, { method: "POST", body: JSON.stringify(live.values), signal });
  const found = await answer.json();
  if (!answer.ok) throw new Error(found.error);
  return found;
}

async function compute() {
  const own = ++live.latest;
  if (live.running) live.running.abort();
  live.running = new AbortController();
  const began = performance.now();
  try {
    const found = await ask("compute", live.running.signal);
    if (own !== live.latest) return;
    show(found.branches.map(unpackBranch));
    const milliseconds = performance.now() - began;
    document.body.dataset.latency = milliseconds.toFixed(1);
    document.body.dataset.shown = own;
    const points = found.branches.reduce((sum, branch) => sum + branch.frequency.length, 0);
    say(`${points} points, ${milliseconds.toFixed(0)} ms`);
    if (IS_FORCED) await effects(own);
  } catch (error) {
    if (error.name === "AbortError" || own !== live.latest) return;
    say(error instanceof TypeError ? "The program has ended: start it again." : error.message, true);
  }
}

/// What each slider does to peak and jumps, once nothing moves.
async function effects(own) {
  live.effects.fade();
  const found = await ask("effects", live.running.signal);
  if (own === live.latest) live.effects.show(found);
}

async function save() {
  try {
    say(`saved as ${(await ask("save")).path}`);
  } catch (error) {
    say(error.message, true);
  }
}

/// The new branches, of responses one for each level; those before them faint.
function show(branches) {
  if (live.branches.length) live.kept = [live.branches, ...live.kept].slice(0, KEPT);
  live.branches = branches;
  const columns = AXES.map(axis => ({ ...axis, of: branch => branch[axis.id] }));
  const [x, y] = columns.map(column => readable(column, branches));
  const faint = live.kept.flatMap((old, k) => old.map((branch, level) => (
    { key: `kept ${k} ${level}`, x: x.of(branch), y: y.of(branch), color: "#999999", width: 0.9, describes: false })));
  const own = branches.map((branch, key) => (
    { key, x: x.of(branch), y: y.of(branch), color: branch.color, width: 2.2, breaks: new Set(branch.resumed), corners: cornersOf(branch) }));
  if (live.chart) live.chart.end();
  live.chart = new Chart(byId("curve"), {
    name: TITLE, height: 240, zoomY: true,
    x: { label: x.label, kind: x.kind },
    panels: [{ label: y.label, kind: y.kind, curves: [...faint, ...own], symbols: [] }],
    describe: (curve, index) => [`${named(branches[curve.key])}point ${index}`, `frequency: ${hertz(branches[curve.key].frequency[index])}`],
    onChoose: (key, index) => choose(key, index),
  });
  const list = byId("levels");
  list.replaceChildren();
  if (branches.length > 1) branches.forEach(branch => {
    const entry = html(list, "span");
    const sample = svg(entry, "svg", { width: 28, height: 14, viewBox: "0 0 28 14", "aria-hidden": "true" });
    svg(sample, "line", { x1: 2, x2: 26, y1: 7, y2: 7, stroke: branch.color, "stroke-width": 2.4 });
    html(entry, "span", {}, branch.label);
  });
  const key = Math.min(live.key, branches.length - 1);
  choose(key, Math.round(live.share * (branches[key].frequency.length - 1)));
}

const named = branch => (live.branches.length > 1 ? `${branch.label}: ` : "");

function choose(key, index) {
  const branch = live.branches[key];
  live.key = key;
  live.share = index / Math.max(1, branch.frequency.length - 1);
  live.chart.choose(key, index);
  live.motion.show(branch, index);
  const box = byId("details");
  box.replaceChildren();
  html(box, "h3", {}, `${named(branch)}point ${index}`.replace(/^p/, "P"));
  const table = html(html(box, "table"), "tbody");
  for (const [name, value] of facts(branch, index)) {
    const row = html(table, "tr");
    html(row, "th", { scope: "row" }, name);
    html(row, "td", {}, value);
  }
}

live.effects = new Effects(byId("effects"), byId("sliders"));
live.motion = new Motion(byId("motion"), byId("controls"));
byId("curve").closest(".box").querySelector("h2").textContent = TITLE;
addSliders(byId("sliders"));
compute();
