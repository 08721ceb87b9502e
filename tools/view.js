// The page of `gneiss view`: what is shown is `state`, which controls and the address (#time=0.5&field=damage) set.
"use strict";

const element = id => document.getElementById(id);
const meta = JSON.parse(element("meta").textContent);
const flat = meta.dimension === 2, times = meta.times, last = times.length - 1;
const state = {time: 1, field: meta.fields.length ? meta.fields[0].name : "", low: "", high: "", particles: true, size: 1, opacity: 1, bonds: false, cracks: "cause",
  elements: true, edges: true, bodies: true, walls: true, magnify: 1, play: false, turn: false, yaw: flat ? 0 : 25, pitch: flat ? 0 : meta.bed ? 40 : 14, zoom: 1,
  cutx: 1, cuty: 1, cutz: 1, flipx: false, flipy: false, flipz: false, panx: 0, pany: 0};
let data, painter, tables, dirty = true;

// --- colours ------------------------------------------------------------------------------------------------

const STOPS = {
  plain: ["440154", "482878", "3e4a89", "31688e", "26828e", "1f9e89", "35b779", "6ece58", "b5de2b", "fde725"],
  signed: ["2b4c9b", "4a7bb7", "81b0d2", "bcd8e6", "eeeeea", "f7cda6", "eb9a68", "cf5b43", "9e1c2c"],
  damage: ["d8d3c8", "e8c07d", "dd7d3c", "b3261e", "4a0d12"],
  whole: ["4e79a7", "f28e2b", "59a14f", "e15759", "b07aa1", "76b7b2", "edc948", "9c755f", "ff9da7", "bab0ac"]};
const rgb = text => [0, 2, 4].map(k => parseInt(text.slice(k, k + 2), 16));
function mixed(stops, share) {
  const x = share * (stops.length - 1), k = Math.min(stops.length - 2, Math.floor(x)), [a, b] = [rgb(stops[k]), rgb(stops[k + 1])];
  return a.map((v, c) => v + (x - k) * (b[c] - v));
}
const colourAt = (kind, k) => kind === "whole" ? rgb(STOPS.whole[k % 10]) : mixed(STOPS[kind], k / 255);

const PREFIX = [[1e9, "G"], [1e6, "M"], [1e3, "k"], [1, ""], [1e-3, "m"], [1e-6, "µ"], [1e-9, "n"]];
function quantity(value, unit) {
  const [factor, prefix] = ["s", "m", "Pa", "N", "J"].includes(unit) && value ? PREFIX.find(([f]) => Math.abs(value) >= f) || PREFIX[6] : [1, ""];
  return `${+(value / factor).toPrecision(4)} ${prefix}${unit === "1" ? "" : unit}`.trim();
}

// --- data ---------------------------------------------------------------------------------------------------

function tablesOf(gl) {
  const table = (components, bytes) => new Table(gl, components, bytes);
  const parts = {};
  for (const name of [...(meta.particles.count ? ["particles"] : []), ...meta.surfaces.map(s => s.name)])
    parts[name] = {posA: table(4, 2), posB: table(4, 2), pos0: table(4, 2), fieldA: table(1, 1), fieldB: table(1, 1)};
  if (meta.bonds.count) {
    const {count, broken} = meta.bonds, rows = new Uint32Array(4 * count);
    const first = data.bond_first[0], reach = data.bond_reach[0], cause = data.bond_cause[0], when = data.bond_time[0];
    for (let k = 0; k < count; k++) rows.set([first[k], first[k] + reach[k], k >= count - broken ? when[k - count + broken] : 0, cause[k]], 4 * k);
    parts.bonds = {fieldA: table(1, 1), fieldB: table(1, 1)};
    parts.ends = table(4, 4);
    parts.ends.set(rows);
    parts.when = new Float32Array(when.buffer);  // the latest first
  }
  for (const surface of meta.surfaces) {
    surface.facets = [];
    surface.edges = [];
    for (let k = 0; k < surface.sets; k++) {
      const corners = data[`${surface.name}/${k}`][0];
      surface.facets.push(painter.indices(corners));
      surface.edges.push(painter.indices((data[`${surface.name}/edges`] || [edgesOf(corners)])[0]));
    }
  }
  parts.colours = Object.fromEntries(Object.keys(STOPS).map(kind => [kind, colourTable(gl, k => colourAt(kind, k))]));
  return parts;
}

