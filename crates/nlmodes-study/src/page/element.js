"use strict";
// Elements, columns and numbers.

const DATA = JSON.parse(document.getElementById("data").textContent);

function element(parent, name, attributes, text) {
  const node = document.createElement(name);
  for (const [key, value] of Object.entries(attributes || {})) node.setAttribute(key, value);
  if (text !== undefined) node.textContent = text;
  if (parent) parent.append(node);
  return node;
}

const column = name => DATA.columns.find(found => found.name === name);
/** The label of an axis: quantities with the column they are of, which ends with its unit. */
const label = name => DATA.labels[name] ?? name;
const numeric = DATA.columns.filter(found => found.kind === "number" && !found.name.endsWith("_error"));
const caseName = row => `case ${column("case").cells[row]}`;

/// A number for people, with so many digits.
function shown(value, digits = 6) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  return String(Number(value.toPrecision(digits))).replace("-", "−");
}

/// A list to choose from.
function choice(parent, label, names, chosen, act) {
  const select = element(element(parent, "label", {}, label + " "), "select");
  for (const name of names) element(select, "option", name === chosen ? { value: name, selected: "" } : { value: name }, name);
  select.addEventListener("change", () => act(select.value));
  return select;
}

/// The value below which a share of sorted numbers lies.
function quantile(sorted, share) {
  const place = share * (sorted.length - 1), below = Math.floor(place), above = Math.min(below + 1, sorted.length - 1);
  return sorted[below] + (place - below) * (sorted[above] - sorted[below]);
}

/// Opens the directory or the page of a case.
function openCase(row) {
  const link = DATA.links[row];
  if (link) window.open(link, "_blank", "noopener");
}
