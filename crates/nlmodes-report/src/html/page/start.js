// The page as a whole: what is chosen, and who is notified.

const DATA = unpackData(JSON.parse(document.getElementById("data").textContent));

function begin() {
  const byId = id => document.getElementById(id);
  document.documentElement.classList.add("live");
  const boxes = ["main", "energy", "amplitude"].map(id => [byId(id), id]).filter(([box]) => box);
  let chosen = null;
  const figures = boxes.length ? branchFigures(boxes, byId("participation"), byId("legend"), (key, index) => choose(key, index)) : null;
  const motion = byId("motion") && new Motion(byId("motion"), byId("controls"));

  function choose(key, index) {
    const branch = DATA.branches[key];
    if (!branch || !(index in branch.frequency)) return;
    chosen = { key, index };
    if (figures) figures.charts().forEach(chart => chart.choose(key, index));
    const shown = motion ? motion.show(branch, index) : null;
    showDetails(byId("details"), branch, index, shown);
    if (byId("point")) { byId("point").max = branch.frequency.length - 1; byId("point").value = index; }
    if (byId("branch")) byId("branch").value = key;
    byId("walk")?.querySelector("output")?.replaceChildren(`${numberOf(branch, index)} of ${numberOf(branch, branch.frequency.length - 1)}`);
    showContact(branch, shown);
  }

  /// Displacement and force of the contacts over the period that moves above.
  function showContact(branch, shown) {
    const box = byId("contact");
    if (!box) return;
    box.replaceChildren();
    motion.onPhase = null;
    if (!motion.frame || shown === null) return;
    const period = 1 / branch.frequency[shown];
    const one = (contact, number) => contact && {
      time: contact.t.map(phase => period * phase), displacement: contact.u, force: contact.f,
      stop: branch.motion.stops[number].at, instants: [], label: `stop ${branch.motion.stops[number].number}`,
    };
    const all = motion.frame.contacts.map(one).filter(Boolean);
    if (!all.length) return;
    motion.frame.contacts.map((contact, k) => contact && branch.motion.stops[k].number).filter(number => number !== null).forEach((number, k) => {
      Object.assign(all[k], { wall: stopColor(number), color: all.length > 1 ? stopColor(number) : "#222222", dash: stopDash(number) });
    });
    const history = { ...all[0], others: all.slice(1) };
    if (history.others.length) curveNames(box, history);
    const spec = historySpec(`Contacts at point ${numberOf(branch, shown)}`, history, 130);
    const chart = new Chart(html(box, "div", { class: "plot plain" }), spec);
    motion.onPhase = phase => chart.moveCursor(phase * period * spec.clock.perSi);
    motion.onPhase(motion.player.phase);
  }

  if (byId("wire") && DATA.wire) new Wire(byId("wire"), DATA.wire);
  walk(byId("walk"), () => chosen, choose);
  if (figures && byId("lay")) layOver(byId("lay"), branch => {
    DATA.branches.push(branch);
    figures.redraw();
    const select = byId("branch");
    if (select) html(select, "option", { value: DATA.branches.length - 1 }, branch.label);
  });
  for (const box of document.querySelectorAll("[data-history]")) {
    const history = DATA.histories[Number(box.dataset.history)];
    if (history.others.length) curveNames(box, history);
    new Chart(box, historySpec(history.name, history, 130));
  }
  for (const button of document.querySelectorAll("button[data-point]")) {
    button.addEventListener("click", () => {
      choose(Number(button.dataset.branch), Number(button.dataset.point));
      byId("branches").scrollIntoView({ block: "start" });
    });
  }
  const first = largestResponse() || DATA.marks[DATA.marks.length - 1] || [0, 0];
  if (DATA.branches.length && DATA.branches[first[0]].frequency.length) choose(first[0], first[1]);
}

/// Branch and point of the largest response; none on a page without responses.
function largestResponse() {
  if (!(DATA.quantities || []).length) return null;
  let found = null, most = 0;
  DATA.branches.forEach((branch, key) => (branch.extra && branch.extra[0] || []).forEach((value, index) => {
    if (Math.abs(value) > most) [found, most] = [[key, index], Math.abs(value)];
  }));
  return found;
}

/// Controls that choose the branch and the point.
function walk(box, chosen, choose) {
  if (!box) return;
  if (DATA.branches.length > 1) {
    const label = html(box, "label", {}, "branch ");
    const select = html(label, "select", { id: "branch" });
    DATA.branches.forEach((branch, key) => html(select, "option", { value: key }, branch.label));
    select.addEventListener("change", () => {
      const key = Number(select.value);
      choose(key, Math.min(chosen().index, DATA.branches[key].frequency.length - 1));
    });
  }
  const step = by => chosen() && choose(chosen().key, chosen().index + by);
  const arrow = (text, name, by) =>
    html(box, "button", { type: "button", "aria-label": name, title: name }, text).addEventListener("click", () => step(by));
  arrow("◀", "Previous point", -1);
  const label = html(box, "label", { class: "grow" }, "point along the branch ");
  const slider = html(label, "input", { type: "range", min: 0, value: 0, step: 1, id: "point" });
  html(label, "output", { class: "reading" });
  slider.addEventListener("input", () => chosen() && choose(chosen().key, Number(slider.value)));
  arrow("▶", "Next point", 1);
}

function showDetails(box, branch, index, shown) {
  if (!box) return;
  box.replaceChildren();
  html(box, "h3", {}, `Point ${numberOf(branch, index)}`);
  if (DATA.branches.length > 1) html(box, "p", { class: "quiet" }, branch.label);
  if (shown !== null && shown !== index) html(box, "p", { class: "quiet" }, `The page shows the motion of point ${numberOf(branch, shown)}, the nearest that it holds.`);
  const table = html(html(box, "table"), "tbody");
  for (const [name, value] of facts(branch, index)) {
    const row = html(table, "tr", { class: name.length + value.length > 36 ? "wide" : null });
    html(row, "th", { scope: "row" }, name);
    html(row, "td", {}, value);
  }
  if (branch.force.some(force => force > 0)) html(box, "p", { class: "hint" }, "* of short blows the largest force need not converge with harmonics; the impulse does, at equal energy sooner than at equal frequency.");
  const shares = branch.shares[index];
  if (shares && shares.length > 1) showShares(box, shares);
}

/// Bars of the kinetic energy in each harmonic, on a logarithmic scale of eight decades.
function showShares(box, shares) {
  const open = box.dataset.shares === "open";
  const fold = html(box, "details", { open: open ? "" : null });
  fold.addEventListener("toggle", () => { box.dataset.shares = fold.open ? "open" : ""; });
  html(fold, "summary", {}, "kinetic energy by harmonic");
  const figure = html(fold, "figure", { class: "shares" });
  html(figure, "figcaption", {}, "bars: logarithmic, eight decades");
  shares.forEach((share, n) => {
    if (n === 0) return;
    const row = html(figure, "div");
    html(row, "span", {}, String(n));
    const length = share > 0 ? Math.max(0, 1 + Math.log10(share) / 8) : 0;
    const picture = svg(row, "svg", { viewBox: "0 0 100 8", preserveAspectRatio: "none", "aria-hidden": "true" });
    svg(picture, "rect", { width: (100 * length).toFixed(2), height: 8, fill: DATA.branches[0].color });
    html(row, "span", {}, share > 0 ? significant(100 * share, 3) + " %" : "0");
  });
}

begin();
