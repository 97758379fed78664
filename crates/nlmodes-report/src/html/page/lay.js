// Other results over those of the page: a table of a run or of a test, or the page of another run.

/// Points from which on their median is given.
const FEW = 5;
/// Largest difference in per cent, of either sign, that is called agreement.
const AGREES = 0.1;

/// The value in the middle, or half-way between the two there.
function median(values) {
  const sorted = [...values].sort((a, b) => a - b), last = sorted.length - 1;
  return 0.5 * (sorted[Math.floor(last / 2)] + sorted[Math.ceil(last / 2)]);
}

/// Softer or stiffer, by what most of these differences in per cent are; where not all are, how many are what.
function verdict(found, own) {
  const count = is => found.filter(is).length;
  const soft = count(p => p <= -AGREES), stiff = count(p => p >= AGREES);
  const counts = [[soft, "softer than", "softer"], [stiff, "stiffer than", "stiffer"], [found.length - soft - stiff, `in agreement to ${AGREES} % with`, "in agreement"]];
  const [[most, first], ...others] = counts.sort((a, b) => b[0] - a[0]);
  const rest = others.filter(([n]) => n).map(([n, , word]) => `${word} at ${n}`).join(", ");
  return most === found.length ? `${first} ${own}` : `${first} ${own} at ${most} of ${found.length} points, ${rest}`;
}

/// The branches that a file holds; throws what is wrong with it.
function branchesOf(name, text) {
  if (/^\s*<!doctype html/i.test(text)) {
    const found = new DOMParser().parseFromString(text, "text/html").getElementById("data");
    const data = found && JSON.parse(found.textContent);
    if (!data || !Array.isArray(data.branches)) throw new Error(`${name} is not a page of results.`);
    data.branches.forEach(branch => nameEvents(unpackBranch(branch), data.eventSymbols || []));
    return data.branches.map(branch => ({ ...branch, label: `${branch.label} (${name})`, motion: null, participation: [] }));
  }
  return [branchOfTable(name, text)];
}

