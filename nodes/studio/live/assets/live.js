// Follows the events of the server: parts of the page as they change, and packings as they are published.
"use strict";
(() => {
  const by = (id) => document.getElementById(id), viewer = document.querySelector("[data-viewer]"), lost = by("lost");
  // A page that pauses keeps what arrives, and shows it when it goes on.
  const pause = by("pause");
  let held = null;
  const take = (parts) => {
    if (held) return Object.assign(held, parts);
    for (const [id, markup] of Object.entries(parts)) {
      if (id === "stage") document.body.dataset.stage = markup;
      else by(id).innerHTML = markup;
    }
    if (parts.curves !== undefined) document.dispatchEvent(new Event("curveschange"));
    const title = by("heading").querySelector("h1");
    if (title) document.title = `${title.textContent} · grainlab`;
  };
  // One request at a time; what was published meanwhile is fetched after it.
  let wanted = 0, shown = 0, busy = false;
  const fetchPackings = async () => {
    if (busy || held || wanted === shown) return;
    busy = true;
    const version = wanted;
    try {
      const answer = await fetch("packings");
      const given = answer.ok ? await answer.json() : null;
      viewer.classList.toggle("shown", given !== null);
      by("no-packing").hidden = given !== null;
      if (given) window.grainlabViewer.show(viewer, given);
      shown = version;
    } finally {
      busy = false;
    }
    fetchPackings();
  };
  pause.addEventListener("click", () => {
    const kept = held;
    held = held ? null : {};
    pause.setAttribute("aria-pressed", held !== null);
    pause.textContent = held ? "Go on" : "Pause";
    by("paused").textContent = held ? `Paused at ${new Date().toLocaleTimeString()}. The run goes on, and its data are kept.` : "";
    if (kept) { take(kept); fetchPackings(); }
  });
  const connect = () => {
    const source = new EventSource("events");
    source.addEventListener("open", () => { lost.hidden = true; });
    source.addEventListener("parts", (e) => take(JSON.parse(e.data)));
    source.addEventListener("packings", (e) => { wanted = Number(e.data); fetchPackings(); });
    source.addEventListener("error", () => {
      lost.hidden = false;
      // Everything is sent anew when the server is back.
      document.querySelectorAll("#heading .verdict.run").forEach((e) => { e.className = "verdict"; e.textContent = "It was running"; });
      document.querySelectorAll("#nodes .here").forEach((e) => { e.className = "gone"; e.textContent = "not known"; });
      // A browser gives up after some failures.
      if (source.readyState === EventSource.CLOSED) setTimeout(connect, 2000);
    });
  };
  connect();
})();
