// Numbers that are on the page as text: whole ones of 16 bits with a factor, and columns of 32 bits.

const bytesOf = text => new DataView(Uint8Array.from(atob(text), letter => letter.charCodeAt(0)).buffer);

/// A series with a factor; null where there is no number.
function unpacked([scale, text]) {
  const view = bytesOf(text);
  return Array.from({ length: view.byteLength / 2 }, (_, i) => view.getInt16(2 * i, true)).map(whole => (whole === -32768 ? null : whole * scale));
}

/// So many rows of one length with one factor.
function unpackedRows([scale, width, text], count) {
  const all = unpacked([scale, text]), rows = count ?? (width ? all.length / width : 0);
  return Array.from({ length: rows }, (_, d) => all.slice(d * width, (d + 1) * width));
}

/// A column, packed or as it is.
function columnOf(column) {
  if (typeof column !== "string") return column;
  const view = bytesOf(column);
  const number = value => (Number.isFinite(value) ? Number(value.toPrecision(7)) : null);
  return Array.from({ length: view.byteLength / 4 }, (_, i) => number(view.getFloat32(4 * i, true)));
}

const COLUMNS = ["totalEnergy", "peak", "contactFraction", "force", "residual"];

/// A branch with its columns as numbers.
function unpackBranch(branch) {
  for (const id of COLUMNS) branch[id] = columnOf(branch[id]);
  branch.participation = branch.participation.map(columnOf);
  branch.extra = (branch.extra || []).map(columnOf);
  branch.stops = branch.stops.map(({ closed, impulse, force }) => ({ closed: columnOf(closed), impulse: columnOf(impulse), force: columnOf(force) }));
  const [width, shares] = branch.shares;
  if (typeof width === "number") {
    const all = columnOf(shares);
    branch.shares = branch.frequency.map((_, k) => {
      const row = all.slice(k * width, (k + 1) * width);
      while (row.length > 1 && !row[row.length - 1]) row.pop();
      return row;
    });
  }
  return branch;
}

/// Histories, and those drawn over them.
function unpackHistory(history) {
  for (const id of ["time", "displacement", "velocity", "acceleration", "force"]) history[id] = columnOf(history[id]);
  (history.others || []).forEach(unpackHistory);
  return history;
}

/// All that the page knows.
function unpackData(data) {
  data.branches.forEach(unpackBranch);
  (data.histories || []).forEach(unpackHistory);
  return data;
}