function rowsOf(text) {
  const cells = line => [...line.matchAll(/("([^"]|"")*"|[^,]*)(,|$)/g)].map(match => match[1].replace(/^"|"$/g, "").replaceAll('""', '"').trim());
  return text.split(/\r?\n/).filter(line => line.trim()).map(cells);
}

function branchOfTable(name, text) {
  const [head, ...rows] = rowsOf(text);
  const place = column => (head || []).indexOf(column);
  if (place("frequency_hz") < 0) throw new Error(`${name} has no column frequency_hz.`);
  if (place("modal_amplitude") < 0 && place("energy_j") < 0) throw new Error(`${name} has neither a column modal_amplitude nor energy_j.`);
  const number = (row, column) => {
    const value = place(column) < 0 || !row[place(column)] ? NaN : Number(row[place(column)]);
    return Number.isFinite(value) ? value : null;
  };
  const used = rows.filter(row => number(row, "frequency_hz") > 0);
  if (!used.length) throw new Error(`${name} has no row with a frequency.`);
  const column = id => used.map(row => number(row, id));
  const events = {};
  used.forEach((row, k) => { const text = row[place("event")]; if (place("event") >= 0 && text) events[k] = text.split(" "); });
  return {
    label: name, scattered: place("record") >= 0, frequency: column("frequency_hz"), energy: column("energy_j"), totalEnergy: column("total_energy_j"),
    amplitude: column("modal_amplitude"), peak: column("peak_m"), contactFraction: column("contact_fraction"),
    contactIntervals: column("contact_intervals"), force: column("peak_contact_force_n"), residual: column("residual"), stops: [], shares: [],
    events, resonance: {}, unstable: [], multiplier: {}, tongues: [], participation: [], grazing: null, motion: null,
    resumed: Object.keys(events).map(Number).filter(k => events[k].includes("resumed")),
  };
}

/// By how much the frequency of what is laid over differs from that of a branch at equal modal amplitude, or energy where there is none.
function difference(laid, own) {
  const id = laid.amplitude.some(value => value !== null) ? "amplitude" : "energy";
  // Frequencies of all motions of a size on a branch, each once.
  const motions = (branch, wanted) => {
    const there = [];
    for (let j = 1; j < branch[id].length; j++) {
      const [a, b] = [branch[id][j - 1], branch[id][j]];
      if (branch.resumed.includes(j) || a === null || b === null || wanted < Math.min(a, b) || wanted > Math.max(a, b)) continue;
      const hz = branch.frequency[j - 1] + (branch.frequency[j] - branch.frequency[j - 1]) * (a === b ? 0 : (wanted - a) / (b - a));
      if (!there.length || Math.abs(there[there.length - 1] / hz - 1) > 1e-9) there.push(hz);
    }
    return there;
  };
  // From grazing on, as long as their size grows, two branches go the same way.
  const firstArm = branch => {
    const last = branch[id].length - 1, grazes = k => (branch.events[k] || []).some(event => event === "grazing" || event === "lift-off");
    const [start, step] = grazes(0) ? [0, 1] : grazes(last) ? [last, -1] : [0, 0];
    if (!step) return [0, -1];
    let end = start;
    const goesOn = k => branch[id][k + step] > branch[id][k] || (branch.resumed.includes(Math.max(k, k + step)) && Math.abs(branch[id][k + step] - branch[id][k]) <= 1e-9 * branch[id][k]);
    while (goesOn(end)) end += step;
    return [Math.min(start, end), Math.max(start, end)];
  };
  const part = (branch, [from, to]) => ({ [id]: branch[id].slice(from, to + 1), frequency: branch.frequency.slice(from, to + 1), resumed: branch.resumed.map(k => k - from) });
  const [mine, other] = [firstArm(own), firstArm(laid)];
  const found = [], several = [];
  let others = 0;
  laid[id].forEach((wanted, k) => {
    if (wanted === null) return;
    const there = motions(own, wanted);
    if (!there.length) return;
    const percent = hz => 100 * (laid.frequency[k] / hz - 1);
    // Points of a test are no curve: of several motions the one counts that fits the other points.
    if (laid.scattered) return void (there.length > 1 ? several.push(there.map(percent)) : found.push(percent(there[0])));
    const isFirst = k >= other[0] && k <= other[1], beside = isFirst ? motions(part(own, mine), wanted) : [];
    if (beside.length === 1) return void found.push(percent(beside[0]));
    // With several motions of an amplitude, as at an internal resonance, the nearest may be on another half-branch.
    if ((isFirst && mine[1] >= mine[0]) || Math.max(there.length, motions(laid, wanted).length) > 1) return void others++;
    found.push(percent(there[0]));
  });
  const usual = median(found), matched = found.length ? several.length : 0;
  if (!found.length) others += several.length;
  else found.push(...several.map(all => all.reduce((best, p) => Math.abs(p - usual) < Math.abs(best - usual) ? p : best)));
  const what = id === "amplitude" ? "modal amplitude" : "energy";
  const left = others ? `; ${others} ${others === 1 ? "point is" : "points are"} left out, where one of the two has several motions of that ${what} (internal resonances, folds)` : "";
  if (!found.length && others) return `${laid.label}: nothing to compare with ${own.label}${left}.`;
  if (!found.length) return `${laid.label}: no point within the ${what} of ${own.label}.`;
  const [least, most] = [Math.min(...found), Math.max(...found)];
  const percent = value => (value > 0 ? "+" : "") + significant(value, 3) + " %";
  const range = `${percent(least)} to ${percent(most)}`, points = `${found.length} ${found.length === 1 ? "point" : "points"}`;
  const by = percent(least) === percent(most) ? `${percent(least)} at ${points}`
    : found.length >= FEW ? `${percent(median(found))} in the median of ${points} (${range})` : `${range} at ${points}`;
  const fits = matched ? `, of which ${matched} with the one of several motions that fits the other points` : "";
  return `${laid.label}: ${verdict(found, own.label)}; its frequency at equal ${what} differs by ${by}${fits}${left}.`;
}

/// Events that this page does not know yet get a symbol in its legend.
function nameEvents(branch, known) {
  for (const name of Object.values(branch.events).flat()) {
    if (DATA.eventSymbols.some(entry => entry.name === name)) continue;
    DATA.eventSymbols.push(known.find(entry => entry.name === name) || { name, shape: "pentagon", fill: "#777777", layer: 0, meaning: "" });
  }
}

/// A button for files, and the page as a place to drop them; `add` takes each branch.
function layOver(box, add) {
  const label = html(box, "label", { class: "file" }, "Lay over: branch.csv, modal_points.csv or report.html of another run, chosen or dropped here ");
  const input = html(label, "input", { type: "file", multiple: "", accept: ".csv,.html" });
  const said = html(box, "div", { role: "status" });
  const read = async file => {
    try {
      for (const branch of branchesOf(file.name, await file.text())) {
        nameEvents(branch, []);
        branch.color = DATA.colors.branches[DATA.branches.length % DATA.colors.branches.length];
        add(branch);
        html(said, "p", {}, difference(branch, DATA.branches[0]));
      }
    } catch (error) {
      html(said, "p", { class: "outcome early" }, error.message);
    }
  };
  const all = async files => { for (const file of files) await read(file); };
  input.addEventListener("change", () => all(input.files));
  document.addEventListener("dragover", event => { event.preventDefault(); document.body.classList.add("dropping"); });
  document.addEventListener("dragleave", event => { if (!event.relatedTarget) document.body.classList.remove("dropping"); });
  document.addEventListener("drop", event => {
    event.preventDefault();
    document.body.classList.remove("dropping");
    all(event.dataTransfer.files);
  });
}
