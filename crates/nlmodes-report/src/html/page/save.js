// Figures and their numbers as files.

const LOOK = ["fill", "fill-opacity", "stroke", "stroke-width", "stroke-dasharray", "stroke-opacity", "stroke-linejoin", "paint-order",
  "font-family", "font-size", "font-weight", "text-anchor", "font-variant-numeric"];

function saveAs(text, kind, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text], { type: kind }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

const fileName = (name, ending) => name.toLowerCase().replace(/[^a-z0-9]+/g, "_").replace(/^_|_$/g, "") + ending;

/// The figure as it is seen, with its looks written into its elements.
function saveFigure(picture, name) {
  const copy = picture.cloneNode(true), own = picture.querySelectorAll("*");
  copy.querySelectorAll("*").forEach((node, k) => {
    const look = getComputedStyle(own[k]);
    for (const property of LOOK) node.setAttribute(property, look.getPropertyValue(property));
  });
  copy.querySelectorAll(".overlay").forEach(node => node.remove());
  copy.setAttribute("xmlns", SVG_SPACE);
  const paper = document.createElementNS(SVG_SPACE, "rect");
  fill(paper, null, { width: "100%", height: "100%", fill: getComputedStyle(document.body).backgroundColor });
  copy.prepend(paper);
  saveAs(new XMLSerializer().serializeToString(copy), "image/svg+xml", fileName(name, ".svg"));
}

/// A table as comma-separated values: [names, rows].
function saveTable([names, rows], name) {
  const cell = value => (value === null || value === undefined ? "" : /[",\n]/.test(value) ? `"${String(value).replaceAll('"', '""')}"` : String(value));
  saveAs([names, ...rows].map(row => row.map(cell).join(",")).join("\n") + "\n", "text/csv", fileName(name, ".csv"));
}
