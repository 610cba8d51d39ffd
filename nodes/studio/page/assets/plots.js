// Plots: values under the pointer, and a part of the horizontal axis.
"use strict";
(() => {
  const make = (tag, attributes, parent) => {
    const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    return parent.appendChild(element);
  };
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
    const marks = [...series.querySelectorAll("circle,polygon")].filter((e) => e.style.display !== "none").map((e) => {
      const moved = e.transform.baseVal.consolidate()?.matrix, [x, y] = middleOf(e);
      return [x + (moved?.e ?? 0), y + (moved?.f ?? 0)];
    });
    const line = series.querySelector("path:not([stroke-opacity]):not([d*=H])");
    return { marks, corners: line ? [...line.getAttribute("d").matchAll(/[ML] ([-\d.]+) ([-\d.]+)/g)].map((c) => [Number(c[1]), Number(c[2])]) : [] };
  };

  const readout = document.createElement("div");
  readout.className = "readout";
  readout.setAttribute("aria-hidden", "true");
  readout.hidden = true;
  document.body.append(readout);
  const rowsAt = (svg, x) => {
    const [left, top, right, bottom] = frame(svg), across = axis(svg.dataset.shown ?? svg.dataset.x), up = axis(svg.dataset.up ?? svg.dataset.y);
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
  let pointer = null, drag = null;
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

  // Marks of the part that is shown: multiples of 1, 2 or 5, or powers of ten.
  const marks = ({ low, high, log }) => {
    if (log && high / low > 20) return Array.from({ length: 40 }, (_, n) => 10 ** (Math.floor(Math.log10(low)) + n)).filter((v) => v >= low && v <= high).map((v) => [v, `${v < 1e-3 || v > 1e4 ? v.toExponential(0) : v}`]);
    const wanted = (high - low) / 5, decade = 10 ** Math.floor(Math.log10(wanted));
    const step = decade * [1, 2, 5, 10].find((m) => m * decade >= wanted), digits = Math.max(0, -Math.floor(Math.log10(step)));
    return Array.from({ length: Math.floor(high / step) - Math.ceil(low / step) + 1 }, (_, n) => (Math.ceil(low / step) + n) * step).map((v) => [v, v.toFixed(digits)]);
  };
  let clips = 0;
  const show = (svg, range) => {
    const whole = (svg.whole ??= svg.innerHTML), all = axis(svg.dataset.x), [left, top, right, bottom] = frame(svg), width = right - left;
    svg.innerHTML = whole;
    if (!range) {
      delete svg.dataset.shown;
      delete svg.dataset.up;
      return;
    }
    svg.dataset.shown = `${range[0]} ${range[1]} ${all.log ? "log" : "linear"}`;
    const part = axis(svg.dataset.shown), to = (x) => left + width * part.share(all.at((x - left) / width)), cut = (x) => Math.min(right, Math.max(left, x));
    // The vertical axis is that of the corners and points that are seen.
    const seen = [...svg.querySelectorAll(".series path, .series circle")].flatMap((e) => (e.tagName === "circle" ? [[e.getAttribute("cx"), e.getAttribute("cy")]] : [...e.getAttribute("d").matchAll(/[ML] ([-\d.]+) ([-\d.]+)/g)].map((c) => [c[1], c[2]])));
    const heights = seen.filter(([x]) => to(Number(x)) >= left && to(Number(x)) <= right).map((p) => Number(p[1])), room = 0.06 * (bottom - top);
    const [high, low] = heights.length ? [Math.min(...heights) - room / 2, Math.max(...heights) + room / 2] : [top, bottom], tall = Math.max(low - high, 1);
    const up = (y) => top + ((y - high) / tall) * (bottom - top), whole_up = axis(svg.dataset.y), value = (y) => whole_up.at((bottom - y) / (bottom - top));
    svg.dataset.up = `${value(high + tall)} ${value(high)} ${whole_up.log ? "log" : "linear"}`;
    // A name stands at the height at which its line leaves the part.
    const ends = [...svg.querySelectorAll(".ends text")].map((text) => {
      const series = [...svg.querySelectorAll(".series")].find((one) => one.dataset.name === text.textContent), { marks, corners } = placesOf(series);
      const all = (corners.length ? corners : marks).map(([x, y]) => [to(x), up(y)]), after = all.findIndex((p) => p[0] > right), [b, a] = [all[after] ?? all.at(-1), all[after - 1]];
      const y = after > 0 && corners.length ? a[1] + ((b[1] - a[1]) * (right - a[0])) / (b[0] - a[0]) : (after > 0 ? a : b ?? [0, bottom])[1];
      return { text, y: Math.min(bottom, Math.max(top, y)) };
    }).sort((a, b) => a.y - b.y);
    ends.forEach((end, n) => (end.y = Math.max(end.y, n ? ends[n - 1].y + 13 : top)));
    ends.reverse().forEach((end, n) => (end.y = Math.min(end.y, n ? ends[n - 1].y - 13 : bottom)));
    ends.forEach((end) => end.text.setAttribute("y", end.y + 4));
    const clip = make("clipPath", { id: `part-${++clips}` }, svg);
    make("rect", { x: left, y: top, width, height: bottom - top }, clip);
    for (const element of svg.querySelectorAll(".series > *, .curves > text, .bands > *")) {
      const d = element.tagName === "path" && element.getAttribute("d"), box = element.getBBox();
      if (d && !/[HV]/.test(d)) {
        element.setAttribute("d", d.replace(/([ML]) ([-\d.]+) ([-\d.]+)/g, (_, letter, x, y) => `${letter} ${to(Number(x)).toFixed(1)} ${up(Number(y)).toFixed(1)}`));
        element.setAttribute("clip-path", `url(#${clip.id})`);
      } else if (d) {
        // An error bar: its caps keep their width.
        const [l, , r, x, low, high] = [...d.matchAll(/[-\d.]+/g)].map(Number), at = to(x), [from, end] = [up(low), up(high)], half = (r - l) / 2;
        element.setAttribute("d", `M ${at - half} ${from} H ${at + half} M ${at} ${from} V ${end} M ${at - half} ${end} H ${at + half}`);
        element.setAttribute("clip-path", `url(#${clip.id})`);
      } else if (element.tagName === "rect") {
        const [from, end] = [cut(to(box.x)), cut(to(box.x + box.width))];
        element.setAttribute("x", from);
        element.setAttribute("width", end - from);
      } else {
        const middle = middleOf(element), x = to(middle[0]), y = element.closest(".bands") ? middle[1] : up(middle[1]);
        element.setAttribute("transform", `translate(${x - middle[0]} ${y - middle[1]})`);
        if (x < left || x > right) element.style.display = "none";
      }
    }
    const redraw = (name, of, line, text) => {
      const group = svg.querySelector(name);
      if (!group?.childNodes.length) return;
      group.replaceChildren();
      for (const [v, words] of marks(of)) {
        make("line", { ...line(of.share(v)), class: "grid" }, group);
        make("text", { ...text(of.share(v), words), class: "ink" }, group).textContent = words.replace("-", "−");
      }
    };
    redraw(".marks", part, (s) => ({ x1: left + width * s, x2: left + width * s, y1: top, y2: bottom }), (s, words) => ({ x: Math.min(left + width * s, svg.viewBox.baseVal.width - 3.8 * words.length), y: bottom + 16, "text-anchor": "middle" }));
    redraw(".marks-up", axis(svg.dataset.up), (s) => ({ x1: left, x2: right, y1: bottom - (bottom - top) * s, y2: bottom - (bottom - top) * s }), (s) => ({ x: left - 8, y: bottom - (bottom - top) * s + 4, "text-anchor": "end" }));
  };
  // Plots over a common axis show the same part.
  const shown = new Map(), key = (svg) => svg.closest("#curves") && svg.closest("[data-axis]")?.dataset.axis;
  const choose = (svg, range) => {
    if (key(svg)) shown.set(key(svg), range);
    const all = key(svg) ? document.querySelectorAll(`#curves [data-axis=${key(svg)}] svg[data-frame]`) : [svg];
    all.forEach((one) => show(one, range));
  };
  // A page that follows a run may have drawn the plot anew.
  const still = () => {
    if (!drag.svg.isConnected) drag = under() ? { svg: under(), from: drag.from, ends: drag.ends } : null;
    return drag;
  };
  document.addEventListener("pointerdown", (e) => {
    const svg = e.pointerType === "mouse" && e.button === 0 && e.target.closest?.("svg[data-frame]");
    if (svg) drag = { svg, from: place(svg, e.clientX) };
  });
  document.addEventListener("pointermove", (e) => {
    pointer = [e.clientX, e.clientY];
    showValues();
    if (!drag || !still()) return;
    const [left, top, right, bottom] = frame(drag.svg), x = Math.min(right, Math.max(left, place(drag.svg, e.clientX)));
    drag.mark ??= make("rect", { y: top, height: bottom - top, class: "chosen" }, drag.svg);
    drag.ends = [Math.max(left, Math.min(x, drag.from)), Math.max(x, drag.from)];
    drag.mark.setAttribute("x", drag.ends[0]);
    drag.mark.setAttribute("width", drag.ends[1] - drag.ends[0]);
  });
  document.addEventListener("pointerup", () => {
    if (!drag || !still()) return;
    const { svg, mark, ends } = drag;
    drag = null;
    mark?.remove();
    if (!ends || ends[1] - ends[0] < 6) return;
    const [left, , right] = frame(svg), across = axis(svg.dataset.shown ?? svg.dataset.x);
    choose(svg, ends.map((x) => across.at((x - left) / (right - left))));
  });
  document.addEventListener("dblclick", (e) => {
    const svg = e.target.closest?.("svg[data-frame]");
    if (svg) choose(svg, null);
  });
  document.documentElement.addEventListener("pointerleave", () => { pointer = null; showValues(); });
  addEventListener("scroll", showValues, { passive: true });
  document.addEventListener("curveschange", () => {
    document.querySelectorAll("#curves svg[data-frame]").forEach((svg) => { if (shown.get(key(svg))) show(svg, shown.get(key(svg))); });
    showValues();
  });
})();
