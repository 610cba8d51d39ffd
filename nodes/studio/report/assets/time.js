// Plots against time: their values under the pointer, and their axis.
"use strict";
(() => {
  // Values of every plot against time at the time under the pointer.
  const NS = "http://www.w3.org/2000/svg";
  const grid = document.querySelector("[data-phases]"), begins = grid ? grid.dataset.phases.split(" ").map(Number) : [];
  const placeOf = (time) => {
    let phase = 0;
    while (phase + 2 < begins.length && begins[phase + 1] < time) phase++;
    return phase + (time - begins[phase]) / (begins[phase + 1] - begins[phase] || 1);
  };
  const timeOf = (place) => {
    const phase = Math.min(Math.max(Math.floor(place), 0), begins.length - 2);
    return begins[phase] + (place - phase) * (begins[phase + 1] - begins[phase]);
  };
  const plots = [...document.querySelectorAll("#time [data-axis]")].map((half) => {
    const drawing = half.closest(".drawing"), isTime = half.dataset.axis === "time";
    const svg = half.querySelector("svg"), numbers = (key) => svg.dataset[key].split(" ").map(Number);
    const [left, top, right, bottom] = numbers("frame"), [low, high] = numbers("x");
    let series = null;
    const read = () => {
      if (series) return series;
      series = new Map();
      for (const line of drawing.querySelector("script").textContent.trim().split("\n").slice(1)) {
        const [name, time, value] = line.split(",");
        if (!series.has(name)) series.set(name, []);
        series.get(name).push([1e3 * time, Number(value)]);
      }
      return series;
    };
    const line = document.createElementNS(NS, "line"), readout = document.createElement("div");
    line.setAttribute("class", "cursor");
    line.setAttribute("data-cursor", "");
    line.setAttribute("y1", top);
    line.setAttribute("y2", bottom);
    line.style.display = readout.style.display = "none";
    readout.className = "readout";
    readout.setAttribute("aria-hidden", "true");
    svg.append(line);
    drawing.append(readout);
    const show = (time, withText) => {
      const x = left + (((isTime ? time : placeOf(time)) - low) / (high - low)) * (right - left);
      const inside = x >= left && x <= right;
      line.style.display = inside ? "" : "none";
      readout.style.display = inside && withText ? "" : "none";
      if (!inside) return;
      line.setAttribute("x1", x);
      line.setAttribute("x2", x);
      if (!withText) return;
      const rows = [`${time.toPrecision(5)} ms`];
      for (const [name, points] of read()) {
        let [from, to] = [0, points.length - 1];
        while (to - from > 1) { const half = (from + to) >> 1; if (points[half][0] <= time) from = half; else to = half; }
        const near = Math.abs(points[from][0] - time) < Math.abs(points[to][0] - time) ? from : to;
        rows.push(`${read().size > 1 ? name + "  " : ""}${points[near][1].toPrecision(5)}`);
      }
      readout.textContent = rows.join("\n");
      const share = svg.clientWidth / svg.viewBox.baseVal.width, at = x * share;
      readout.style.top = `${top * share + 4}px`;
      readout.style.left = at > svg.clientWidth / 2 ? "auto" : `${at + 8}px`;
      readout.style.right = at > svg.clientWidth / 2 ? `${svg.clientWidth - at + 8}px` : "auto";
    };
    const hide = () => { line.style.display = readout.style.display = "none"; };
    const timeAt = (e) => {
      const box = svg.getBoundingClientRect();
      const at = low + ((((e.clientX - box.left) / box.width) * svg.viewBox.baseVal.width - left) / (right - left)) * (high - low);
      return isTime ? at : timeOf(at);
    };
    return { svg, show, hide, timeAt };
  });
  plots.forEach((plot) => {
    plot.svg.addEventListener("pointermove", (e) => plots.forEach((p) => p.show(plot.timeAt(e), p === plot)));
    plot.svg.addEventListener("pointerleave", () => plots.forEach((p) => p.hide()));
  });

  // The horizontal axis of all plots against time.
  document.querySelectorAll("[data-show]").forEach((button) => button.addEventListener("click", () => {
    document.querySelectorAll("[data-show]").forEach((b) => b.setAttribute("aria-pressed", b === button));
    grid.classList.toggle("by-time", button.dataset.show === "time");
  }));
})();