function edgesOf(corners) {
  const seen = new Set(), found = [];
  for (let k = 0; k < corners.length; k += 3)
    for (let c = 0; c < 3; c++) {
      const a = corners[k + c], b = corners[k + (c + 1) % 3], key = Math.min(a, b) * 4294967296 + Math.max(a, b);
      if (!seen.has(key)) seen.add(key), found.push(a, b);
    }
  return Uint32Array.from(found);
}

// Index of the instant before the present time, and the share of the way to the next.
function instant() {
  const t = now();
  let k = 0;
  while (k < last - 1 && times[k + 1] <= t) k++;
  const share = last ? Math.min(1, Math.max(0, (t - times[k]) / (times[k + 1] - times[k]))) : 0;
  return share > 0.999 ? [k + 1, k + 1, 0] : [k, Math.min(k + 1, last), share];
}
const now = () => times[0] + state.time * (times[last] - times[0]);

// Bonds that have broken until now: their times are in descending order.
function brokenUntil(t) {
  let low = 0, high = tables.when.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (tables.when[middle] <= t * (1 + 1e-6)) high = middle; else low = middle + 1;
  }
  return tables.when.length - low;
}

// --- the viewer ---------------------------------------------------------------------------------------------

const sub = (a, b) => a.map((v, k) => v - b[k]), dot = (a, b) => a.reduce((s, v, k) => s + v * b[k], 0);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const axis = k => [0, 1, 2].map(c => +(c === k)), middle = meta.low.map((v, k) => 0.5 * (v + meta.high[k])), extent = sub(meta.high, meta.low);
const radius = 0.5 * Math.hypot(...extent), FIELD_OF_VIEW = 16 * Math.PI / 180;

// The matrices of the viewer: right, up and backward are the rows of `view`.
function camera(canvas) {
  const up = axis(meta.up), right = axis(meta.right), back = cross(right, up), y = state.yaw * Math.PI / 180, p = state.pitch * Math.PI / 180;
  const x = right.map((v, k) => v * Math.cos(y) - back[k] * Math.sin(y)), h = right.map((v, k) => v * Math.sin(y) + back[k] * Math.cos(y));
  const z = h.map((v, k) => v * Math.cos(p) + up[k] * Math.sin(p)), u = cross(z, x);
  const aspect = canvas.width / canvas.height, tight = flat ? Math.max(dot(extent, up.map(Math.abs)), dot(extent, right.map(Math.abs)) / aspect) * 0.54 : radius * Math.max(1, 1 / aspect);
  const distance = tight / state.zoom / Math.sin(FIELD_OF_VIEW / 2) , target = middle.map((v, k) => v + radius * (state.panx * x[k] + state.pany * u[k]));
  const eye = target.map((v, k) => v + distance * z[k]);
  const view = [x[0], u[0], z[0], 0, x[1], u[1], z[1], 0, x[2], u[2], z[2], 0, -dot(x, eye), -dot(u, eye), -dot(z, eye), 1];
  const near = Math.max(distance - 3 * radius, 0.02 * distance), far = distance + 6 * radius, half = flat ? tight / state.zoom : Math.tan(FIELD_OF_VIEW / 2);
  const projection = flat ? [1 / (half * aspect), 0, 0, 0, 0, 1 / half, 0, 0, 0, 0, -2 / (far - near), 0, 0, 0, -(far + near) / (far - near), 1]
    : [1 / (half * aspect), 0, 0, 0, 0, 1 / half, 0, 0, 0, 0, -(far + near) / (far - near), -1, 0, 0, -2 * far * near / (far - near), 0];
  return {view, projection, pixel: 2 * (flat ? half : half * distance) / canvas.height, rows: [x, u, z], eye};
}

// A cut takes away the side that faces the viewer at first.
const toward = [0, 1, 2].map(k => cross(axis(meta.right), axis(meta.up))[k] < 0 ? -1 : 1);

function cuts(eyes) {
  return ["x", "y", "z"].flatMap((name, k) => {
    const share = state["cut" + name], sign = (state["flip" + name] ? -1 : 1) * toward[k];
    if (share >= 1) return [0, 0, 0, 1];
    const n = axis(k).map(v => v * sign), at = meta.low[k] + (sign > 0 ? share : 1 - share) * extent[k];
    return [...eyes.rows.map(row => dot(row, n)), sign * at - dot(n, eyes.eye)];
  });
}

