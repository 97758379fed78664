// The page begins.

const figures = document.getElementById("figures");
const pair = element(figures, "div", { class: "pair" });
if (numeric.length > 1) {
  scatter(element(pair, "div", { class: "box" }));
  histogram(element(pair, "div", { class: "box" }));
}
if (DATA.drawn.length > 0) {
  branches(element(figures, "div", { class: "box" }));
}
cases(document.getElementById("cases"));
