// Part of the time in all plots: chosen by dragging, drawn from the corners of the lines in the page.
"use strict";
(() => {
  const numbers = (text) => text.split(" ").map(Number), curves = document.getElementById("curves");
  // Chosen range of each horizontal axis.
  const chosen = { phase: null, time: null };
  const make = (name, attributes, content) => {
    const element = document.createElementNS("http://www.w3.org/2000/svg", name);
    Object.entries(attributes).forEach(([key, value]) => element.setAttribute(key, value));
    element.textContent = content ?? "";
    return element;
  };
  const marks = ([from, to]) => {
    const wanted = (to - from) / 6, decade = 10 ** Math.floor(Math.log10(wanted));
    const step = decade * [1, 2, 5, 10].find((m) => m * decade >= wanted), found = [];
    for (let n = Math.ceil(from / step); n * step <= to; n++) found.push([n * step, (n * step).toFixed(Math.max(0, -Math.floor(Math.log10(step))))]);
    return found;
  };
  const show = (svg) => {
    const axis = svg.closest("[data-axis]").dataset.axis, range = chosen[axis], frame = numbers(svg.dataset.frame), [left, top, right, bottom] = frame;
    svg.whole ??= { inside: svg.innerHTML, x: svg.dataset.x };
    svg.innerHTML = svg.whole.inside;
    svg.dataset.x = range ? range.join(" ") : svg.whole.x;
    if (!range) return;
    const [low, high] = numbers(svg.whole.x), valueAt = (px) => low + ((px - left) / (right - left)) * (high - low);
    const at = (value) => left + ((value - range[0]) / (range[1] - range[0])) * (right - left), moved = (px) => at(valueAt(Number(px)));
    const inside = (px) => px >= left && px <= right, clip = `within-${axis}-${[...curves.querySelectorAll("svg")].indexOf(svg)}`;
    const area = make("clipPath", { id: clip });
    area.append(make("rect", { x: left, y: top, width: right - left, height: bottom - top }));
    svg.prepend(area);
    for (const line of svg.querySelectorAll("path[stroke=currentColor]")) {
      const d = line.getAttribute("d");
      if (d.endsWith("h 12")) continue;
      line.setAttribute("d", d.replace(/([ML]) ([-\d.]+)/g, (_, letter, x) => `${letter} ${moved(x).toFixed(1)}`));
      line.setAttribute("clip-path", `url(#${clip})`);
    }
    for (const band of svg.querySelectorAll("rect.band,rect.paper:not(:first-of-type)")) {
      const x = Number(band.getAttribute("x"));
      if (!band.hasAttribute("x")) continue;
      const [from, to] = [moved(x), moved(x + Number(band.getAttribute("width")))].map((px) => Math.min(Math.max(px, left), right));
      band.setAttribute("x", from);
      band.setAttribute("width", to - from);
    }
    for (const text of svg.querySelectorAll("text[text-anchor=middle]")) {
      const x = moved(text.getAttribute("x"));
      if (axis === "time" && Number(text.getAttribute("y")) > bottom || !inside(x)) text.remove();
      else text.setAttribute("x", x);
    }
    for (const point of svg.querySelectorAll("circle")) {
      const x = moved(point.getAttribute("cx"));
      if (inside(x)) point.setAttribute("cx", x); else point.remove();
    }
    svg.querySelectorAll("line.grid").forEach((line) => { if (line.getAttribute("x1") === line.getAttribute("x2")) line.remove(); });
    if (axis === "time") {
      marks(range).forEach(([value, name]) => svg.append(make("text", { x: at(value), y: bottom + 18, "text-anchor": "middle", class: "ink" }, name)));
    }
  };
  const showAll = () => {
    curves.querySelectorAll("svg[data-y]").forEach((svg) => { if (svg.whole || chosen[svg.closest("[data-axis]").dataset.axis]) show(svg); });
    document.querySelectorAll(".zoomed").forEach((mark) => mark.remove());
  };
  document.addEventListener("curveschange", showAll);

  let drag = null;
  const place = (svg, e) => {
    const box = svg.getBoundingClientRect(), [left, , right] = numbers(svg.dataset.frame);
    return Math.min(Math.max(((e.clientX - box.left) / box.width) * svg.viewBox.baseVal.width, left), right);
  };
  curves.addEventListener("pointerdown", (e) => {
    const svg = e.target.closest("svg[data-y]");
    if (!svg || e.button !== 0) return;
    e.preventDefault();
    drag = { svg, from: place(svg, e), frame: numbers(svg.dataset.frame), x: numbers(svg.dataset.x), axis: svg.closest("[data-axis]").dataset.axis };
  });
  addEventListener("pointermove", (e) => {
    if (!drag || !drag.svg.isConnected) return;
    const to = place(drag.svg, e), [, top, , bottom] = drag.frame;
    drag.svg.querySelectorAll(".zoomed").forEach((mark) => mark.remove());
    drag.svg.append(make("rect", {
      class: "zoomed", x: Math.min(drag.from, to), y: top, width: Math.abs(to - drag.from), height: bottom - top, fill: "currentColor", "fill-opacity": 0.12,
    }));
  });
  addEventListener("pointerup", (e) => {
    if (!drag) return;
    const { svg, from, frame, x, axis } = drag;
    drag = null;
    // New data may have replaced the plot meanwhile.
    const now = svg.isConnected ? svg : document.elementFromPoint(e.clientX, e.clientY)?.closest("svg[data-y]");
    if (!now) return;
    const valueAt = (px) => x[0] + ((px - frame[0]) / (frame[2] - frame[0])) * (x[1] - x[0]);
    const ends = [from, place(now, e)].sort((a, b) => a - b);
    if (ends[1] - ends[0] > 4) chosen[axis] = ends.map(valueAt);
    showAll();
  });
  curves.addEventListener("dblclick", () => { chosen.phase = chosen.time = null; showAll(); });
})();
