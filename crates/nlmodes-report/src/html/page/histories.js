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

/// history: { time, displacement, …, stop, instants: [[time, touching], …] }; a series that is missing has no panel.
function historySpec(name, history, height) {
  const clock = fine("s", largest(history.time));
  const time = history.time.map(t => t * clock.perSi);
  const panels = SERIES.filter(([series]) => history[series]).map(([series, symbolName, choice]) => {
    const values = history[series];
    const withStop = series === "displacement" ? values.concat(history.stop) : values;
    const unit = choice(symbolName, largest(withStop));
    const y = values.map(value => (value === null ? null : value * unit.perSi));
    const word = series === "force" ? "contact force" : series;
    const panel = { label: `${word} in ${unit.symbol}`, kind: "linear", unit: unit.symbol, word, symbols: [], levels: [] };
    panel.curves = [{ key: series, x: time, y, color: "currentColor", width: 1.8 }];
    if (series === "displacement") {
      if (history.stop !== null) panel.levels.push({ y: history.stop * unit.perSi, class: "stop" });
      for (const [t, touching] of history.instants) {
        const at = { x: t * clock.perSi, y: interpolated(history.time, values, t) * unit.perSi };
        const look = touching ? { shape: "circle", fill: DATA.colors.touching, title: "touching" }
          : { shape: "square", fill: DATA.colors.leaving, title: "leaving" };
        panel.symbols.push({ ...at, ...look });
      }
    }
    return panel;
  });
  const describe = (_, index) => [
    `${name}: time ${significant(time[index], 5)} ${clock.symbol}`,
    ...panels.map(panel => `${panel.word}: ${significant(panel.curves[0].y[index], 5)} ${panel.unit}`),
  ];
  return { name, x: { label: `time in ${clock.symbol}`, kind: "linear", room: 0 }, panels, height, alongX: true, describe, clock };
}

function interpolated(time, values, t) {
  const after = Math.max(1, time.findIndex(other => other >= t));
  const share = (t - time[after - 1]) / (time[after] - time[after - 1]);
  return values[after - 1] + (values[after] - values[after - 1]) * share;
}
