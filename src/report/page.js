// Tables sort by the heading that is clicked, the other way when it is clicked again.
for (const table of document.querySelectorAll("table.sortable")) {
  table.querySelectorAll("th").forEach((heading, column) => {
    let down = false;
    heading.addEventListener("click", () => {
      const body = table.querySelector("tbody");
      const key = (row) => {
        const cell = row.children[column];
        const value = cell.dataset.value;
        return value === undefined ? cell.textContent : Number(value);
      };
      const order = (a, b) => {
        const [x, y] = [key(a), key(b)];
        return typeof x === "number" ? x - y : x.localeCompare(y);
      };
      const rows = [...body.rows].sort(order);
      if (down) rows.reverse();
      down = !down;
      body.append(...rows);
    });
  });
}
