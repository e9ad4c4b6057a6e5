"use strict";
for (const table of document.querySelectorAll("table.ranking")) {
  const headings = [...table.tHead.rows[0].cells];
  const body = table.tBodies[0];

  function compare(a, b, column, isText, sign) {
    const [x, y] = [a, b].map((row) => row.cells[column].dataset.value);
    if (x === "" || y === "") return (x === "") - (y === ""); // nothing to sort by goes last, either way
    return sign * (isText ? x.localeCompare(y) : Number(x) - Number(y));
  }

  function sortBy(column) {
    const heading = headings[column];
    const descending = heading.getAttribute("aria-sort") === "ascending";
    const isText = heading.classList.contains("text");
    const rows = [...body.rows].sort((a, b) => compare(a, b, column, isText, descending ? -1 : 1));
    for (const other of headings) other.setAttribute("aria-sort", "none");
    heading.setAttribute("aria-sort", descending ? "descending" : "ascending");
    body.append(...rows);
  }

  headings.forEach((heading, column) => heading.firstElementChild.addEventListener("click", () => sortBy(column)));
}
