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

const live = { values: {}, kept: [], branch: null, share: 0.6, running: null, latest: 0 };

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

function addSliders(form) {
  form.addEventListener("submit", event => event.preventDefault());
  for (const slider of SETTINGS) {
    const label = html(form, "label", {}, slider.label);
    const shown = html(label, "output");
    const input = html(label, "input", { type: "range", min: 0, max: 1000, step: "any", value: positionOf(slider, slider.value), "data-key": slider.key });
    const show = value => { shown.textContent = `${slider.kind === "whole" ? value : significant(value, 5)} ${slider.unit}`; };
    show(slider.value);
    input.addEventListener("input", () => {
      const value = Number(valueAt(slider, Number(input.value)).toPrecision(6));
      live.values[slider.key] = value;
      show(value);
      compute();
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
    show(unpackBranch(found.branches[0]));
    const milliseconds = performance.now() - began;
    document.body.dataset.latency = milliseconds.toFixed(1);
    document.body.dataset.shown = own;
    say(`${found.branches[0].frequency.length} points, ${milliseconds.toFixed(0)} ms`);
  } catch (error) {
    if (error.name === "AbortError" || own !== live.latest) return;
    say(error instanceof TypeError ? "The program has ended: start it again." : error.message, true);
  }
}

async function save() {
  try {
    say(`saved as ${(await ask("save")).path}`);
  } catch (error) {
    say(error.message, true);
  }
}

/// The new branch, those before it faint.
function show(branch) {
  if (live.branch) live.kept = [live.branch, ...live.kept].slice(0, KEPT);
  live.branch = branch;
  const [x, y] = AXES;
  const faint = live.kept.map((old, k) => ({ key: `kept ${k}`, x: old[x.id], y: old[y.id], color: "#999999", width: 0.9, describes: false }));
  const breaks = new Set(branch.resumed);
  const own = { key: 0, x: branch[x.id], y: branch[y.id], color: branch.color, width: 2.2, breaks, corners: cornersOf(branch) };
  if (live.chart) live.chart.end();
  live.chart = new Chart(byId("curve"), {
    name: TITLE, height: 330, zoomY: true,
    x: { label: x.label, kind: x.kind },
    panels: [{ label: y.label, kind: y.kind, curves: [...faint, own], symbols: [] }],
    describe: (_, index) => [`point ${index}`, `frequency: ${hertz(branch.frequency[index])}`],
    onChoose: (_, index) => choose(index),
  });
  choose(Math.round(live.share * (branch.frequency.length - 1)));
}

function choose(index) {
  const branch = live.branch;
  live.share = index / Math.max(1, branch.frequency.length - 1);
  live.chart.choose(0, index);
  live.motion.show(branch, index);
  const box = byId("details");
  box.replaceChildren();
  html(box, "h3", {}, `Point ${index}`);
  const table = html(html(box, "table"), "tbody");
  for (const [name, value] of facts(branch, index)) {
    const row = html(table, "tr");
    html(row, "th", { scope: "row" }, name);
    html(row, "td", {}, value);
  }
}

live.motion = new Motion(byId("motion"), byId("controls"));
byId("curve").closest(".box").querySelector("h2").textContent = TITLE;
addSliders(byId("sliders"));
compute();
