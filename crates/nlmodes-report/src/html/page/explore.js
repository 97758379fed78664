// A scene that is changed by sliders: its branch is computed anew while one drags.

const SETTINGS = JSON.parse(document.getElementById("settings").textContent);
const place = location.pathname.replace(/[^/]*$/, "");
const byId = id => document.getElementById(id);
const KEPT = 6;

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
    show(found.branches[0]);
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
  const faint = live.kept.map((old, k) => ({ key: `kept ${k}`, x: old.energy, y: old.frequency, color: "#999999", width: 0.9, describes: false }));
  const own = { key: 0, x: branch.energy, y: branch.frequency, color: branch.color, width: 2.2, breaks: new Set(branch.resumed) };
  byId("curve").replaceChildren();
  live.chart = new Chart(byId("curve"), {
    name: "Frequency over averaged kinetic energy", height: 330, zoomY: true,
    x: { label: "averaged kinetic energy in J", kind: "log" },
    panels: [{ label: "frequency in Hz", kind: "linear", curves: [...faint, own], symbols: [] }],
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
addSliders(byId("sliders"));
compute();
