// SPDX-License-Identifier: MIT
// Drawing of particles, colour bars and curves, for the page of the program.
"use strict";

const VERTEX = `
attribute vec3 point; uniform vec4 view; uniform float size; uniform vec2 range; varying float shade;
void main() {
  gl_Position = vec4((point.xy - view.xy) * view.zw, 0.0, 1.0);
  gl_PointSize = size;
  shade = (point.z - range.x) / max(range.y - range.x, 1e-30);
}`;
const FRAGMENT = `
precision mediump float; varying float shade; uniform sampler2D palette; uniform vec4 plain;
void main() {
  gl_FragColor = plain.a > 0.0 ? plain : texture2D(palette, vec2(clamp(shade, 0.002, 0.998), 0.5));
}`;
const GREY = [0.72, 0.72, 0.72, 1];

// Draws points of x, y, value: by WebGL where there is one.
function painter_of(canvas) { return gl_painter_of(canvas) || plain_painter_of(canvas); }

// Side of a particle in pixels.
function size_of(spacing, scale) { return Math.max(1.5, 1.2 * spacing * scale); }

function gl_painter_of(canvas) {
  const gl = canvas.getContext("webgl", { preserveDrawingBuffer: true });
  if (!gl) return null;
  const program = gl.createProgram();
  for (const [kind, source] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) return null;
  gl.useProgram(program);
  gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
  const point = gl.getAttribLocation(program, "point"), at = name => gl.getUniformLocation(program, name);
  gl.enableVertexAttribArray(point);
  gl.vertexAttribPointer(point, 3, gl.FLOAT, false, 0, 0);
  gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
  for (const key of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, key, gl.NEAREST);
  for (const key of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, key, gl.CLAMP_TO_EDGE);
  return {
    clear() {
      gl.viewport(0, 0, canvas.width, canvas.height);
      gl.clearColor(1, 1, 1, 1);
      gl.clear(gl.COLOR_BUFFER_BIT);
    },
    // Particles `spacing` (m) wide; without a palette they are grey.
    draw(points, spacing, view, palette, range) {
      if (!points.length) return;
      const scale = canvas.width / view.w, h = canvas.height / scale;
      gl.bufferData(gl.ARRAY_BUFFER, points, gl.STREAM_DRAW);
      gl.uniform4f(at("view"), view.x, view.y, 2 / view.w, 2 / h);
      gl.uniform1f(at("size"), size_of(spacing, scale));
      gl.uniform2f(at("range"), ...(range || [0, 1]));
      gl.uniform4fv(at("plain"), palette ? [0, 0, 0, 0] : GREY);
      if (palette) gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB, 256, 1, 0, gl.RGB, gl.UNSIGNED_BYTE, palette);
      gl.drawArrays(gl.POINTS, 0, points.length / 3);
    },
    fill(quads, view) {
      const corners = quads.flatMap(([a, b, c, d]) => [a, b, c, a, c, d]).flatMap(corner => [...corner, 0]);
      gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(corners), gl.STREAM_DRAW);
      gl.uniform4f(at("view"), view.x, view.y, 2 / view.w, 2 * canvas.width / view.w / canvas.height);
      gl.uniform4fv(at("plain"), [0, 0, 0, 1]);
      gl.drawArrays(gl.TRIANGLES, 0, 6 * quads.length);
    },
  };
}

function plain_painter_of(canvas) {
  const c = canvas.getContext("2d");
  return {
    clear() {
      c.fillStyle = "white";
      c.fillRect(0, 0, canvas.width, canvas.height);
    },
    draw(points, spacing, view, palette, range) {
      const scale = canvas.width / view.w, side = size_of(spacing, scale), [low, high] = range || [0, 1];
      c.fillStyle = `rgb(${GREY.slice(0, 3).map(part => 255 * part)})`;
      for (let i = 0; i < points.length; i += 3) {
        const shade = (points[i + 2] - low) / Math.max(high - low, 1e-30);
        const k = 3 * Math.round(255 * Math.min(Math.max(shade, 0), 1));
        if (palette) c.fillStyle = `rgb(${palette[k]},${palette[k + 1]},${palette[k + 2]})`;
        c.fillRect((points[i] - view.x) * scale + (canvas.width - side) / 2,
                   (view.y - points[i + 1]) * scale + (canvas.height - side) / 2, side, side);
      }
    },
    fill(quads, view) {
      const scale = canvas.width / view.w;
      c.fillStyle = "black";
      c.beginPath();
      for (const quad of quads)
        quad.forEach(([x, y], k) => c[k ? "lineTo" : "moveTo"]((x - view.x) * scale + canvas.width / 2,
                                                               (view.y - y) * scale + canvas.height / 2));
      c.fill();
    },
  };
}

// Walls are points of x, y, thickness: 0 of particles, NaN of beams without one. The former, and for each two points of a
// beam that follow each other, not further apart than `most`, a quad, at least `least` wide.
function split_beams(points, least, most) {
  const particles = [], quads = [];
  for (let i = 0; i < points.length; i += 3) {
    const [x, y, thickness] = points.subarray(i, i + 3);
    if (thickness === 0) particles.push(x, y, 0);
    if (thickness === 0 || i === 0 || !Object.is(points[i - 1], thickness)) continue;
    const dx = x - points[i - 3], dy = y - points[i - 2], length = Math.hypot(dx, dy);
    if (length < 0.1 * least || length > most) continue;
    const half = 0.5 * Math.max(thickness || 0, least) / length, u = half * dy, v = half * dx;
    quads.push([[x - dx - u, y - dy + v], [x - u, y + v], [x + u, y - v], [x - dx + u, y - dy - v]]);
  }
  return [new Float32Array(particles), quads];
}