const fieldNamed = name => meta.fields.find(f => f.name === name);

// Range of the colours as shares of the stored values.
function range(field) {
  const inner = (text, value) => (text === "" || !isFinite(text) ? value : (+text * field.factor - field.low) / (field.high - field.low));
  return {rangeLow: inner(state.low, 0), rangeHigh: inner(state.high, 1)};
}

function draw() {
  const gl = painter.gl, eyes = camera(gl.canvas), [a, b, between] = instant(), field = fieldNamed(state.field);
  const shared = {view: eyes.view, projection: eyes.projection, pixel: eyes.pixel, cut: cuts(eyes), between, magnify: state.magnify, orthographic: +flat, flat2: +flat,
    category: +(field?.kind === "whole"), ...(field ? range(field) : {}), scale: state.size, opacity: state.opacity, lift: 0, unlit: 0, alpha: 1};
  const of = (part, shown) => {  // textures of a part, and uniforms of its positions and colours
    const t = tables[part], values = data[`${part}/${shown?.name}`], info = part === "particles" ? meta.particles : meta.surfaces.find(s => s.name === part);
    t.posA.set(data[part][a]), t.posB.set(data[part][b]);
    if (state.magnify !== 1) t.pos0.set(data[part][0]);
    if (values) t.fieldA.set(values[a]), t.fieldB.set(values[b]);
    const textures = Object.fromEntries(["posA", "posB", "pos0", "fieldA", "fieldB"].map(name => [name, t[name].texture]));
    return [{...shared, low: info.low, size: info.size, largest: info.radius || 1, plain: values ? [0, 0, 0, 0] : [0.78, 0.76, 0.72, 1]}, {...textures, colours: tables.colours[shown?.kind || "plain"]}];
  };
  painter.begin([1, 1, 1]);
  if (meta.particles.count && state.particles) {
    const [values, textures] = of("particles", field), covering = +(state.opacity === 1 && !flat);
    if (covering) textures.covered = painter.covered(() => { painter.use("squares", {...values, inner: 1, covering: 0}, {...textures, covered: textures.colours}); painter.squares(meta.particles.count); });
    painter.use("spheres", {...values, inner: 0, covering}, {covered: textures.colours, ...textures});
    painter.squares(meta.particles.count);
  }
  if (meta.bonds.count) drawBonds(of, field, a, b);
  for (const surface of meta.surfaces) drawSurface(surface, of, field, a);
  return eyes;
}

function drawBonds(of, field, a, b) {
  const broken = brokenUntil(now()), {count} = meta.bonds, [values, textures] = of("particles", null), own = field && data[`bonds/${field.name}`];
  textures.bonds = tables.ends.texture;
  if (state.bonds) {
    if (own) tables.bonds.fieldA.set(own[a]), tables.bonds.fieldB.set(own[b]);
    painter.use("bonds", {...values, thick: flat ? 0.2 : 0.22, cracks: 0, plain: own ? [0, 0, 0, 0] : [0.45, 0.5, 0.55, 1]},
      {...textures, fieldA: tables.bonds.fieldA.texture, fieldB: tables.bonds.fieldB.texture, colours: tables.colours[own ? field.kind : "plain"]});
    painter.squares(count - broken);
  }
  if (state.cracks === "off" || !broken) return;
  painter.use("bonds", {...values, rangeLow: 0, rangeHigh: 1, cracks: state.cracks === "time" ? 2 : 1, time0: tables.when[tables.when.length - 1], time1: tables.when[0]},
    {...textures, colours: tables.colours.plain});
  painter.squares(broken, count - broken);
}

function drawSurface(surface, of, field, a) {
  const gl = painter.gl, k = surface.of[a], walls = surface.kind === "walls";
  if (!state[surface.kind]) return;
  const [values, textures] = of(surface.name, walls || surface.kind === "bodies" ? null : field);
  if (surface.kind !== "elements") values.plain = walls ? [0.5, 0.5, 0.48, 1] : [0.5, 0.62, 0.72, 1];
  const through = surface.kind !== "elements";
  painter.use("facets", {...values, alpha: walls ? 0.1 : through ? 0.25 : 1, opacity: through ? 1 : state.opacity, unlit: +(flat || walls)}, textures);
  painter.through(through, () => painter.corners(gl.TRIANGLES, surface.facets[k]));
  if (!through && !state.edges) return;
  painter.use("facets", {...values, opacity: 1, alpha: through ? 0.8 : 0.4, unlit: 1, lift: 2e-4, plain: surface.kind === "bodies" ? [0.25, 0.37, 0.47, 1] : [0.3, 0.3, 0.3, 1]}, textures);
  painter.through(true, () => painter.corners(gl.LINES, surface.edges[k]));
}

