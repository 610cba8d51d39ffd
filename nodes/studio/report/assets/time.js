// Plots against time: their values under the pointer, and their axis.
"use strict";
(() => {
  // Values of the curves under the pointer, read from their paths: a page that follows a run has no other data of them.
  const readout = document.createElement("div");
  readout.className = "readout";
  readout.setAttribute("aria-hidden", "true");
  readout.hidden = true;
  document.body.append(readout);
  const numbers = (text) => text.split(" ").map(Number);
  const rowsAt = (svg, x) => {
    const [left, top, right, bottom] = numbers(svg.dataset.frame), [low, high] = numbers(svg.dataset.x);
    const [lowest, highest, spacing] = svg.dataset.y.split(" ").map((v, n) => (n < 2 ? Number(v) : v));
    const valueOf = (y) => {
      const share = (bottom - y) / (bottom - top);
      // As many digits as a tenth of the unit of the plot gives.
      if (spacing === "log") return (lowest * (highest / lowest) ** share).toPrecision(2);
      const digits = Math.min(12, Math.max(0, 3 - Math.ceil(Math.log10(highest - lowest))));
      return (lowest + share * (highest - lowest)).toFixed(digits);
    };
    const at = low + ((x - left) / (right - left)) * (high - low);
    const isTime = svg.closest("[data-axis]").dataset.axis === "time";
    const rows = [isTime ? `${at.toPrecision(5)} ms` : `phase ${Math.floor(at) + 1}`], names = new Map();
    for (const path of svg.querySelectorAll("path[stroke=currentColor]")) {
      const d = path.getAttribute("d");
      // The legend is above the frame, each line behind its name; targets are faint.
      if (d.endsWith("h 12")) names.set(path.getAttribute("class"), path.previousElementSibling.textContent);
      if (d.endsWith("h 12") || path.hasAttribute("stroke-opacity")) continue;
      let near = null, first = Infinity, last = -Infinity;
      for (const corner of d.matchAll(/[ML] ([-\d.]+) ([-\d.]+)/g)) {
        const far = Math.abs(corner[1] - x);
        [first, last] = [Math.min(first, corner[1]), Math.max(last, corner[1])];
        if (near === null || far < near.far) near = { far, y: Number(corner[2]) };
      }
      // A curve has no value before its first corner and behind its last one, but for a few pixels.
      if (near && x > first - 4 && x < last + 4) rows.push([path.getAttribute("class"), valueOf(near.y)]);
    }
    return rows.map((row) => (typeof row === "string" ? row : `${names.has(row[0]) ? `${names.get(row[0])}  ` : ""}${row[1]}`));
  };
  let pointer = null;
  const showValues = () => {
    const svg = pointer && document.elementFromPoint(...pointer)?.closest("#curves svg[data-y]");
    readout.hidden = !svg;
    if (!svg) return;
    const box = svg.getBoundingClientRect(), x = ((pointer[0] - box.left) / box.width) * svg.viewBox.baseVal.width;
    const [left, , right] = numbers(svg.dataset.frame);
    readout.hidden = x < left || x > right;
    readout.textContent = rowsAt(svg, x).join("\n");
    readout.style.top = `${pointer[1] + 14}px`;
    readout.style.left = `${Math.min(pointer[0] + 14, innerWidth - readout.offsetWidth - 4)}px`;
  };
  document.addEventListener("pointermove", (e) => { pointer = [e.clientX, e.clientY]; showValues(); });
  document.documentElement.addEventListener("pointerleave", () => { pointer = null; showValues(); });
  addEventListener("scroll", showValues, { passive: true });
  document.addEventListener("curveschange", showValues);

  // The horizontal axis of all plots against time.
  document.querySelectorAll("[data-show]").forEach((button) => button.addEventListener("click", () => {
    document.querySelectorAll("[data-show]").forEach((b) => b.setAttribute("aria-pressed", b === button));
    document.getElementById("curves").classList.toggle("by-time", button.dataset.show === "time");
  }));
})();
