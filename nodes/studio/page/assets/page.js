// Theme, saved plots and data, sorted tables.
"use strict";
(() => {
  const root = document.documentElement;
  const isDark = () => (root.dataset.theme ? root.dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches);
  document.getElementById("theme")?.addEventListener("click", () => {
    root.dataset.theme = isDark() ? "light" : "dark";
    document.dispatchEvent(new Event("themechange"));
  });

  const save = (name, type, content) => {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([content], { type }));
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  };
  window.grainlabPage = { isDark, save };
  // A saved plot is that on paper: the light colours are resolved, because the style of the page does not go with it.
  const standalone = (svg) => {
    const before = root.dataset.theme;
    root.dataset.theme = "light";
    const copy = svg.cloneNode(true), from = [svg, ...svg.querySelectorAll("*")], to = [copy, ...copy.querySelectorAll("*")];
    from.forEach((element, n) => {
      const style = getComputedStyle(element);
      for (const key of ["fill", "stroke", "stroke-width", "stroke-dasharray", "fill-opacity", "stroke-opacity"]) {
        if (element !== svg) to[n].setAttribute(key, style.getPropertyValue(key));
      }
      to[n].removeAttribute("class");
    });
    if (before) root.dataset.theme = before; else delete root.dataset.theme;
    const box = svg.viewBox.baseVal;
    copy.setAttribute("width", box.width);
    copy.setAttribute("height", box.height);
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + new XMLSerializer().serializeToString(copy);
  };
  document.addEventListener("click", (e) => {
    const kind = e.target.dataset && e.target.dataset.save;
    if (!kind) return;
    const drawing = e.target.closest(".drawing"), name = `${drawing.id.replace(/^plot-/, "")}.${kind}`;
    if (kind === "csv") save(name, "text/csv", drawing.querySelector("script").textContent);
    else save(name, "image/svg+xml", standalone([...drawing.querySelectorAll("svg")].find((svg) => svg.getClientRects().length > 0)));
  });

  document.querySelectorAll(".sortable thead th").forEach((header) => {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...header.childNodes);
    header.append(button);
  });
  document.addEventListener("click", (e) => {
    const header = e.target.closest(".sortable thead th");
    if (!header) return;
    const table = header.closest("table"), column = header.cellIndex;
    const down = header.getAttribute("aria-sort") === "ascending";
    table.querySelectorAll("thead th").forEach((th) => th.removeAttribute("aria-sort"));
    header.setAttribute("aria-sort", down ? "descending" : "ascending");
    const key = (row) => {
      const cell = row.cells[column], text = cell.dataset.value !== undefined ? cell.dataset.value : cell.textContent;
      return text.trim() === "" ? null : Number.isFinite(Number(text)) ? Number(text) : text;
    };
    const order = (a, b) => {
      const [x, y] = [key(a), key(b)];
      if (x === null || y === null) return (x === null) - (y === null);
      const less = typeof x === "number" && typeof y === "number" ? x - y : String(x).localeCompare(String(y), "en", { numeric: true });
      return down ? -less : less;
    };
    const body = table.tBodies[0];
    [...body.rows].sort(order).forEach((row) => body.append(row));
  });
})();
