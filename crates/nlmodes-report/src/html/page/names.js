// Where the names of symbols are placed: on nothing else, as far as there is room.

const HIDES = 100;
/// Least distance of two names on one line, pixels: closer ones read as one.
const APART = 10;

/// The cheapest place for a name of this size beside [x, y] within the frame; none where it would hide a symbol or another name.
/// taken: { places: [[x, y], …] of curves, symbols: [[x, y], …], boxes: [{x, y, width, height}, …] }
function namePlace([x, y], { width, height }, frame, taken, mustStay) {
  const sides = [[1, 0.6], [1, -0.6], [-1, -0.6], [-1, 0.6], [0, -1], [0, 1], [1, 0], [-1, 0]];
  let best = null;
  [8, 18, 32, 50].forEach((distance, ring) => sides.forEach(([side, up]) => {
    const box = { x: x + side * (distance + width / 2) - width / 2, y: y + up * (distance + height / 2) - height / 2, width, height, far: ring > 1 };
    const cost = nameCost(box, frame, taken) + (box.far && leadsThrough([x, y], box, taken.boxes) ? HIDES : 0);
    if (!best || cost < best.cost) best = { ...box, cost };
  }));
  return best.cost < HIDES || mustStay ? best : null;
}

/// Whether the line from a symbol to its name runs through another name.
function leadsThrough([x, y], box, boxes) {
  const near = [Math.min(Math.max(x, box.x), box.x + box.width), Math.min(Math.max(y, box.y), box.y + box.height)];
  const onWay = share => [x + share * (near[0] - x), y + share * (near[1] - y)];
  const holds = (other, [a, b]) => a >= other.x && a <= other.x + other.width && b >= other.y && b <= other.y + other.height;
  return Array.from({ length: 17 }, (_, k) => onWay(k / 16)).some(at => boxes.some(other => holds(other, at)));
}

function nameCost(box, frame, { places, symbols, boxes }) {
  const holds = margin => ([x, y]) =>
    x > box.x - margin && x < box.x + box.width + margin && y > box.y - margin && y < box.y + box.height + margin;
  const crosses = other =>
    box.x < other.x + other.width + APART && other.x < box.x + box.width + APART && box.y < other.y + other.height && other.y < box.y + box.height;
  const outside = box.x < frame.left + 2 || box.y < frame.top + 2
    || box.x + box.width > frame.left + frame.width - 2 || box.y + box.height > frame.top + frame.height - 2;
  return places.filter(holds(1.5)).length + HIDES * (symbols.filter(holds(7)).length + 2 * boxes.filter(crosses).length)
    + (box.far ? 3 : 0) + (outside ? 20 * HIDES : 0);
}

/// Places along a line of pixels, four pixels apart.
function along(points) {
  const found = [];
  for (let k = 1; k < points.length; k++) {
    const [[a, b], [c, d]] = [points[k - 1], points[k]], n = Math.min(500, Math.max(1, Math.ceil(Math.hypot(c - a, d - b) / 4)));
    for (let j = 0; j < n; j++) found.push([a + (c - a) * j / n, b + (d - b) * j / n]);
  }
  return found;
}
