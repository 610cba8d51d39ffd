// Decodes recorded states: bytes as base64 in the page, laid out as src/encode.rs writes them.
"use strict";
const grainlabData = (() => {
  const bytesOf = (text) => {
    const raw = atob(text.trim());
    const bytes = new Uint8Array(raw.length);
    for (let n = 0; n < raw.length; n++) bytes[n] = raw.charCodeAt(n);
    return bytes;
  };

  // Reads arrays one after the other from little-endian bytes; each begins at a multiple of its size.
  const reader = (bytes) => {
    let at = 0;
    return (Type, count) => {
      at = Math.ceil(at / Type.BYTES_PER_ELEMENT) * Type.BYTES_PER_ELEMENT;
      const array = new Type(bytes.buffer, at, count);
      at += count * Type.BYTES_PER_ELEMENT;
      return array;
    };
  };

  const times = (m, v) => [0, 1, 2].map((r) => m[3 * r] * v[0] + m[3 * r + 1] * v[1] + m[3 * r + 2] * v[2]);

  // One state. Positions and radii are in units of `scale`, m, about the centre of the cell.
  const decode = (about, state, text, scale) => {
    const read = reader(bytesOf(text));
    const n = about.grains, m = state.contacts;
    const placed = read(Uint16Array, 3 * n), sizes = read(Uint16Array, n), forces = read(Uint16Array, m);
    const second = about.wide ? read(Uint32Array, m) : read(Uint16Array, m);
    const ids = about.ids ? read(Uint32Array, n) : null;
    const flags = read(Uint8Array, n), counts = read(Uint8Array, n), images = read(Uint8Array, m);
    const cell = state.cell.map((v) => v / scale);
    const spheres = new Float32Array(4 * n), coordination = new Uint8Array(n), rattler = new Uint8Array(n);
    for (let g = 0; g < n; g++) {
      const f = [0, 1, 2].map((k) => placed[3 * g + k] / 65536 - 0.5);
      spheres.set(times(cell, f), 4 * g);
      spheres[4 * g + 3] = (sizes[g] / 65535) * (about.largest_radius / scale);
      coordination[g] = flags[g] & 127;
      rattler[g] = flags[g] >> 7;
    }
    // Ends, strength and grain of every piece of a force chain. A contact across a face of the cell is two halves.
    const pieces = [], sum = new Float32Array(n), touching = new Uint16Array(n);
    for (let g = 0, c = 0; g < n; g++) {
      for (let k = 0; k < counts[g]; k++, c++) {
        const j = second[c], code = images[c];
        const image = [Math.floor(code / 25) - 2, (Math.floor(code / 5) % 5) - 2, (code % 5) - 2];
        const shift = times(cell, image), force = (forces[c] / 65535) * state.largest_force;
        sum[g] += force; sum[j] += force; touching[g]++; touching[j]++;
        const a = spheres.subarray(4 * g, 4 * g + 3), b = spheres.subarray(4 * j, 4 * j + 3);
        const across = image.some((v) => v !== 0);
        const l = [0, 1, 2].map((x) => b[x] + shift[x] - a[x]);
        const end = (from, sign, part) => [0, 1, 2].map((x) => from[x] + sign * part * l[x]);
        if (across) {
          pieces.push([...a, ...end(a, 1, 0.5), force]);
          pieces.push([...b, ...end(b, -1, 0.5), force]);
        } else {
          pieces.push([...a, ...end(a, 1, 1), force]);
        }
      }
    }
    const force = sum.map((s, g) => (touching[g] ? s / touching[g] : 0));
    return { n, spheres, coordination, rattler, force, ids, pieces, cell, touching };
  };

  return { decode };
})();