// Smallest distance from one of a few particles to any other, m.
function spacing_of(points) {
  let least = Infinity;
  for (let i = 0; i < points.length; i += 3 * Math.ceil(points.length / 60))
    for (let j = 0; j < points.length; j += 3) {
      const d = Math.hypot(points[i] - points[j], points[i + 1] - points[j + 1]);
      if (j !== i && d > 0 && d < least) least = d;
    }
  return isFinite(least) ? least : 0;
}

// The middle 96 % of the values.
function range_of(points) {
  const values = [];
  for (let i = 2; i < points.length; i += 3 * Math.ceil(points.length / 6000)) values.push(points[i]);
  values.sort((a, b) => a - b);
  const n = values.length - 1;
  return n < 0 ? [0, 0] : [values[Math.floor(0.02 * n)], values[Math.ceil(0.98 * n)]];
}

function draw_bar(canvas, palette) {
  const c = canvas.getContext("2d");
  for (let x = 0; x < canvas.width; x++) {
    const k = 3 * Math.floor(255 * x / (canvas.width - 1));
    c.fillStyle = `rgb(${palette[k]},${palette[k + 1]},${palette[k + 2]})`;
    c.fillRect(x, 0, 1, canvas.height);
  }
}

function digits(v, n = 3) { return Number(v.toPrecision(n)).toString(); }

// Factor and name of a unit in which numbers up to `size` are easily read.
function readable(unit, size) {
  if (unit === "m" && size < 0.5) return [1e3, "mm"];
  if (unit === "Pa" && size >= 2e6) return [1e-6, "MPa"];
  if (unit === "Pa" && size >= 2e3) return [1e-3, "kPa"];
  return [1, unit];
}

// Round numbers between low and high.
function ticks(low, high, most) {
  const raw = (high - low) / most || 1, power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map(k => k * power).find(s => s >= raw), found = [];
  for (let k = Math.ceil(low / step); k * step <= high; k++) found.push(Number((k * step).toPrecision(12)));
  return found;
}

function legend_of(curves) {
  return curves.map(curve => {
    const item = document.createElement("span");
    item.textContent = { line: "— ", dots: "● ", dashes: "- - " }[curve.style] + curve.name;
    item.style.color = curve.colour;
    return item;
  });
}

// One curve beside its references: {time, value, name, style: line|dots|dashes, colour}. Gives a function from time to
// pixels, its inverse, and the frame's upper and lower edge.
function draw_chart(canvas, curves, end, label) {
  const c = canvas.getContext("2d"), ratio = devicePixelRatio || 1;
  const w = canvas.clientWidth, h = 230, left = 64, right = 10, top = 10, bottom = 34;
  canvas.width = w * ratio;
  canvas.height = h * ratio;
  c.setTransform(ratio, 0, 0, ratio, 0, 0);
  c.clearRect(0, 0, w, h);
  let low = 0, high = 0;
  for (const { time, value } of curves)
    value.forEach((v, k) => { if (time[k] <= end && isFinite(v)) { low = Math.min(low, v); high = Math.max(high, v); } });
  if (low === high) high = low + 1;
  const pad = 0.05 * (high - low);
  low -= pad; high += pad;
  const [factor, unit] = readable(label.unit, Math.max(-low, high));
  const X = t => left + (w - left - right) * t / end, Y = v => top + (h - top - bottom) * (high - v) / (high - low);
  c.font = "11px sans-serif";
  c.fillStyle = "#444";
  c.strokeStyle = "#e4e4e4";
  c.textAlign = "right";
  for (const v of ticks(factor * low, factor * high, 5)) {
    c.strokeRect(left, Y(v / factor), w - left - right, 0);
    c.fillText(digits(v, 5), left - 6, Y(v / factor) + 4);
  }
  c.textAlign = "center";
  for (const t of ticks(0, end, 8)) c.fillText(digits(t, 5), X(t), h - bottom + 16);
  c.fillText("time (s)", left + (w - left - right) / 2, h - 4);
  c.save();
  c.translate(12, top + (h - top - bottom) / 2);
  c.rotate(-Math.PI / 2);
  c.fillText(`${label.name} (${unit})`, 0, 0);
  c.restore();
  c.strokeStyle = "#999";
  c.strokeRect(left, top, w - left - right, h - top - bottom);
  for (const { time, value, style, colour } of curves) {
    c.strokeStyle = c.fillStyle = colour;
    c.lineWidth = style === "line" ? 1.8 : 1.2;
    c.setLineDash(style === "dashes" ? [5, 3] : []);
    c.beginPath();
    time.forEach((t, k) => {
      if (t > end || !isFinite(value[k])) return;
      if (style === "dots") { c.moveTo(X(t) + 2.5, Y(value[k])); c.arc(X(t), Y(value[k]), 2.5, 0, 7); }
      else c.lineTo(X(t), Y(value[k]));
    });
    if (style === "dots") c.fill(); else c.stroke();
  }
  c.setLineDash([]);
  c.lineWidth = 1;
  return { x_of: X, time_of: x => end * (x - left) / (w - left - right), top, bottom: h - bottom };
}
