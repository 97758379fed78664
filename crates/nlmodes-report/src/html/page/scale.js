// Axes. A view is an interval of "places": the values themselves, or their decimal logarithms.

const toPlace = (kind, value) => (value === null ? NaN : kind === "log" ? (value > 0 ? Math.log10(value) : NaN) : value);
const fromPlace = (kind, place) => (kind === "log" ? 10 ** place : place);

/// The interval of the places, wider by a share on either side.
function span(places, share) {
  let low = Infinity, high = -Infinity;
  for (const place of places) {
    if (Number.isFinite(place)) { low = Math.min(low, place); high = Math.max(high, place); }
  }
  if (low > high) return [0, 1];
  const room = high > low ? share * (high - low) : 0.05 * Math.abs(low) || 0.5;
  return [low - room, high + room];
}

/// Ticks between two places: `{place, label}`, without a label between the labelled ones; three labels at least.
function ticks(kind, [low, high], target) {
  const of = n => (kind === "log" && logarithmicTicks(low, high, n)) || linearTicks(kind, low, high, n);
  for (let n = target; n < target + 6; n++) {
    const found = of(n);
    if (found.filter(tick => tick.label).length >= 3) return found;
  }
  return of(target);
}

/// Half of the width of a tick's label in pixels.
const halfLabel = label => 3.7 * label.length;

/// Ticks of an axis of so many pixels, as many as there is room for their labels; where even few are too long, some have none.
function roomyTicks(kind, view, pixels) {
  const px = pixels / (view[1] - view[0]);
  const fits = (tick, before) => !before || (tick.place - before.place) * px > halfLabel(tick.label) + halfLabel(before.label) + 10;
  for (let target = Math.max(3, Math.round(pixels / 75)); target > 2; target--) {
    const found = ticks(kind, view, target), labelled = found.filter(tick => tick.label);
    if (labelled.every((tick, k) => fits(tick, labelled[k - 1]))) return found;
  }
  let last = null;
  return ticks(kind, view, 3).map(tick => {
    const label = tick.label && fits(tick, last) ? tick.label : null;
    if (label) last = tick;
    return { ...tick, label };
  });
}

function linearTicks(kind, low, high, target) {
  const [from, to] = [fromPlace(kind, low), fromPlace(kind, high)];
  const rough = (to - from) / Math.max(1, target);
  const decade = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map(m => m * decade).find(s => s >= 0.999 * rough);
  const size = Math.max(Math.abs(from), Math.abs(to));
  if (!(step > 4e-16 * size)) return [];
  const exponent = size >= 1e-3 && size < 1e6 ? 0 : Math.floor(Math.log10(size));
  const decimals = Math.max(0, -Math.floor(Math.log10(step * 1.000001)) + exponent);
  const found = [];
  for (let k = Math.ceil(from / step - 1e-9); k * step <= to + 1e-9 * step; k++) {
    const number = minus((k * step / 10 ** exponent).toFixed(Math.min(decimals, 20)));
    const label = exponent === 0 || k === 0 ? number : number + TIMES_TEN + raised(exponent);
    found.push({ place: toPlace(kind, k * step), value: k * step, label });
  }
  return found;
}

/// Decades, or 1, 2, 5 times a power of ten, where three of them are in view; else nothing.
function logarithmicTicks(low, high, target) {
  const every = Math.ceil((high - low) / Math.max(1, target));
  const all = [];
  for (let n = Math.floor(low); n <= Math.floor(high); n++) {
    for (let m = 1; m <= 9; m++) {
      const place = n + Math.log10(m);
      if (place >= low && place <= high) all.push({ m, n, place, value: m * 10 ** n });
    }
  }
  const labelled = set => all.filter(({ m, n }) => set.includes(m) && n % every === 0).length >= 3;
  const set = [[1], [1, 2, 5], [1, 2, 3, 4, 6, 8]].find(labelled);
  if (!set) return null;
  const plain = low >= -3.001 && high < 5;
  const text = ({ m, n, value }) =>
    plain ? value.toFixed(Math.max(0, -n)) : (m === 1 ? "10" : m + TIMES_TEN) + raised(n);
  return all.map(tick => ({ ...tick, label: set.includes(tick.m) && tick.n % every === 0 ? text(tick) : null }));
}
