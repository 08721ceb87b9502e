// Drawing of a run with WebGL 2: positions and values of an instant are textures, which vertex shaders read by the number of the
// particle; spheres are rays cast in the fragments of a square.
"use strict";

const WIDTH = 2048;  // texels of a row

const COMMON = `#version 300 es
precision highp float; precision highp int; precision highp usampler2D; precision highp sampler2D;
uniform usampler2D posA, posB, pos0, fieldA, fieldB;
uniform sampler2D colours;
uniform mat4 view, projection;
uniform vec3 low, size;
uniform float between, largest, magnify, rangeLow, rangeHigh, scale, opacity, pixel;
uniform vec4 cut[3];   // in the space of the viewer: kept where dot(xyz, p) <= w
uniform vec4 plain;    // the colour without values: w > 0
uniform int orthographic, category, flat2, offset;  // offset: the first item of a call
ivec2 texel(int k) { return ivec2(k % ${WIDTH}, k / ${WIDTH}); }
// Position and radius between two instants; a jump across a periodic box is not one.
vec4 placeOf(int k) {
  uvec4 a = texelFetch(posA, texel(k), 0), b = texelFetch(posB, texel(k), 0);
  vec3 p = vec3(a.xyz), d = vec3(b.xyz) - p;
  if (b.w == 0u || any(greaterThan(abs(d), vec3(32768.0)))) d = vec3(0.0);
  p += between * d;
  if (magnify != 1.0) { vec3 s = vec3(texelFetch(pos0, texel(k), 0).xyz); p = s + magnify * (p - s); }
  return vec4(low + p / 65535.0 * size, float(a.w) / 65535.0 * largest);
}
vec3 shadeOf(float v) { return texture(colours, vec2((v - rangeLow) / max(rangeHigh - rangeLow, 1e-6) * (255.0 / 256.0) + 0.5 / 256.0, 0.5)).rgb; }
vec3 colourOf(int k) {
  if (plain.w > 0.0) return plain.rgb;
  float a = float(texelFetch(fieldA, texel(k), 0).x), b = float(texelFetch(fieldB, texel(k), 0).x);
  if (category != 0) return texelFetch(colours, ivec2(int(a) % 10, 0), 0).rgb;
  return shadeOf(mix(a, b, between) / 255.0);
}
vec3 lit(vec3 colour, vec3 n) {
  float light = clamp(dot(n, normalize(vec3(-0.4, 0.5, 0.8))), 0.0, 1.0);
  return colour * (0.38 + 0.66 * light) * (0.72 + 0.28 * smoothstep(0.0, 0.45, abs(n.z)));
}
bool away(vec3 p) { return dot(cut[0].xyz, p) > cut[0].w || dot(cut[1].xyz, p) > cut[1].w || dot(cut[2].xyz, p) > cut[2].w; }
`;
// A pattern of 4 x 4 pixels in place of blending, which would need an order.
const DITHER = `
void thin() {
  ivec2 p = ivec2(gl_FragCoord.xy) & 3;
  int m[16] = int[](0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5);
  if (opacity < 1.0 && (float(m[p.x + 4 * p.y]) + 0.5) / 16.0 > opacity) discard;
}
void depthAt(vec3 p) { vec4 c = projection * vec4(p, 1.0); gl_FragDepth = 0.5 + 0.5 * c.z / c.w; }
`;
const SPHERES = [COMMON + `
flat out vec4 ball; flat out vec3 colour; flat out float front; out vec3 at;
uniform int inner, covering; uniform sampler2D covered;
// True if spheres in front hide a small sphere at all of 5 x 5 points; fragments of larger ones look for themselves.
bool isHidden(vec3 centre, float r) {
  vec4 c = projection * vec4(centre, 1.0), e = projection * vec4(centre + vec3(r, r, 0.0), 1.0);
  vec2 screen = vec2(textureSize(covered, 0)), middle = (0.5 + 0.5 * c.xy / c.w) * screen, reach = abs((0.5 + 0.5 * e.xy / e.w) * screen - middle);
  if (max(reach.x, reach.y) > 12.0) return false;
  for (int k = 0; k < 25; k++) {
    vec2 p = middle + reach * (vec2(k % 5, k / 5) * 0.5 - 1.0);
    if (front <= texelFetch(covered, clamp(ivec2(p), ivec2(0), ivec2(screen) - 1), 0).x) return false;
  }
  return true;
}
float depthOf(float z) { vec4 c = projection * vec4(0.0, 0.0, z, 1.0); return 0.5 + 0.5 * c.z / c.w; }
void main() {
  int item = (gl_VertexID >> 2) + offset;
  vec4 p = placeOf(item);
  ball = vec4((view * vec4(p.xyz, 1.0)).xyz, p.w * scale);
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  if (p.w == 0.0) return;
  float r = ball.w, d = length(ball.xyz);
  for (int k = 0; k < 3; k++) if (dot(cut[k].xyz, ball.xyz) - r > cut[k].w) return;
  if (orthographic == 0) { if (ball.z > -r) return; r *= d * d / (-ball.z * sqrt(max(d * d - r * r, 1e-30))); }
  vec3 corner = vec3(vec2(gl_VertexID & 1, gl_VertexID >> 1 & 1) * 2.0 - 1.0, 0.0);
  at = ball.xyz + corner * r * 1.02;
  if (inner != 0) {  // a square inside the sphere: what lies behind it is hidden
    for (int k = 0; k < 3; k++) if (dot(cut[k].xyz, ball.xyz) + ball.w > cut[k].w) return;
    at = ball.xyz + corner * ball.w * 0.68;
  } else {
    colour = colourOf(item);
    front = depthOf(ball.z + ball.w);
    if (covering != 0 && isHidden(ball.xyz, ball.w)) return;
  }
  gl_Position = projection * vec4(at, 1.0);
}`, COMMON + DITHER + `
flat in vec4 ball; flat in vec3 colour; flat in float front; in vec3 at; out vec4 shown;
uniform sampler2D covered; uniform int covering;
void main() {
  if (covering != 0 && front > texelFetch(covered, ivec2(gl_FragCoord.xy), 0).x) discard;
  thin();
  vec3 o = vec3(at.xy, 0.0), d = vec3(0.0, 0.0, -1.0);
  if (orthographic == 0) { o = vec3(0.0); d = normalize(at); }
  vec3 c = ball.xyz - o;
  float b = dot(d, c), q = b * b - dot(c, c) + ball.w * ball.w;
  if (q < 0.0) discard;
  q = sqrt(q);
  float near = b - q, far = b + q;
  vec3 n = (o + d * near - ball.xyz) / ball.w;
  for (int k = 0; k < 3; k++) {
    float s = dot(cut[k].xyz, d), t = (cut[k].w - dot(cut[k].xyz, o)) / (abs(s) < 1e-9 ? 1e-9 : s);
    if (s > 0.0) far = min(far, t);
    else if (s < 0.0 && t > near) { near = t; n = cut[k].xyz; }
  }
  if (near > far) discard;
  vec3 p = o + d * near;
  if (flat2 != 0) { float e = length(p.xy - ball.xy) / ball.w; shown = vec4(colour * (e > 1.0 - 1.3 * pixel / ball.w ? 0.72 : 1.0), 1.0); }
  else shown = vec4(lit(colour, n), 1.0);
  depthAt(p);
}`];
const SQUARES = [SPHERES[0], COMMON + "out vec4 shown; void main() { shown = vec4(1.0); }"];
const BONDS = [COMMON + `
uniform usampler2D bonds; uniform int cracks; uniform float thick, time0, time1;
out vec3 at; out vec2 across; flat out vec3 colour;
void main() {
  int k = (gl_VertexID >> 2) + offset;
  uvec4 bond = texelFetch(bonds, texel(k), 0);
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  vec4 p = placeOf(int(bond.x)), q = placeOf(int(bond.y));
  vec3 d = q.xyz - p.xyz;
  float l = length(d), reach = p.w + q.w;
  if (p.w == 0.0 || q.w == 0.0 || l == 0.0 || l > 1.25 * reach) return;  // one is not there, or they are far apart
  across = vec2(gl_VertexID & 1, gl_VertexID >> 1 & 1) * 2.0 - 1.0;
  if (cracks != 0) {  // a disc across the bond, midway between the two surfaces
    vec3 n = d / l, u = normalize(abs(n.z) < 0.9 ? cross(n, vec3(0, 0, 1)) : cross(n, vec3(1, 0, 0))), v = cross(n, u);
    if (flat2 != 0) v = vec3(0.0);
    vec3 m = p.xyz + n * 0.5 * (l + p.w - q.w);
    float w = min(p.w, q.w);
    at = (view * vec4(m + u * across.x * w + v * across.y * w, 1.0)).xyz;
    if (flat2 != 0) at += (view * vec4(n * across.y * max(1.2 * pixel, 0.09 * w), 0.0)).xyz + vec3(0.0, 0.0, 0.1 * largest);
    float t = uintBitsToFloat(bond.z);
    colour = cracks == 2 ? shadeOf((t - time0) / max(time1 - time0, 1e-30)) : bond.w == 1u ? vec3(0.78, 0.25, 0.18) : bond.w == 2u ? vec3(0.17, 0.42, 0.69) : vec3(0.35);
  } else {
    vec3 a = (view * vec4(p.xyz, 1.0)).xyz, b = (view * vec4(q.xyz, 1.0)).xyz, m = across.y < 0.0 ? a : b;
    vec3 side = normalize(cross(b - a, orthographic == 1 ? vec3(0, 0, 1) : -m));
    at = m + side * across.x * max(thick * min(p.w, q.w), 0.6 * pixel);
    if (flat2 != 0) at.z += 0.05 * largest;
    across.y = 0.0;
    colour = colourOf(k);
  }
  gl_Position = projection * vec4(at, 1.0);
}`, COMMON + `
uniform int cracks;
in vec3 at; in vec2 across; flat in vec3 colour; out vec4 shown;
void main() {
  if (away(at)) discard;
  float e = cracks != 0 && flat2 == 0 ? dot(across, across) : across.x * across.x;
  if (e > 1.0) discard;
  shown = vec4(colour * (cracks != 0 ? 1.0 - 0.25 * step(0.72, e) * float(1 - flat2) : 0.55 + 0.45 * sqrt(1.0 - e)), 1.0);
}`];
const FACETS = [COMMON + `
out vec3 at; out vec3 colour; uniform float lift;
void main() {
  at = (view * vec4(placeOf(gl_VertexID).xyz, 1.0)).xyz;
  colour = colourOf(gl_VertexID);
  gl_Position = projection * vec4(at, 1.0);
  gl_Position.z -= lift * gl_Position.w;
}`, COMMON + DITHER + `
uniform int unlit; uniform float alpha; in vec3 at; in vec3 colour; out vec4 shown;
void main() {
  thin();
  if (away(at)) discard;
  vec3 n = normalize(cross(dFdx(at), dFdy(at)));
  shown = vec4(unlit != 0 ? colour : lit(colour, n.z < 0.0 ? -n : n), alpha);
}`];

