// Tables whose headings sort them.

function sortable(table) {
  const body = element("tbody");
  const fill = (rows) => body.replaceChildren(...rows.map((row) => element("tr", {}, ...row.map((cell, i) => {
    const tag = i === 0 ? "th" : "td";
    return element(tag, { scope: i === 0 ? "row" : null, class: table.columns[i].numbers ? "number" : null }, cell.text);
  }))));
  const headings = table.columns.map((column, i) => {
    const unit = column.unit ? element("span", { class: "unit" }, ` ${column.unit}`) : null;
    const title = column.group ? `${column.group}: ${column.title}` : column.title;
    const button = element("button", { type: "button", onclick: () => sort(i) }, title, unit);
    return element("th", { scope: "col", "aria-sort": "none", class: column.numbers ? "number" : null }, button);
  });
  function sort(i) {
    const direction = headings[i].getAttribute("aria-sort") === "ascending" ? -1 : 1;
    headings.forEach((heading) => heading.setAttribute("aria-sort", "none"));
    headings[i].setAttribute("aria-sort", direction === 1 ? "ascending" : "descending");
    const compare = (a, b) => {
      if (!table.columns[i].numbers) return direction * a[i].text.localeCompare(b[i].text, undefined, { numeric: true });
      // What is not known is last either way.
      if (a[i].value === null || b[i].value === null) return (a[i].value === null) - (b[i].value === null);
      return direction * (a[i].value - b[i].value);
    };
    fill([...table.rows].sort(compare));
  }
  fill(table.rows);
  const caption = element("caption", {}, table.title);
  const grid = element("table", { id: `table-${table.name}` }, caption, element("thead", {}, element("tr", {}, ...headings)), body);
  const notes = table.notes.map((note) => element("p", { class: "hint" }, note));
  return element("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": table.title }, grid, ...notes);
}

// The first table has a row for each fit, and is shown; the others are folded, except where they are what the scene asks for.
const SHOWN = ["overview", "frequencies", "motion"];

function showTables(record) {
  const tables = byId("tables");
  const shown = ({ name }) => SHOWN.includes(name);
  tables.append(...record.tables.filter(shown).map(sortable));
  for (const table of record.tables.filter((table) => !shown(table))) tables.append(element("details", {}, element("summary", {}, table.title), sortable(table)));
  if (!record.tables.length) tables.append(element("p", { class: "missing" }, "The run has no fits, so there is no table."));
}
