// Reads the data of the page (written by view_data.py): one compressed text with all arrays.
"use strict";

async function bytesOf(text) {
  if (typeof DecompressionStream === "undefined") throw new Error("this browser cannot inflate data: one of 2023 or later is expected");
  const packed = Uint8Array.from(atob(text), c => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

const undone = v => (v >>> 1) ^ -(v & 1);  // of small numbers with a sign stored without one

// The array as one typed array [rows * components] for each instant.
function arrayOf(spec, bytes) {
  const [instants, rows, parts] = spec.shape, Kind = {1: Uint8Array, 2: Uint16Array, 4: Uint32Array}[spec.width], found = [];
  let at = spec.at;
  for (let t = 0; t < instants; t++) {
    const array = new Kind(rows * parts), before = found[t - 1];
    for (let c = 0; c < parts; c++)
      for (let k = 0; k < spec.width; k++)
        for (let n = c, shift = 8 * k; n < array.length; n += parts) array[n] |= bytes[at++] << shift;
    if (spec.delta === "time" && t) for (let n = 0; n < array.length; n++) array[n] = before[n] + undone(array[n]);
    if (spec.delta === "row") for (let n = parts; n < array.length; n++) array[n] = array[n - parts] + undone(array[n]);
    found.push(array);
  }
  return found;
}