function programOf(gl, [vertex, fragment]) {
  const program = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  const place = {};
  for (let k = 0; k < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); k++) {
    const name = gl.getActiveUniform(program, k).name;
    place[name.replace("[0]", "")] = gl.getUniformLocation(program, name);
  }
  return {program, place};
}

// A texture of `components` whole numbers of `bytes` for each row of an array.
class Table {
  constructor(gl, components, bytes) {
    this.gl = gl;
    this.texture = gl.createTexture();
    const names = {"4,2": ["RGBA16UI", "RGBA_INTEGER", "UNSIGNED_SHORT"], "4,4": ["RGBA32UI", "RGBA_INTEGER", "UNSIGNED_INT"], "1,1": ["R8UI", "RED_INTEGER", "UNSIGNED_BYTE"]};
    [this.inside, this.format, this.type] = names[[components, bytes]].map(name => gl[name]);
    this.components = components;
    this.rows = 0;
    this.held = null;
  }

  set(array) {
    if (this.held === array) return;
    this.held = array;
    const gl = this.gl, count = array.length / this.components, rows = Math.max(1, Math.ceil(count / WIDTH)), whole = Math.floor(count / WIDTH);
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    if (rows !== this.rows) {
      gl.texImage2D(gl.TEXTURE_2D, 0, this.inside, WIDTH, rows, 0, this.format, this.type, null);
      for (const name of ["MIN", "MAG"]) gl.texParameteri(gl.TEXTURE_2D, gl[`TEXTURE_${name}_FILTER`], gl.NEAREST);
      this.rows = rows;
    }
    if (whole) gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, WIDTH, whole, this.format, this.type, array.subarray(0, whole * WIDTH * this.components));
    if (count % WIDTH) gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, whole, count % WIDTH, 1, this.format, this.type, array.subarray(whole * WIDTH * this.components));
  }
}

