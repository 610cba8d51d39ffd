// Plots: values under the pointer.
"use strict";
(() => {
  // Ends of an axis and its spacing: the value at a share of its length, and back.
  const axis = (text) => {
    const [low, high, spacing] = text.split(" ").map((v, n) => (n < 2 ? Number(v) : v)), log = spacing === "log";
    const [from, to] = log ? [Math.log(low), Math.log(high)] : [low, high];
    return { log, low, high, at: (s) => (log ? Math.exp(from + s * (to - from)) : from + s * (to - from)), share: (v) => ((log ? Math.log(v) : v) - from) / (to - from) };
  };
  // As many digits as a tenth of the unit of the plot gives.
  const written = (value, { log, low, high }) => {
    const text = log ? value.toPrecision(3) : value.toFixed(Math.min(12, Math.max(0, 3 - Math.ceil(Math.log10(high - low))))).replace(/^-(?=[0.]+$)/, "");
    return text.replace("-", "−");
  };
  const frame = (svg) => svg.dataset.frame.split(" ").map(Number);

  // Middle of an element; of a polygon that of its corners, since a triangle reaches further up than down.
  const middleOf = (e) => {
    const box = e.getBBox(), corners = [...(e.points ?? [])], mean = (key) => corners.reduce((sum, p) => sum + p[key], 0) / corners.length;
    return corners.length ? [mean("x"), mean("y")] : [box.x + box.width / 2, box.y + box.height / 2];
  };
  // Points of the markers of a series, and corners of its line.
  const placesOf = (series) => {
    const marks = [...series.querySelectorAll("circle,polygon")].map(middleOf);
    const line = series.querySelector("path:not([stroke-opacity]):not([d*=H])");
    return { marks, corners: line ? [...line.getAttribute("d").matchAll(/[ML] ([-\d.]+) ([-\d.]+)/g)].map((c) => [Number(c[1]), Number(c[2])]) : [] };
  };

  const readout = document.createElement("div");
  readout.className = "readout";
  readout.setAttribute("aria-hidden", "true");
  readout.hidden = true;
  document.body.append(readout);
  const rowsAt = (svg, x) => {
    const [left, top, right, bottom] = frame(svg), across = axis(svg.dataset.x), up = axis(svg.dataset.y);
    const at = across.at((x - left) / (right - left)), of = svg.closest("[data-axis]")?.dataset.axis, found = [];
    for (const series of svg.querySelectorAll(".series")) {
      const { marks, corners } = placesOf(series), points = marks.length ? marks : corners, near = points.reduce((best, p) => (best && Math.abs(best[0] - x) <= Math.abs(p[0] - x) ? best : p), null);
      // A point has a value near it; a curve none before its first corner and behind its last one, but for a few pixels.
      if (!near || Math.abs(near[0] - x) > (marks.length ? 14 : 4) && (marks.length || x < points[0][0] || x > points.at(-1)[0])) continue;
      found.push([marks.length ? across.at((near[0] - left) / (right - left)) : at, `${series.dataset.name} ${written(up.at((bottom - near[1]) / (bottom - top)), up)}`.trim()]);
    }
    if (!found.length) return [];
    // The last point is that of the last phase, also beyond its end.
    const [place] = found[0], begun = [...svg.querySelectorAll(".bands rect")].filter((band, n) => n === 0 || Number(band.getAttribute("x")) + 0.06 < left + (right - left) * across.share(place)).at(-1);
    const head = of === "phase" && begun ? `phase ${begun.textContent}` : `${svg.dataset.along || "x"} ${written(place, across)}`;
    return [head, ...found.map((row) => row[1])];
  };
  let pointer = null;
  const under = () => pointer && document.elementFromPoint(...pointer)?.closest("svg[data-frame]");
  const place = (svg, clientX) => {
    const box = svg.getBoundingClientRect();
    return ((clientX - box.left) / box.width) * svg.viewBox.baseVal.width;
  };
  const showValues = () => {
    const svg = under(), x = svg && place(svg, pointer[0]);
    const [left, , right] = svg ? frame(svg) : [0, 0, -1], rows = svg && x >= left && x <= right ? rowsAt(svg, x) : [];
    const said = pointer && document.elementFromPoint(...pointer)?.closest("[data-said]")?.dataset.said;
    readout.hidden = !said && rows.length < 2;
    readout.textContent = said || rows.join("\n");
    readout.style.top = `${(pointer?.[1] ?? 0) + 14}px`;
    readout.style.left = `${Math.min((pointer?.[0] ?? 0) + 14, innerWidth - readout.offsetWidth - 4)}px`;
  };

  document.addEventListener("pointermove", (e) => {
    pointer = [e.clientX, e.clientY];
    showValues();
  });
  document.documentElement.addEventListener("pointerleave", () => { pointer = null; showValues(); });
  addEventListener("scroll", showValues, { passive: true });
  // A page that follows a run may have drawn the plot again.
  document.addEventListener("curveschange", showValues);
})();