// --- curves -------------------------------------------------------------------------------------------------

function columnOf(name) {
  const k = meta.history.columns.findIndex(c => c.name === name);
  return k < 0 ? null : {...meta.history.columns[k], values: new Float32Array(data.history[k].buffer)};
}

function scaled(column) {
  let most = 0;
  for (const v of column.values) if (isFinite(v)) most = Math.max(most, Math.abs(v));
  if (column.unit === "1" && column.name.includes("strain")) return [0.01, "%"];
  const [factor, prefix] = ["s", "m", "Pa", "N", "J"].includes(column.unit) && most ? PREFIX.find(([f]) => most >= f) || PREFIX[6] : [1, ""];
  return [factor, column.unit === "1" ? "" : prefix + column.unit];
}
const labelOf = (column, unit) => `${(meta.words[column.name] || column.name).replace(/_/g, " ")}${unit ? ` [${unit}]` : ""}`;

function ticks(low, high, count) {
  const raw = (high - low) / count, power = 10 ** Math.floor(Math.log10(raw)), step = [1, 2, 5, 10].find(m => m * power >= raw) * power, found = [];
  for (let v = Math.ceil(low / step) * step; v <= high + 1e-9 * step; v += step) found.push(+v.toPrecision(10));
  return found;
}

// Row of the history at the present time.
function rowNow() {
  const time = columnOf("time")?.values;
  if (!time) return 0;
  let k = 0;
  while (k < time.length - 1 && time[k + 1] <= now() * (1 + 1e-6)) k++;
  return k;
}

function plot(canvas, [along, up]) {
  const x = columnOf(along), y = columnOf(up), ratio = devicePixelRatio || 1, c = canvas.getContext("2d");
  const width = canvas.clientWidth, height = canvas.clientHeight;
  canvas.width = width * ratio, canvas.height = height * ratio;
  c.scale(ratio, ratio);
  if (!x || !y || x.values.length < 2) return;
  const [fx, ux] = scaled(x), [fy, uy] = scaled(y), xs = Array.from(x.values, v => v / fx), ys = Array.from(y.values, v => v / fy);
  const ends = list => { const good = list.filter(isFinite); return [Math.min(...good), Math.max(...good)]; };
  let [x0, x1] = ends(xs), [y0, y1] = ends(ys);
  if (!(x1 > x0)) x1 = x0 + 1;
  if (!(y1 > y0)) y1 = y0 + 1;
  y0 -= 0.04 * (y1 - y0), y1 += 0.06 * (y1 - y0);
  const left = 46, right = 8, top = 18, bottom = 30, px = v => left + (v - x0) / (x1 - x0) * (width - left - right), py = v => height - bottom - (v - y0) / (y1 - y0) * (height - top - bottom);
  c.font = "11px system-ui, sans-serif";
  c.strokeStyle = "#e5e9ec", c.fillStyle = "#5c6b76", c.lineWidth = 1;
  c.textAlign = "center";
  for (const v of ticks(x0, x1, 5)) c.fillText(v, px(v), height - bottom + 13);
  c.textAlign = "right";
  for (const v of ticks(y0, y1, 4)) { c.beginPath(), c.moveTo(left, py(v)), c.lineTo(width - right, py(v)), c.stroke(); c.fillText(v, left - 5, py(v) + 4); }
  c.fillStyle = "#22303c";
  c.fillText(labelOf(x, ux), width - right, height - 4);
  c.textAlign = "left";
  c.fillText(labelOf(y, uy), 6, 11);
  const line = (from, to, colour) => {
    c.strokeStyle = colour, c.lineWidth = 1.5;
    c.beginPath();
    for (let k = from, pen = false; k <= to; k++) { const good = isFinite(xs[k]) && isFinite(ys[k]); if (good) c[pen ? "lineTo" : "moveTo"](px(xs[k]), py(ys[k])); pen = good; }
    c.stroke();
  };
  const row = rowNow();
  line(0, xs.length - 1, "#c5ced4");
  line(0, row, "#22303c");
  if (isFinite(xs[row]) && isFinite(ys[row])) c.fillStyle = "#c8402f", c.beginPath(), c.arc(px(xs[row]), py(ys[row]), 4, 0, 7), c.fill();
  canvas.onmousedown = canvas.onmousemove = event => {  // the nearest row of the curve sets the time
    if (!(event.buttons & 1)) return;
    const at = columnOf("time")?.values;
    if (!at) return;
    const far = k => Math.abs(px(xs[k]) - event.offsetX) + (along === "time" ? 0 : 0.3 * Math.abs(py(ys[k]) - event.offsetY));
    let best = 0;
    for (let k = 1; k < xs.length; k++) if (far(k) < far(best)) best = k;
    set("time", Math.min(1, Math.max(0, (at[best] - times[0]) / (times[last] - times[0] || 1))));
  };
}

