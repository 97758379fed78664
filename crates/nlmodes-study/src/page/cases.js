// The table of cases.

const PAGE = 100;

function cases(section) {
  element(section, "h2", {}, "Cases");
  const controls = element(section, "div", { class: "controls" });
  const state = { page: 0, by: "case", down: false, status: "all" };
  const statuses = ["all", ...new Set(column("status").cells)];
  choice(controls, "show", statuses, "all", name => { state.status = name; state.page = 0; draw(); });
  const back = element(controls, "button", { type: "button" }, "back"), on = element(controls, "button", { type: "button" }, "on");
  const where = element(controls, "span", { class: "quiet" });
  const table = element(element(section, "div", { class: "scroll" }), "table");
  const head = element(element(table, "thead"), "tr"), body = element(table, "tbody");
  for (const { name } of DATA.columns) {
    const button = element(element(head, "th"), "button", { type: "button", title: "Sort by this column" }, name);
    button.addEventListener("click", () => { state.down = state.by === name && !state.down; state.by = name; draw(); });
  }
  back.addEventListener("click", () => { state.page--; draw(); });
  on.addEventListener("click", () => { state.page++; draw(); });

  function sorted() {
    const cells = column(state.by).cells, status = column("status").cells;
    const rows = cells.map((_, row) => row).filter(row => state.status === "all" || status[row] === state.status);
    const order = (a, b) => (a === b ? 0 : a === null ? 1 : b === null ? -1 : (a < b ? -1 : 1) * (state.down ? -1 : 1));
    return rows.sort((a, b) => order(cells[a], cells[b]) || a - b);
  }

  function draw() {
    const rows = sorted(), pages = Math.max(1, Math.ceil(rows.length / PAGE));
    state.page = Math.min(Math.max(0, state.page), pages - 1);
    [back.disabled, on.disabled] = [state.page === 0, state.page === pages - 1];
    where.textContent = `${rows.length} cases, page ${state.page + 1} of ${pages}`;
    body.replaceChildren();
    for (const row of rows.slice(state.page * PAGE, (state.page + 1) * PAGE)) {
      const line = element(body, "tr");
      for (const { name, kind, cells } of DATA.columns) {
        const cell = element(line, "td", kind === "number" ? { class: "number" } : {});
        const text = kind === "number" ? shown(cells[row], name.endsWith("_error") ? 2 : 9) : cells[row] ?? "";
        if (name === "case" && DATA.links[row]) element(cell, "a", { href: DATA.links[row] }, text);
        else cell.textContent = text;
      }
    }
  }
  draw();
}
