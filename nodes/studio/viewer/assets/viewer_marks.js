// Length and directions in the picture of a packing, over its canvas.
"use strict";
const grainlabMarks = (stage) => {
  const make = (name, parent) => parent.appendChild(document.createElementNS("http://www.w3.org/2000/svg", name));
  const svg = make("svg", stage), bar = make("path", svg), length = make("text", svg);
  svg.setAttribute("class", "marks");
  svg.setAttribute("aria-hidden", "true");
  const axes = ["x", "y", "z"].map((name) => ({ line: make("path", svg), text: Object.assign(make("text", svg), { textContent: name }) }));
  const UNITS = [[1e3, "km"], [1, "m"], [1e-3, "mm"], [1e-6, "µm"], [1e-9, "nm"]];
  const put = (text, x, y) => { text.setAttribute("x", x); text.setAttribute("y", y); };
  // `scale` is the length of a unit of the scene, m. The bar is as long as that length in the plane of the centre.
  return (camera, target, scale) => {
    const [w, h] = [stage.clientWidth, stage.clientHeight];
    const pixels = h / (2 * camera.position.distanceTo(target) * Math.tan((camera.fov * Math.PI) / 360)) / scale;
    const most = (0.18 * w) / pixels, [unit, name] = UNITS.find(([u]) => most >= u) ?? UNITS[4];
    const count = [500, 200, 100, 50, 20, 10, 5, 2].find((n) => n * unit <= most) ?? 1, long = count * unit * pixels;
    const [right, bottom] = [w - 16, h - 16];
    bar.setAttribute("d", `M ${right - long} ${bottom} H ${right}`);
    put(length, right - long / 2, bottom - 8);
    length.textContent = `${count} ${name}`;
    axes.forEach(({ line, text }, k) => {
      const to = new THREE.Vector3().setComponent(k, 1).transformDirection(camera.matrixWorldInverse);
      const [x, y] = [right - 38, bottom - 74];
      line.setAttribute("d", `M ${x} ${y} l ${30 * to.x} ${-30 * to.y}`);
      put(text, x + 39 * to.x, y - 39 * to.y + 4);
    });
  };
};