// --- controls -----------------------------------------------------------------------------------------------

function set(key, value) {
  state[key] = value;
  const control = document.querySelector(`[data-key="${key}"]`);
  if (control) control.type === "checkbox" ? control.checked = value : control.value = value;
  if (key === "field") set("low", ""), set("high", "");
  dirty = true;
}

function legend() {
  const field = fieldNamed(state.field), bar = element("bar"), c = bar.getContext("2d");
  element("scale").hidden = !field;
  if (!field) return;
  for (let k = 0; k < 256; k++) c.fillStyle = `rgb(${colourAt(field.kind, field.kind === "whole" ? Math.floor(k / 25.6) : k).map(Math.round)})`, c.fillRect(k, 0, 1, 12);
  const text = v => +(v / field.factor).toPrecision(3), {rangeLow, rangeHigh} = range(field), at = s => text(field.low + s * (field.high - field.low));
  element("label").textContent = field.label + (field.unit ? ` [${field.unit}]` : "");
  const marks = field.kind === "whole" ? ["0", "", "9"] : [at(rangeLow), at(0.5 * (rangeLow + rangeHigh)), at(rangeHigh)];
  marks.forEach((v, k) => element(`mark${k}`).textContent = v);
  element("span").hidden = field.kind === "whole";
}

function crackLegend() {
  const box = element("cracks");
  box.hidden = state.cracks === "off" || !meta.bonds.broken;
  if (box.hidden) return;
  const until = tables.when[0], from = tables.when[tables.when.length - 1], swatch = (colour, text) => `<i style="background:${colour}"></i>${text}`;
  box.innerHTML = state.cracks === "cause" ? `broken ${swatch("#c8402f", "in tension")} ${swatch("#2b6cb0", "in shear")}`
    : `broken at ${quantity(from, "s")} ${swatch("linear-gradient(90deg," + STOPS.plain.map(c => "#" + c) + ");width:7rem", quantity(until, "s"))}`;
}

function caption() {
  const row = rowNow(), parts = [`t = ${quantity(now(), "s")}`];
  for (const name of meta.test ? ["strain", "stress"] : []) {
    const column = columnOf(name);
    if (!column || !isFinite(column.values[row])) continue;
    parts.push(`${meta.words[name]} ${column.unit === "1" ? `${+(100 * column.values[row]).toPrecision(3)} %` : quantity(column.values[row], column.unit)}`);
  }
  if (meta.bonds.count) parts.push(`${brokenUntil(now())} of ${meta.bonds.count} bonds broken`);
  element("now").textContent = parts.join(" · ");
}

function listen(canvas) {
  document.querySelectorAll("[data-key]").forEach(control => {
    const key = control.dataset.key;
    control.type === "checkbox" ? control.checked = state[key] : control.value = state[key];
    control.addEventListener("input", () => set(key, control.type === "checkbox" ? control.checked : control.type === "range" ? +control.value : control.value));
  });
  canvas.addEventListener("pointerdown", event => canvas.setPointerCapture(event.pointerId));
  canvas.addEventListener("pointermove", event => {
    if (!event.buttons) return;
    const pan = flat || event.buttons > 1 || event.shiftKey, unit = camera(canvas).pixel * (canvas.width / canvas.clientWidth) / radius;
    if (pan) state.panx -= event.movementX * unit, state.pany += event.movementY * unit;
    else state.yaw -= event.movementX * 0.4, state.pitch = Math.max(-90, Math.min(90, state.pitch + event.movementY * 0.4));
    dirty = true;
  });
  canvas.addEventListener("contextmenu", event => event.preventDefault());
  canvas.addEventListener("wheel", event => { event.preventDefault(); state.zoom *= Math.exp(-event.deltaY * 0.0012), dirty = true; }, {passive: false});
  const eyes = {front: [0, 0], side: [90, 0], top: [0, 90], oblique: [25, 14]};
  for (const [name, [yaw, pitch]] of Object.entries(eyes)) element(name).onclick = () => Object.assign(state, {yaw, pitch, panx: 0, pany: 0, zoom: 1}, {}) && (dirty = true);
  element("picture").onclick = () => { draw(); const link = document.createElement("a"); link.href = canvas.toDataURL(), link.download = "view.png", link.click(); };
  addEventListener("resize", () => dirty = true);
  addEventListener("keydown", event => { if (event.key === " " && !/INPUT|SELECT/.test(event.target.tagName)) set("play", !state.play), event.preventDefault(); });
}

