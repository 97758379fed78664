"use strict";
// Elements of the page and numbers for people.

const SVG_SPACE = "http://www.w3.org/2000/svg";

function fill(node, parent, attributes, text) {
  for (const [name, value] of Object.entries(attributes || {})) {
    if (value !== null && value !== undefined) node.setAttribute(name, value);
  }
  if (text !== undefined) node.textContent = text;
  if (parent) parent.append(node);
  return node;
}

const svg = (parent, name, attributes, text) => fill(document.createElementNS(SVG_SPACE, name), parent, attributes, text);
const html = (parent, name, attributes, text) => fill(document.createElement(name), parent, attributes, text);

const RAISED = { "-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹" };
const raised = exponent => [...String(exponent)].map(character => RAISED[character]).join("");
const TIMES_TEN = "\u2009×\u200910";
const minus = text => text.replace(/-/g, "−");

/// A number with so many significant digits: 4.97, 1.24×10⁹.
function significant(value, digits) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  // The power of ten is that of the rounded number: 0.9999 is 1.00.
  const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
  if (exponent >= -3 && exponent < 5) return minus(value.toFixed(Math.max(0, digits - 1 - exponent)));
  return minus(mantissa) + TIMES_TEN + raised(Number(exponent));
}

const hertz = value => significant(value, 7) + " Hz";

/// The multiple of an SI unit that makes numbers up to `largest` easy to read.
function prefixed(symbol, largest) {
  const power = largest > 0 ? Math.min(3, Math.max(-3, Math.floor(Math.log10(largest / 0.2) / 3))) : 0;
  const prefix = { "-3": "n", "-2": "µ", "-1": "m", 0: "", 1: "k", 2: "M", 3: "G" }[power];
  return { symbol: prefix + symbol, perSi: 10 ** (-3 * power) };
}

/// As `prefixed`, but lengths and times that are large keep the unit.
const fine = (symbol, largest) => prefixed(symbol, Math.min(largest, 100));

const largest = values => values.reduce((most, value) => (Number.isFinite(value) ? Math.max(most, Math.abs(value)) : most), 0);
