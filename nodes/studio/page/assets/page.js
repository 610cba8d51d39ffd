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
  // A saved plot has the colours of the light page: they are resolved, because the style of the page does not go with it.
  const standalone = (svg) => {
    const copy = svg.cloneNode(true), from = [svg, ...svg.querySelectorAll("*")], to = [copy, ...copy.querySelectorAll("*")];
    from.forEach((element, n) => {
      const style = getComputedStyle(element);
      for (const key of ["fill", "stroke", "stroke-width", "stroke-dasharray", "fill-opacity", "stroke-opacity"]) {
        if (element !== svg) to[n].setAttribute(key, style.getPropertyValue(key));
      }
      to[n].removeAttribute("class");
    });
    copy.querySelectorAll("clipPath rect").forEach((rect) => rect.removeAttribute("fill"));
    return copy;
  };
  // A file has the width of a column of a journal, or of its page, and the caption below the plots.
  const file = (drawing) => {
    const svgs = [...drawing.querySelectorAll("svg")].filter((svg) => svg.getClientRects().length > 0), gap = 16;
    const boxes = svgs.map((svg) => svg.viewBox.baseVal), across = Math.min(svgs.length, svgs.length === 3 ? 3 : 2);
    const unit = Math.max(...boxes.map((b) => b.width)), row = Math.max(...boxes.map((b) => b.height)) + gap;
    const whole = document.createElementNS("http://www.w3.org/2000/svg", "svg"), width = across * (unit + gap) - gap;
    const { color, backgroundColor } = getComputedStyle(document.body);
    const paper = whole.appendChild(document.createElementNS("http://www.w3.org/2000/svg", "rect"));
    svgs.forEach((svg, n) => {
      const copy = standalone(svg), at = { x: (n % across) * (unit + gap), y: Math.floor(n / across) * row, width: boxes[n].width, height: boxes[n].height };
      for (const [key, value] of Object.entries(at)) copy.setAttribute(key, value);
      whole.append(copy);
    });
    // Figures without a caption share the paragraph above their grid.
    const caption = drawing.querySelector("figcaption > span:not(.save)") ?? drawing.parentElement.previousElementSibling?.closest("p");
    const words = [drawing.querySelector("h3"), caption].flatMap((e) => (e ? e.textContent.trim().replace(/[^.:]$/, "$&.").split(/\s+/) : []));
    const lines = words.reduce((all, word) => {
      if ((all[all.length - 1] + word).length * 6.2 > width) all.push("");
      all[all.length - 1] += `${word} `;
      return all;
    }, [""]);
    let y = Math.ceil(svgs.length / across) * row + 4;
    for (const line of lines) {
      const text = document.createElementNS("http://www.w3.org/2000/svg", "text");
      for (const [key, value] of Object.entries({ x: 8, y, fill: color, "font-size": 11, "font-family": "sans-serif" })) text.setAttribute(key, value);
      text.textContent = line.trim();
      whole.append(text);
      y += 15;
    }
    for (const [key, value] of Object.entries({ width, height: y, fill: backgroundColor })) paper.setAttribute(key, value);
    whole.setAttribute("viewBox", `0 0 ${width} ${y}`);
    whole.setAttribute("width", across === 1 ? "85mm" : "178mm");
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + new XMLSerializer().serializeToString(whole);
  };
  document.addEventListener("click", (e) => {
    const kind = e.target.dataset && e.target.dataset.save;
    if (!kind) return;
    const drawing = e.target.closest(".drawing"), name = `${drawing.id.replace(/^plot-/, "")}.${kind}`;
    if (kind === "csv") save(name, "text/csv", drawing.querySelector("script").textContent);
    else {
      const theme = root.dataset.theme ?? "";
      root.dataset.theme = "light";
      save(name, "image/svg+xml", file(drawing));
      root.dataset.theme = theme;
    }
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
      const cell = row.cells[column], text = cell.dataset.value !== undefined ? cell.dataset.value : cell.textContent.replace("−", "-");
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