function fill() {
  const select = element("field"), option = (to, value, text) => to.append(new Option(text, value));
  meta.fields.forEach(f => option(select, f.name, f.label));
  option(select, "", "none");
  meta.plots.forEach((names, k) => ["x", "y"].forEach((side, c) => {
    const list = element(`plot${k}${side}`);
    meta.history.columns.forEach(column => { option(list, column.name, (meta.words[column.name] || column.name).replace(/_/g, " ")); list.lastChild.title = column.text; });
    list.value = names[c];
    list.oninput = () => { names[c] = list.value, dirty = true; };
  }));
  for (let k = meta.plots.length; k < 2; k++) element(`curve${k}`).hidden = true;
  const there = {particles: meta.particles.count, bonds: meta.bonds.count, cracks: meta.bonds.broken};
  for (const kind of ["elements", "bodies", "walls"]) there[kind] = meta.surfaces.some(s => s.kind === kind);
  for (const [kind, count] of Object.entries(there)) document.querySelectorAll(`.of-${kind}`).forEach(e => e.hidden = !count);
  document.querySelectorAll(".of-space").forEach(e => e.hidden = flat);
}

function frame(stamp) {
  const step = Math.min(100, stamp - (frame.before || stamp)) / 1000;
  frame.before = stamp;
  if (state.play) set("time", state.time + step / 8 > 1 ? 0 : state.time + step / 8);
  if (state.turn) state.yaw += 36 * step, dirty = true;
  if (dirty) show();
  requestAnimationFrame(frame);
}

function show() {
  const canvas = painter.gl.canvas, ratio = Math.min(2, devicePixelRatio || 1);
  const width = Math.round(canvas.clientWidth * ratio), height = Math.round(canvas.clientHeight * ratio);
  if (canvas.width !== width || canvas.height !== height) canvas.width = width, canvas.height = height;
  dirty = false;
  draw();
  legend();
  crackLegend();
  caption();
  meta.plots.forEach((names, k) => plot(element(`plot${k}`), names));
}

// Mean time of a frame of a full turn, ms; reading a pixel waits until all is drawn.
function measured(frames) {
  const gl = painter.gl, pixel = new Uint8Array(4);
  const wait = () => gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
  draw(), wait();
  const begin = performance.now();
  for (let k = 0; k < frames; k++) state.yaw += 360 / frames, draw(), wait();
  return (performance.now() - begin) / frames;
}

async function start() {
  const begin = performance.now(), options = new URLSearchParams(location.hash.slice(1));
  const bytes = await bytesOf(element("data").textContent);
  data = Object.fromEntries(Object.entries(meta.arrays).map(([name, spec]) => [name, arrayOf(spec, bytes)]));
  painter = new Painter(element("canvas"));
  tables = tablesOf(painter.gl);
  fill();
  for (const [key, text] of options) if (key in state) state[key] = typeof state[key] === "number" ? +text : typeof state[key] === "boolean" ? text === "1" : text;
  listen(painter.gl.canvas);
  show();
  document.body.dataset.ready = Math.round(performance.now() - begin);
  if (options.has("measure")) document.body.dataset.frame = measured(+options.get("measure") || 20).toFixed(2);
  Object.assign(document.body.dataset, {calls: painter.calls, vertices: painter.vertices});
  requestAnimationFrame(frame);
}

start().catch(error => { element("fault").hidden = false, element("fault").textContent = `This run cannot be shown: ${error.message}`; document.body.dataset.fault = error.message; });
