// Curves between computed points: cubic pieces that go beyond none of them, as in the figures beside this page.

/// The course of a path through points [x, y]; it may turn at the points with these positions in the list.
function smoothCourse(points, corners) {
  const text = ([x, y]) => x.toFixed(2) + "," + y.toFixed(2);
  let course = "M" + text(points[0]), start = 0;
  for (const end of [...corners.filter(k => k > 0 && k < points.length - 1), points.length - 1]) {
    if (end > start) course += cubics(points.slice(start, end + 1)).map(([a, b, c]) => `C${text(a)} ${text(b)} ${text(c)}`).join("");
    start = end;
  }
  return course;
}

function cubics(points) {
  const steps = points.slice(1).map(([x, y], k) => Math.max(1e-9, Math.hypot(x - points[k][0], y - points[k][1])));
  const [u, v] = [0, 1].map(axis => slopes(points.map(point => point[axis]), steps));
  return steps.map((step, k) => {
    const [[x0, y0], [x1, y1], third] = [points[k], points[k + 1], step / 3];
    return [[x0 + third * u[k], y0 + third * v[k]], [x1 - third * u[k + 1], y1 - third * v[k + 1]], [x1, y1]];
  });
}

/// Slopes of Steffen (1990): those of the parabola through three neighbours, limited so that each piece is monotone.
function slopes(values, steps) {
  const secants = steps.map((step, k) => (values[k + 1] - values[k]) / step), last = secants.length - 1;
  const limited = (slope, bound) => (slope * bound <= 0 ? 0 : Math.sign(bound) * Math.min(Math.abs(slope), Math.abs(bound)));
  const atEnd = (near, next) => {
    const share = steps[near] / (steps[near] + steps[next]);
    return limited(secants[near] * (1 + share) - secants[next] * share, 2 * secants[near]);
  };
  return values.map((_, k) => {
    if (last === 0) return secants[0];
    if (k === 0) return atEnd(0, 1);
    if (k > last) return atEnd(last, last - 1);
    const [before, after] = [secants[k - 1], secants[k]];
    const parabola = (before * steps[k] + after * steps[k - 1]) / (steps[k - 1] + steps[k]);
    return before * after <= 0 ? 0 : limited(parabola, 2 * Math.sign(before) * Math.min(Math.abs(before), Math.abs(after)));
  });
}
