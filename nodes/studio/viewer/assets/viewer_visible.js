// The grains that can be seen: of a dense packing few, so that software renderers are fast enough.
//
// Spheres that do not overlap hide one another in the order of their centres. A coarse map of distances holds, for each of
// its cells, the nearest sphere that covers all of it. A grain is drawn unless every cell that it touches is covered by a
// nearer one, so that no grain is missing.
"use strict";
const grainlabVisible = (() => {
  const RADIUS = 4, LARGEST = 700, MARGIN = 0.3;
  let map = new Float32Array(0), view = new Float32Array(0);

  // Numbers of the grains to draw, in `out`; returns how many. `clip` is a plane in the frame of the camera.
  return (spheres, n, camera, clip, out) => {
    const e = camera.matrixWorldInverse.elements, tan = Math.tan((camera.fov * Math.PI) / 360);
    if (view.length < 3 * n) view = new Float32Array(3 * n);
    const distance = -e[14];
    let mean = 0;
    for (let g = 0; g < n; g++) {
      const [x, y, z] = [spheres[4 * g], spheres[4 * g + 1], spheres[4 * g + 2]];
      view[3 * g] = e[0] * x + e[4] * y + e[8] * z + e[12];
      view[3 * g + 1] = e[1] * x + e[5] * y + e[9] * z + e[13];
      view[3 * g + 2] = -(e[2] * x + e[6] * y + e[10] * z + e[14]);
      mean += spheres[4 * g + 3] / n;
    }
    // Cells so small that a grain is about RADIUS cells wide on either side.
    const scale = Math.min((RADIUS * Math.max(distance, 0.2)) / mean, LARGEST / (2 * tan));
    const half = Math.ceil(scale * tan), rows = 2 * half, columns = Math.ceil(2 * half * camera.aspect), middle = columns / 2;
    if (map.length < rows * columns) map = new Float32Array(rows * columns);
    map.fill(Infinity);
    // True if `limit` leaves some cell of a grain open; with `limit` < 0 the grain covers its cells instead.
    const cells = (g, factor, grow, limit) => {
      const depth = view[3 * g + 2];
      if (depth < 1e-3) return true;
      const r = ((spheres[4 * g + 3] * factor) / depth) * scale + grow;
      if (r <= 0) return false;
      const x = (view[3 * g] / depth) * scale + middle - 0.5, y = (view[3 * g + 1] / depth) * scale + half - 0.5;
      const last = Math.min(rows - 1, Math.floor(y + r));
      for (let row = Math.max(0, Math.ceil(y - r)); row <= last; row++) {
        const dy = row - y, wide = Math.sqrt(Math.max(r * r - dy * dy, 0));
        const end = row * columns + Math.min(columns - 1, Math.floor(x + wide));
        for (let at = row * columns + Math.max(0, Math.ceil(x - wide)); at <= end; at++) {
          if (limit < 0) {
            if (depth < map[at]) map[at] = depth;
          } else if (map[at] > limit) {
            return true;
          }
        }
      }
      return false;
    };
    let count = 0;
    for (let pass = 0; pass < 2; pass++) {
      for (let g = 0; g < n; g++) {
        const r = spheres[4 * g + 3], depth = view[3 * g + 2];
        const over = clip.x * view[3 * g] + clip.y * view[3 * g + 1] - clip.z * depth - clip.w;
        // A grain cut by the plane hides less than a whole one, and is drawn.
        if (pass === 0 && over <= -r) cells(g, 1, -0.75, -1);
        if (pass === 1 && over <= r && (over > -r || cells(g, 1.04, 0.75, Math.max(depth - MARGIN * r, 0)))) out[count++] = g;
      }
    }
    return count;
  };
})();
