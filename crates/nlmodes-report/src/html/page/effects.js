// Peak and jumps of a response, and what each slider does to the one that is chosen, as arrows at the sliders.

const NO_EFFECTS = "–";
// Per cent that are shown as none.
const NOTHING = 0.005;

class Effects {
  constructor(box, form) {
    Object.assign(this, { box, form, levels: [], level: 0, quantity: 0 });
  }

  /// What is not known any more is faint until it is known again.
  fade() {
    this.box.classList.add("old");
    this.form.classList.add("old");
  }

  show(levels) {
    this.levels = levels.filter(level => level.quantities.length);
    this.box.hidden = !this.levels.length;
    this.box.classList.remove("old");
    this.form.classList.remove("old");
    if (this.levels.length) this.draw();
  }

  draw() {
    this.box.replaceChildren();
    html(this.box, "h2", { class: "plain" }, "Peak and jumps");
    const table = html(html(this.box, "table"), "tbody");
    this.levels.forEach((level, k) => {
      if (this.levels.length > 1) html(html(table, "tr"), "th", { colspan: 2, class: "level" }, level.level);
      level.quantities.forEach((quantity, number) => {
        const row = html(table, "tr"), head = html(row, "th", { scope: "row" }), id = `effect-${k}-${number}`;
        const chosen = k === this.level && number === this.quantity;
        const input = html(head, "input", { type: "radio", name: "effect", id, checked: chosen ? "" : null });
        html(head, "label", { for: id }, quantity.name);
        html(row, "td", {}, this.told(quantity));
        input.addEventListener("change", () => { Object.assign(this, { level: k, quantity: number }); this.arrows(); });
      });
    });
    html(this.box, "p", { class: "quiet" }, "Arrows: which way each slider raises what is chosen, in % for 1 % of its value.");
    this.arrows();
  }

  told(quantity) {
    if (quantity.unit === "Hz") return hertz(quantity.value);
    const unit = quantity.unit === "m" ? fine("m", quantity.value) : prefixed(quantity.unit, quantity.value);
    return `${significant(quantity.value * unit.perSi, 4)} ${unit.symbol} at ${significant(quantity.frequency, 5)} Hz`;
  }

  /// An arrow at each slider, as long as its effect beside the largest one.
  arrows() {
    const level = this.levels[Math.min(this.level, this.levels.length - 1)];
    const quantity = level.quantities[Math.min(this.quantity, level.quantities.length - 1)];
    const sizes = Object.values(quantity.effects).map(Math.abs), largest = Math.max(...sizes, Number.MIN_VALUE);
    for (const place of this.form.querySelectorAll(".arrow")) {
      place.replaceChildren();
      const effect = quantity.effects[place.dataset.key];
      if (effect === undefined) { html(place, "span", {}, NO_EFFECTS); continue; }
      const half = 100, length = half * Math.abs(effect) / largest, sign = Math.sign(effect), end = half + sign * length;
      const picture = svg(place, "svg", { viewBox: "0 0 200 10", role: "img", "aria-label": `${quantity.name}: ${significant(effect, 3)} % for 1 %` });
      svg(picture, "line", { x1: half, x2: half, y1: 0, y2: 10, class: "middle" });
      if (length > 1) {
        const head = Math.min(6, length);
        svg(picture, "line", { x1: half, x2: end - sign * head, y1: 5, y2: 5, class: "shaft" });
        svg(picture, "path", { d: `M${end},5 l${-sign * head},-4 v8 z`, class: "head" });
      }
      html(place, "span", {}, Math.abs(effect) < NOTHING ? "0 %" : `${effect > 0 ? "+" : ""}${significant(effect, 2)} %`);
    }
  }
}
