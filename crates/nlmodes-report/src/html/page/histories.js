// Time histories: displacement, velocity, acceleration and force over the same time.

const SERIES = [
  ["displacement", "m", fine], ["velocity", "m/s", fine], ["acceleration", "m/s²", (symbol, most) => thousands(symbol, most)],
  ["force", "N", prefixed],
];

/// The unit itself, times a power of a thousand where the numbers would be long.
function thousands(symbol, most) {
  const power = most > 200 ? 3 * Math.floor(Math.log10(most / 0.2) / 3) : 0;
  return { symbol: power ? `10${raised(power)} ${symbol}` : symbol, perSi: 10 ** -power };
}

/// history: { time, displacement, …, stop, instants: [[time, touching], …], label, color, others }; a series that is missing has no panel.
/// The others are histories that are drawn over it.
function historySpec(name, history, height) {
  const all = [history, ...(history.others || [])];
  const clock = fine("s", Math.max(...all.map(one => largest(one.time))));
  const times = all.map(one => one.time.map(t => t * clock.perSi));
  const panels = SERIES.filter(([series]) => history[series]).map(([series, symbolName, choice]) => {
    const values = all.flatMap(one => one[series]);
    const walls = new Map(all.filter(one => one.stop !== null).map(one => [`${one.stop} ${one.wall}`, one]));
    const stops = [...walls.values()].map(one => one.stop);
    const withStop = series === "displacement" ? values.concat(stops) : values;
    const unit = choice(symbolName, largest(withStop));
    const word = series === "force" ? "contact force" : series;
    const panel = { label: `${word} in ${unit.symbol}`, kind: "linear", unit: unit.symbol, word, symbols: [], levels: [] };
    panel.curves = all.map((one, number) => {
      const y = one[series].map(value => (value === null ? null : value * unit.perSi));
      return { key: series + number, number, x: times[number], y, color: one.color, dash: one.dash, width: 1.8 };
    });
    if (series === "displacement") {
      for (const { stop, wall } of walls.values()) panel.levels.push({ y: stop * unit.perSi, class: "stop", stroke: wall });
      for (const [one, t, touching] of all.flatMap(one => one.instants.map(instant => [one, ...instant]))) {
        const at = { x: t * clock.perSi, y: interpolated(one.time, one[series], t) * unit.perSi };
        const look = touching ? { shape: "circle", fill: DATA.colors.touching, title: "touching" }
          : { shape: "square", fill: DATA.colors.leaving, title: "leaving" };
        // Of several histories each has the colour of its curve.
        if (all.length > 1) Object.assign(look, { fill: one.color, title: `${look.title}: ${one.label}` });
        panel.symbols.push({ ...at, ...look });
      }
    }
    return panel;
  });
  const describe = ({ number }, index) => [
    `${all.length > 1 ? all[number].label : name}: time ${significant(times[number][index], 5)} ${clock.symbol}`,
    ...panels.map(panel => `${panel.word}: ${significant(panel.curves[number].y[index], 5)} ${panel.unit}`),
  ];
  return { name, x: { label: `time in ${clock.symbol}`, kind: "linear", room: 0 }, panels, height, alongX: true, describe, clock, table: () => historyTable(all) };
}

/// The numbers of histories: time and series of each.
function historyTable(all) {
  const series = SERIES.filter(([name]) => all[0][name]);
  const rows = all.flatMap(one => one.time.map((t, k) => [one.label, t, ...series.map(([name]) => one[name][k])]));
  return [["history", "time in s", ...series.map(([name, unit]) => `${name} in ${unit}`)], rows];
}

/// Names of histories that lie over each other.
function curveNames(box, history) {
  const list = html(box, "div", { class: "legend" });
  for (const { color, dash, label } of [history, ...history.others]) {
    const entry = html(list, "span");
    const sample = svg(entry, "svg", { width: 28, height: 14, viewBox: "0 0 28 14", "aria-hidden": "true" });
    svg(sample, "line", { x1: 2, x2: 26, y1: 7, y2: 7, stroke: color, "stroke-width": 2.4, "stroke-dasharray": dash });
    html(entry, "span", {}, label);
  }
}

function interpolated(time, values, t) {
  const after = Math.max(1, time.findIndex(other => other >= t));
  const share = (t - time[after - 1]) / (time[after] - time[after - 1]);
  return values[after - 1] + (values[after] - values[after - 1]) * share;
}
