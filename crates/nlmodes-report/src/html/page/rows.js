// Tables that are longer than their place.

/// Height of that place, as the style has it.
const PLACE = 460;

/// Ends what is in view of a table behind a whole row: half a row looks like the end of a table that was cut.
function endWithRow(table) {
  // Scroll bars take room too. The place keeps its height while it is measured: without one its rows might break elsewhere.
  const box = table.parentElement, bars = box.offsetHeight - box.clientHeight;
  let end = 0;
  for (const row of table.rows) {
    const below = row.offsetTop + row.offsetHeight;
    if (below + bars > PLACE) break;
    end = below;
  }
  const height = end > 0 && end < table.offsetHeight - 1 ? `${end + bars}px` : "";
  if (box.style.maxHeight !== height) box.style.maxHeight = height;
}

/// Of tables that come into view later too, and anew where their rows break elsewhere or a scroll bar comes.
const rowsInView = new ResizeObserver(changes => changes.forEach(({ target }) => endWithRow(target.closest(".scroll").firstElementChild)));
document.querySelectorAll(".scroll > table").forEach(table => [table, table.parentElement].forEach(part => rowsInView.observe(part)));