function colourTable(gl, colours) {
  const texture = gl.createTexture(), data = new Uint8Array(256 * 4);
  for (let k = 0; k < 256; k++) data.set([...colours(k), 255], 4 * k);
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, 256, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, data);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
  return texture;
}

// Draws one scene. `draw` is given the uniforms that all share and a list of what to draw; it counts calls and vertices.
class Painter {
  constructor(canvas) {
    const gl = this.gl = canvas.getContext("webgl2", {antialias: true, preserveDrawingBuffer: true});
    if (!gl) throw new Error("this browser has no WebGL 2");
    this.programs = {spheres: programOf(gl, SPHERES), squares: programOf(gl, SQUARES), bonds: programOf(gl, BONDS), facets: programOf(gl, FACETS)};
    this.empty = new Table(gl, 4, 2);
    this.empty.set(new Uint16Array(4));
    this.none = new Table(gl, 1, 1);
    this.none.set(new Uint8Array(1));
    gl.enable(gl.DEPTH_TEST);
    gl.bindVertexArray(gl.createVertexArray());
  }

  indices(array) {
    const gl = this.gl, buffer = gl.createBuffer();
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, array, gl.STATIC_DRAW);
    return {buffer, count: array.length};
  }

  begin(background) {
    const gl = this.gl;
    this.calls = this.vertices = 0;
    gl.viewport(0, 0, gl.canvas.width, gl.canvas.height);
    gl.clearColor(...background, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  }

  // Depths up to which spheres cover what is behind them, as a texture: fragments that are hidden cost little.
  covered(drawing) {
    const gl = this.gl, {width, height} = gl.canvas;
    if (!this.cover) this.cover = {frame: gl.createFramebuffer(), texture: gl.createTexture()};
    gl.bindTexture(gl.TEXTURE_2D, this.cover.texture);
    if (this.cover.width !== width || this.cover.height !== height) {
      Object.assign(this.cover, {width, height});
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.DEPTH_COMPONENT24, width, height, 0, gl.DEPTH_COMPONENT, gl.UNSIGNED_INT, null);
      for (const name of ["MIN", "MAG"]) gl.texParameteri(gl.TEXTURE_2D, gl[`TEXTURE_${name}_FILTER`], gl.NEAREST);
    }
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.cover.frame);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, this.cover.texture, 0);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    drawing();
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    return this.cover.texture;
  }

  // `values`: uniforms by name; numbers of integers by the name of the type in INTEGERS; `tables`: textures by name.
  use(name, values, tables) {
    const gl = this.gl, {program, place} = this.programs[name];
    gl.useProgram(program);
    this.used = place;
    const integers = new Set(["orthographic", "category", "flat2", "cracks", "unlit", "inner", "covering"]);
    for (const [key, value] of Object.entries(values)) {
      if (!place[key]) continue;
      if (typeof value === "number") integers.has(key) ? gl.uniform1i(place[key], value) : gl.uniform1f(place[key], value);
      else if (value.length === 16) gl.uniformMatrix4fv(place[key], false, value);
      else if (value.length === 12) gl.uniform4fv(place[key], value);
      else gl[`uniform${value.length}fv`](place[key], value);
    }
    const all = {posA: this.empty.texture, posB: this.empty.texture, pos0: this.empty.texture, fieldA: this.none.texture, fieldB: this.none.texture, ...tables};
    Object.entries(all).forEach(([key, texture], unit) => {
      if (!place[key]) return;
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.uniform1i(place[key], unit);
    });
    gl.activeTexture(gl.TEXTURE0 + 15);
  }

  // Draws what lies behind as well: translucent facets are the last and hide nothing.
  through(on, drawing) {
    const gl = this.gl;
    if (on) gl.enable(gl.BLEND), gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE), gl.depthMask(false);
    drawing();
    gl.disable(gl.BLEND);
    gl.depthMask(true);
  }

  // Squares of items from `first` on. One buffer of corners serves all: instances of four corners are slower.
  squares(count, first = 0) {
    const gl = this.gl, MOST = 1 << 16;
    if (!this.corner) {
      const corners = new Uint32Array(6 * MOST);
      for (let k = 0; k < MOST; k++) corners.set([0, 1, 2, 2, 1, 3].map(c => 4 * k + c), 6 * k);
      this.corner = this.indices(corners);
    }
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.corner.buffer);
    for (let begin = 0; begin < count; begin += MOST) {
      const some = Math.min(MOST, count - begin);
      gl.uniform1i(this.used.offset, first + begin);
      gl.drawElements(gl.TRIANGLES, 6 * some, gl.UNSIGNED_INT, 0);
      this.calls++;
      this.vertices += 4 * some;
    }
  }

  corners(kind, indices) {
    const gl = this.gl;
    if (!indices.count) return;
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, indices.buffer);
    gl.drawElements(kind, indices.count, gl.UNSIGNED_INT, 0);
    this.calls++;
    this.vertices += indices.count;
  }
}
