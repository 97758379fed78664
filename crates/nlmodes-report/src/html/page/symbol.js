// Symbols of events: the shapes of the figures beside this page.

const CORNERS = {
  triangle: [3, 5.8, 0], "triangle-down": [3, 5.8, 0.5], square: [4, 5.8, 0.5], diamond: [4, 6, 0], pentagon: [5, 5.4, 0],
};

function symbol(parent, shape, x, y, color, name, open) {
  const attributes = open ? { class: "symbol open", stroke: color } : { class: "symbol", fill: color };
  let node;
  if (shape === "plus" || shape === "cross") {
    const arm = [[-0.32, 6], [0.32, 6], [Math.PI / 4, 2.7]], turn = shape === "cross" ? 0.5 : 0;
    const corner = (k, [angle, r]) => {
      const at = angle + Math.PI / 2 * (k + turn - 1);
      return (x + r * Math.cos(at)).toFixed(2) + "," + (y + r * Math.sin(at)).toFixed(2);
    };
    node = svg(parent, "polygon", { ...attributes, points: [0, 1, 2, 3].flatMap(k => arm.map(end => corner(k, end))).join(" ") });
  } else if (shape === "star" || CORNERS[shape]) {
    const [n, radius, turn] = CORNERS[shape] || [10, 6.6, 0];
    const corner = k => {
      const angle = 2 * Math.PI * (k + turn) / n - Math.PI / 2;
      const r = shape === "star" && k % 2 ? 2.8 : radius;
      return (x + r * Math.cos(angle)).toFixed(2) + "," + (y + r * Math.sin(angle)).toFixed(2);
    };
    node = svg(parent, "polygon", { ...attributes, points: Array.from({ length: n }, (_, k) => corner(k)).join(" ") });
  } else {
    node = svg(parent, "circle", { ...attributes, cx: x.toFixed(2), cy: y.toFixed(2), r: shape === "dot" ? 3.2 : 4.6 });
  }
  if (name) svg(node, "title", {}, name);
  return node;
}
