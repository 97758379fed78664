// What an axis can show: all that is known of the points of the branches.

/// [{ id, label, kind, of(branch) -> values }]; those of which no branch has a value are left out.
function allColumns() {
  const column = (id, label, kind, of) => ({ id, label, kind, of });
  const most = count => DATA.branches.reduce((n, branch) => Math.max(n, count(branch)), 0);
  const numbers = n => Array.from({ length: n }, (_, k) => k);
  const plain = (id, label, kind = "linear") => column(id, label, kind, branch => branch[id]);
  const percent = values => values && values.map(value => (value === null ? null : 100 * value));
  const name = stop => (most(branch => branch.stops.length) > 1 ? ` at stop ${stop}` : "");
  const all = [
    plain("frequency", "frequency in Hz"),
    ...(DATA.quantities || []).map((label, k) => column(`quantity${k}`, label, "linear", branch => branch.extra && branch.extra[k])), plain("energy", "averaged kinetic energy in J", "log"), plain("amplitude", "modal amplitude in m √kg"),
    plain("totalEnergy", "total energy in J", "log"), plain("peak", "largest displacement toward the stop in m"),
    column("closed", "first contact closed, % of period", "linear", branch => percent(branch.contactFraction)),
    plain("contactIntervals", "contacts a period"),
    ...numbers(most(branch => branch.stops.length)).flatMap(stop => [
      column(`impulse${stop}`, `impulse a period${name(stop)} in N s`, "linear", branch => branch.stops[stop] && branch.stops[stop].impulse),
      column(`closed${stop}`, `closed${name(stop)}, % of period`, "linear", branch => branch.stops[stop] && percent(branch.stops[stop].closed)),
      column(`force${stop}`, `largest force*${name(stop)} in N`, "linear", branch => branch.stops[stop] && branch.stops[stop].force),
    ]),
    plain("force", "largest contact force* in N"),
    ...numbers(most(branch => branch.participation.length)).map(mode =>
      column(`mode${mode}`, `energy share, mode ${mode + 1}`, "linear", branch => branch.participation[mode])),
    ...numbers(most(branch => (branch.shares[0] || []).length)).map(n =>
      column(`harmonic${n}`, `energy share, harmonic ${n}`, "log", branch => branch.shares.map(shares => (shares.length > n ? shares[n] : null)))),
    column("multiplier", "largest Floquet multiplier", "linear", branch => branch.frequency.map((_, k) => branch.multiplier[k] ?? null)),
    plain("residual", "residual", "log"), column("point", "point", "linear", branch => branch.frequency.map((_, k) => (branch.first || 0) + k)),
  ];
  const known = one => DATA.branches.some(branch => (one.of(branch) || []).some(value => Number.isFinite(value) && value !== 0));
  return all.filter(known);
}

/// Values of a column of a branch; null where there are none.
const valuesOf = (column, branch) => column.of(branch) || branch.frequency.map(() => null);

const withoutUnit = label => label.replace(/ in [^ ]+( √kg| s)?$/, "");

/// The names of all columns and a row for each point of each branch.
function tableOf(branches) {
  const columns = allColumns();
  const rows = branches.flatMap(branch => {
    const values = columns.map(column => valuesOf(column, branch));
    return branch.frequency.map((_, k) => [branch.label, ...values.map(column => column[k]), (branch.events[k] || []).join(" ")]);
  });
  return [["branch", ...columns.map(column => column.label), "event"], rows];
}
