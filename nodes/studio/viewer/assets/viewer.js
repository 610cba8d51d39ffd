// The packing in three dimensions: turned, zoomed, cut, stepped through the recorded states.
"use strict";
(() => {
  const MAX_RATIO = 2, SMOOTH = 2, SLOW_FRAME = 42, FAST_FRAME = 24, LOWEST_RATIO = 0.45, FEW = 1000;
  const BEGIN = new THREE.Vector3(2.55, -2.15, 1.45);
  // States are in the page, or come later and replace those shown.
  const statesOfPage = () => {
    const about = JSON.parse(document.getElementById("viewer-about").textContent);
    return { about, states: about.states.map((_, n) => document.getElementById(`viewer-state-${n}`).textContent) };
  };
  const begin = (root, given) => {
    let { about, states } = given;
    const stage = root.querySelector(".stage"), poster = root.querySelector(".poster");
    const hint = root.querySelector(".hint"), legend = root.querySelector(".legend"), picked = root.querySelector(".picked");
    const part = (name) => root.querySelector(`[data-set=${name}]`);
    let renderer;
    try {
      renderer = new THREE.WebGLRenderer({ antialias: false, preserveDrawingBuffer: true });
    } catch {
      hint.hidden = false;
      hint.textContent = "This browser has no WebGL 2: a picture of the last state.";
      root.querySelector(".controls").hidden = root.querySelector(".keys").hidden = true;
      return;
    }
    let last = about.states.length - 1;
    let scale = Math.cbrt(about.states[last].volume);
    const decoded = new Map();
    const stateOf = (n) => {
      if (!decoded.has(n)) {
        decoded.set(n, grainlabData.decode(about, about.states[n], states[n], scale));
      }
      return decoded.get(n);
    };
    const now = { state: last, colour: "coordination", size: 1, chains: false, axis: "", cut: 0.5 };
    const canvas = renderer.domElement;
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", poster.alt);
    stage.insertBefore(canvas, hint);
    const scene = new THREE.Scene();
    const camera = new THREE.PerspectiveCamera(26, 1, 0.05, 30);
    camera.up.set(0, 0, 1);
    const controls = new THREE.OrbitControls(camera, canvas);
    controls.rotateSpeed = 0.8;
    const uniforms = {
      uClip: { value: new THREE.Vector4(0, 0, 0, 1) }, uBack: { value: new THREE.Color() }, uFog: { value: { x: 3, y: 5 } },
      uSize: { value: 1 }, uPicked: { value: -1 },
    };
    const marks = grainlabMarks(stage);
    const reset = () => {
      camera.position.copy(BEGIN);
      controls.target.set(0, 0, 0);
      controls.update();
      draw();
    };

    // The colours come from the page, so that the legend, the pictures and other programs agree.
    const ramp = (t) => {
      const stops = about.ramp, x = Math.min(Math.max(t, 0), 1) * (stops.length - 1), k = Math.min(Math.floor(x), stops.length - 2);
      return stops[k].map((v, c) => Math.round(v + (x - k) * (stops[k + 1][c] - v)));
    };
    const top = () => about.states[now.state].force_of_full_colour || 1;
    const colourOf = (state, g) => {
      if (state.rattler[g] && now.colour !== "force") return about.rattler;
      if (now.colour === "rattlers") return about.carrier;
      return now.colour === "force" ? ramp(state.force[g] / top())
        : about.by_coordination[Math.min(state.coordination[g], about.by_coordination.length - 1)];
    };

    let drawn = [], grains = null;
    let numbers = new Uint32Array(about.grains);
    const build = () => {
      drawn.forEach((mesh) => { scene.remove(mesh); mesh.geometry.dispose(); mesh.material.dispose(); });
      const state = stateOf(now.state), dark = grainlabPage.isDark();
      uniforms.uBack.value.set(dark ? 0x141417 : 0xfbfbfc);
      renderer.setClearColor(dark ? 0x141417 : 0xfbfbfc, 1);
      drawn = [grainlabScene.outline(state.cell, dark ? 0x7a7a86 : 0x8a8a96)];
      grains = null;
      if (now.size > 0) {
        const colours = new Uint8Array(4 * state.n);
        for (let g = 0; g < state.n; g++) colours.set(colourOf(state, g), 4 * g);
        grains = grainlabScene.spheres(state, colours, uniforms);
        drawn.push(grains);
      }
      if (now.chains) {
        const radius = about.largest_radius / scale;
        const thickness = (force) => radius * (0.03 + 0.42 * Math.min(force / top(), 1.6));
        drawn.push(grainlabScene.chains(state, (force) => ramp(force / top()), thickness, uniforms));
      }
      drawn.forEach((mesh) => scene.add(mesh));
      uniforms.uSize.value = now.size;
      showLegend(state);
      draw();
    };

    const normal = new THREE.Vector3();
    const render = () => {
      camera.updateMatrixWorld();
      const distance = camera.position.distanceTo(controls.target);
      uniforms.uFog.value = { x: distance - 0.7, y: distance + 1.4 };
      camera.near = Math.max(0.02, distance - 3);
      camera.far = distance + 4;
      camera.updateProjectionMatrix();
      const clip = uniforms.uClip.value;
      if (now.axis === "") {
        clip.set(0, 0, 0, 1);
      } else {
        // The plane is a face of the cell, moved along its normal.
        const { cell } = stateOf(now.state), k = Number(now.axis);
        const column = (c) => new THREE.Vector3(cell[c], cell[3 + c], cell[6 + c]);
        normal.crossVectors(column((k + 1) % 3), column((k + 2) % 3)).normalize();
        const at = column(k).multiplyScalar(now.cut - 0.5);
        // Grains that were nearer at the beginning are cut away.
        if (normal.dot(BEGIN) < 0) normal.negate();
        const p = at.clone().applyMatrix4(camera.matrixWorldInverse);
        const n = normal.clone().transformDirection(camera.matrixWorldInverse);
        clip.set(n.x, n.y, n.z, n.dot(p));
      }
      if (grains && now.size === 1 && about.grains > FEW) {
        const state = stateOf(now.state);
        grainlabScene.choose(grains, numbers, grainlabVisible(state.spheres, state.n, camera, clip, numbers));
      }
      renderer.render(scene, camera);
      marks(camera, controls.target, scale);
    };

    // Frames are drawn when something changes; while the picture moves slowly, with fewer pixels.
    let waiting = false, ratio = 1, before = 0, settle = 0;
    const full = () => Math.min(window.devicePixelRatio || 1, MAX_RATIO);
    // A picture at rest has several pixels to each of the window, for smooth edges.
    const still = () => Math.max(full(), SMOOTH);
    const resize = (r) => {
      renderer.setPixelRatio(r);
      renderer.setSize(stage.clientWidth, stage.clientHeight, false);
      camera.aspect = stage.clientWidth / stage.clientHeight;
      // A narrow stage shows the whole cell, too.
      camera.fov = camera.aspect > 1.05 ? 26 : (2 * 180 / Math.PI) * Math.atan(Math.tan(13 * Math.PI / 180) * 1.05 / camera.aspect);
    };
    const frame = (time) => {
      waiting = false;
      const took = time - before;
      if (took < 400) {
        if (took > SLOW_FRAME) ratio = Math.max(LOWEST_RATIO, ratio * 0.85);
        else if (took < FAST_FRAME) ratio = Math.min(1, ratio * 1.05);
      }
      before = time;
      if (Math.abs(renderer.getPixelRatio() - ratio * full()) > 0.01) resize(ratio * full());
      render();
      clearTimeout(settle);
      settle = setTimeout(() => { resize(still()); render(); }, 250);
    };
    const draw = () => {
      if (waiting) return;
      waiting = true;
      requestAnimationFrame(frame);
    };

    const unit = (value) => {
      const steps = [[1, "N"], [1e-3, "mN"], [1e-6, "µN"], [1e-9, "nN"]];
      const [size, name] = steps.find(([s]) => Math.abs(value) >= s) || steps[3];
      return (v) => `${(v / size).toPrecision(3)} ${name}`;
    };
    const css = (c) => `rgb(${c.join(",")})`;
    const bar = (title, low, high) =>
      `${title}<div class="bar" style="background:linear-gradient(90deg,${about.ramp.map(css).join(",")})"></div>` +
      `<div class="ends"><span>${low}</span><span>${high}</span></div>`;
    const swatch = (c, text) => `<span><i style="background:${css(c)}"></i>${text}</span>`;
    const showLegend = (state) => {
      const shown = unit(top()), most = Math.max(...state.coordination), rows = [];
      if (now.size > 0 && now.colour === "coordination") {
        const end = about.by_coordination.length - 1;
        const entry = (k) => swatch(about.by_coordination[k], k === end && most > end ? `≥ ${k}` : k);
        const from = Math.min(...state.coordination.filter((_, g) => !state.rattler[g]));
        const range = [];
        for (let k = Math.min(from, end); k <= Math.min(most, end); k++) range.push(k);
        rows.push(`Contacts per grain (those with rattlers not counted)<div class="swatches">${range.map(entry).join("")}${swatch(about.rattler, "rattler")}</div>`);
      } else if (now.size > 0 && now.colour === "rattlers") {
        rows.push(`<div class="swatches">${swatch(about.carrier, "carries force")}${swatch(about.rattler, "rattler")}</div>`);
      } else if (now.size > 0) {
        rows.push(bar("Mean normal force of the contacts of a grain", "0", `≥ ${shown(top())}`));
      }
      if (now.chains && !(now.size > 0 && now.colour === "force")) rows.push(bar("Normal force of a contact", "0", `≥ ${shown(top())}`));
      legend.innerHTML = rows.map((row) => `<div>${row}</div>`).join("");
      legend.hidden = false;
      root.querySelector(".states output").textContent = about.states[now.state].label;
    };

    const pick = (x, y) => {
      const box = canvas.getBoundingClientRect(), state = stateOf(now.state);
      const ray = new THREE.Vector3((2 * (x - box.left)) / box.width - 1, 1 - (2 * (y - box.top)) / box.height, 0.5);
      ray.unproject(camera).sub(camera.position).normalize();
      const o = camera.position, clip = uniforms.uClip.value, p = new THREE.Vector3();
      let found = -1, nearest = Infinity;
      for (let g = 0; g < state.n && now.size > 0; g++) {
        const [cx, cy, cz] = [state.spheres[4 * g] - o.x, state.spheres[4 * g + 1] - o.y, state.spheres[4 * g + 2] - o.z];
        const b = cx * ray.x + cy * ray.y + cz * ray.z, r = state.spheres[4 * g + 3] * now.size;
        const under = b * b - (cx * cx + cy * cy + cz * cz) + r * r;
        if (under < 0) continue;
        const root = Math.sqrt(under);
        let t = b - root;
        p.copy(ray).multiplyScalar(t).add(o).applyMatrix4(camera.matrixWorldInverse);
        if (clip.x * p.x + clip.y * p.y + clip.z * p.z > clip.w) {
          const d = ray.clone().transformDirection(camera.matrixWorldInverse);
          t = clip.w / (clip.x * d.x + clip.y * d.y + clip.z * d.z);
          if (t < b - root || t > b + root) continue;
        }
        if (t < nearest) [nearest, found] = [t, g];
      }
      uniforms.uPicked.value = found;
      if (found < 0) {
        picked.textContent = "";
      } else {
        const [px, py, pz] = [0, 1, 2].map((k) => state.spheres[4 * found + k] * scale * 1e3);
        picked.textContent = [
          `Grain ${state.ids ? state.ids[found] : found + about.first_id}`,
          `${state.touching[found]} contacts${state.rattler[found] ? ", a rattler" : `, ${state.coordination[found]} without rattlers`}`,
          `mean normal force ${unit(state.force[found])(state.force[found])}`,
          `radius ${(state.spheres[4 * found + 3] * scale * 1e3).toPrecision(4)} mm`,
          `at (${px.toFixed(3)}, ${py.toFixed(3)}, ${pz.toFixed(3)}) mm from the centre`,
        ].join("\n");
      }
      draw();
    };

    const step = (to) => {
      now.state = Math.min(Math.max(to, 0), last);
      part("state").value = now.state;
      uniforms.uPicked.value = -1;
      picked.textContent = "";
      build();
    };
    const turn = (across, up) => {
      const offset = camera.position.clone().sub(controls.target);
      const r = offset.length(), polar = Math.min(Math.max(Math.acos(offset.z / r) - up, 0.01), Math.PI - 0.01);
      const around = Math.atan2(offset.y, offset.x) - across;
      camera.position.set(r * Math.sin(polar) * Math.cos(around), r * Math.sin(polar) * Math.sin(around), r * Math.cos(polar)).add(controls.target);
      controls.update();
      draw();
    };
    const move = (across, up) => {
      const by = new THREE.Vector3(across, up, 0).applyQuaternion(camera.quaternion);
      camera.position.add(by);
      controls.target.add(by);
      controls.update();
      draw();
    };
    const zoom = (factor) => {
      camera.position.sub(controls.target).multiplyScalar(factor).add(controls.target);
      controls.update();
      draw();
    };
    const save = () => {
      resize(still());
      render();
      // The title above, the frame with its marks, and the legend below, drawn at the size that they have in the page.
      const by = canvas.width / stage.clientWidth, [wide, high] = [stage.clientWidth, stage.clientHeight], line = 18, across = Math.max(wide, 600);
      const style = getComputedStyle(root), ink = style.getPropertyValue("--ink");
      const rows = [...legend.children], whole = document.createElement("canvas"), pen = whole.getContext("2d");
      [whole.width, whole.height] = [across * by, (high + 40 + rows.length * 2.4 * line) * by];
      pen.scale(by, by);
      pen.fillStyle = style.getPropertyValue("--stage");
      pen.fillRect(0, 0, across, whole.height / by);
      pen.drawImage(canvas, 0, 30, wide, high);
      pen.fillStyle = pen.strokeStyle = ink;
      const write = (text, x, y, size = 13) => { pen.font = `${size}px system-ui, sans-serif`; pen.fillText(text, x, y); return pen.measureText(text).width; };
      write(about.states[now.state].label, 14, 21, 14);
      for (const mark of stage.querySelectorAll(".marks > *")) {
        pen.textAlign = "center";
        pen.lineWidth = parseFloat(getComputedStyle(mark).strokeWidth);
        if (mark.tagName === "text") write(mark.textContent, Number(mark.getAttribute("x")), 30 + Number(mark.getAttribute("y")));
        else pen.stroke(new Path2D(mark.getAttribute("d").replace(/^M (\S+) (\S+)/, (_, x, y) => `M ${x} ${30 + Number(y)}`)));
      }
      pen.textAlign = "left";
      rows.forEach((row, n) => {
        const y = high + 30 + line + n * 2.4 * line, bar = row.querySelector(".bar");
        if (row.firstChild.nodeType === Node.TEXT_NODE) write(row.firstChild.textContent, 14, y);
        let x = 14;
        if (bar) {
          const ramp = pen.createLinearGradient(120, 0, 340, 0);
          about.ramp.forEach((c, k) => ramp.addColorStop(k / (about.ramp.length - 1), css(c)));
          const [low, most] = [...row.querySelectorAll(".ends span")].map((e) => e.textContent);
          write(low, 104, y + line + 4);
          write(most, 348, y + line + 4);
          pen.fillStyle = ramp;
          pen.fillRect(120, y + line - 6, 220, 10);
          pen.fillStyle = ink;
        }
        row.querySelectorAll(".swatches > span").forEach((entry) => {
          pen.fillStyle = entry.querySelector("i").style.backgroundColor;
          pen.fillRect(x, y + line - 6, 11, 11);
          pen.fillStyle = ink;
          x += 16 + write(entry.textContent, x + 16, y + line + 4) + 14;
        });
      });
      whole.toBlob((blob) => grainlabPage.save(`${about.name}.png`, "image/png", blob));
    };

    controls.addEventListener("change", draw);
    part("colour").addEventListener("change", (e) => { now.colour = e.target.value; build(); });
    part("size").addEventListener("change", (e) => { now.size = Number(e.target.value); build(); });
    part("chains").addEventListener("change", (e) => {
      now.chains = e.target.checked;
      // Full grains would hide the chains.
      if (now.chains && now.size === 1) { now.size = 0.3; part("size").value = "0.3"; }
      build();
    });
    part("axis").addEventListener("change", (e) => { now.axis = e.target.value; root.querySelector(".cut").hidden = now.axis === ""; draw(); });
    part("cut").addEventListener("input", (e) => { now.cut = Number(e.target.value); draw(); });
    part("state").addEventListener("input", (e) => step(Number(e.target.value)));
    root.querySelector("[data-do=reset]").addEventListener("click", reset);
    root.querySelector("[data-do=save]").addEventListener("click", save);
    canvas.addEventListener("keydown", (e) => {
      const pan = e.shiftKey, keys = {
        ArrowLeft: () => (pan ? move(0.05, 0) : turn(-0.1, 0)), ArrowRight: () => (pan ? move(-0.05, 0) : turn(0.1, 0)),
        ArrowUp: () => (pan ? move(0, -0.05) : turn(0, 0.1)), ArrowDown: () => (pan ? move(0, 0.05) : turn(0, -0.1)),
        "+": () => zoom(0.9), "=": () => zoom(0.9), "-": () => zoom(1.1), "[": () => step(now.state - 1), "]": () => step(now.state + 1),
        r: reset, R: reset,
      };
      if (keys[e.key] && !e.ctrlKey && !e.metaKey) { keys[e.key](); e.preventDefault(); }
    });
    let pressed = null;
    canvas.addEventListener("pointerdown", (e) => { pressed = [e.clientX, e.clientY]; });
    canvas.addEventListener("pointerup", (e) => {
      if (pressed && Math.hypot(e.clientX - pressed[0], e.clientY - pressed[1]) < 4) pick(e.clientX, e.clientY);
    });
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", build);
    document.addEventListener("themechange", build);
    new ResizeObserver(() => { resize(full()); draw(); }).observe(stage);

    const showRange = () => {
      hint.hidden = !about.part;
      hint.textContent = about.part ?? "";
      root.querySelector(".states").hidden = last === 0;
      part("state").max = last;
      part("state").value = now.state;
    };
    // Other states in place of these. Who looks at the last one sees the new last one.
    const replace = (next) => {
      const atEnd = now.state === last;
      ({ about, states } = next);
      last = about.states.length - 1;
      scale = Math.cbrt(about.states[last].volume);
      now.state = atEnd ? last : Math.min(now.state, last);
      numbers = new Uint32Array(about.grains);
      decoded.clear();
      uniforms.uPicked.value = -1;
      picked.textContent = "";
      showRange();
      build();
    };
    showRange();
    poster.hidden = true;
    resize(full());
    reset();
    build();
    root.view = { turn, render, now, build, replace, ratio: () => ratio };
  };

  // WebGL starts when the figure is near the window: a long page opens at once.
  const observer = new IntersectionObserver((entries) => entries.filter((e) => e.isIntersecting).forEach((e) => {
    observer.unobserve(e.target);
    begin(e.target, statesOfPage());
  }), { rootMargin: "200px" });
  if (document.getElementById("viewer-about")) document.querySelectorAll("[data-viewer]").forEach((root) => observer.observe(root));
  window.grainlabViewer = { show: (root, given) => (root.view ? root.view.replace(given) : begin(root, given)) };
})();
