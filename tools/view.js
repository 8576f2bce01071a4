// SPDX-License-Identifier: MIT
// The film of a run in a page of its own: see view.py, which writes the data.
"use strict";

// The frames of a group: positions as 16 bits over the window, fields as 8 bits over their range.
function frames_of(group, bytes) {
  const frames = [];
  let at = group.offset;
  for (const n of group.counts) {
    const frame = { n, x: new Uint16Array(n), y: new Uint16Array(n), fields: [] };
    for (const axis of [frame.x, frame.y]) {
      for (let i = 0; i < n; i++) axis[i] = bytes[at + i] * 256 + bytes[at + n + i];
      at += 2 * n;
    }
    for (let k = 0; k < group.fields.length; k++) {
      frame.fields.push(bytes.subarray(at, at + n));
      at += n;
    }
    frames.push(frame);
  }
  return frames;
}

function frame_at(group, index) { return group.frames[Math.min(index, group.frames.length - 1)]; }

// Metres of a point of a frame.
function place(film, frame, i) {
  const [x0, x1, y0, y1] = film.window;
  return [x0 + (x1 - x0) * frame.x[i] / 65535, y0 + (y1 - y0) * frame.y[i] / 65535];
}

function value(field, byte) { return field.low + (field.high - field.low) * byte / 255; }

// The particle nearest to a place (m), within a distance; null if there is none.
function nearest(film, index, x, y, within) {
  let best = null, least = within * within;
  for (const name of Object.keys(film.groups)) {
    const group = film.groups[name], frame = frame_at(group, index);
    for (let i = 0; i < frame.n; i++) {
      const [px, py] = place(film, frame, i), d2 = (px - x) ** 2 + (py - y) ** 2;
      if (d2 < least) { least = d2; best = { name, group, frame, i, x: px, y: py }; }
    }
  }
  return best;
}

function nearest_index(times, t) {
  let best = 0;
  times.forEach((time, k) => { if (Math.abs(time - t) < Math.abs(times[best] - t)) best = k; });
  return best;
}

function digits(v) { return Number(v.toPrecision(4)).toString(); }

if (typeof module !== "undefined")
  module.exports = { frames_of, frame_at, place, value, nearest, nearest_index, digits };

// --- drawing ---

const VERTEX = `
attribute vec2 at; attribute float value; uniform vec4 view; uniform float size; varying float v;
void main() { gl_Position = vec4((at - view.xy) * view.zw, 0.0, 1.0); gl_PointSize = size; v = value; }`;
const FRAGMENT = `
precision mediump float; varying float v; uniform sampler2D palette; uniform vec4 plain;
void main() { gl_FragColor = plain.a > 0.0 ? plain : texture2D(palette, vec2((v * 255.0 + 0.5) / 256.0, 0.5)); }`;
const WALL = [0.75, 0.75, 0.75, 1];

function gl_painter(canvas) {
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
  const where = name => gl.getUniformLocation(program, name);
  const at = gl.getAttribLocation(program, "at"), value_at = gl.getAttribLocation(program, "value");
  const points = gl.createBuffer(), values = gl.createBuffer(), texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  for (const p of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, p, gl.NEAREST);
  for (const p of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, p, gl.CLAMP_TO_EDGE);
  gl.enableVertexAttribArray(at);
  return {
    clear() {
      gl.viewport(0, 0, canvas.width, canvas.height);
      gl.clearColor(1, 1, 1, 1);
      gl.clear(gl.COLOR_BUFFER_BIT);
    },
    group(film, frame, bytes, palette, size, view) {
      const packed = new Uint16Array(2 * frame.n);
      for (let i = 0; i < frame.n; i++) { packed[2 * i] = frame.x[i]; packed[2 * i + 1] = frame.y[i]; }
      gl.bindBuffer(gl.ARRAY_BUFFER, points);
      gl.bufferData(gl.ARRAY_BUFFER, packed, gl.STREAM_DRAW);
      gl.vertexAttribPointer(at, 2, gl.UNSIGNED_SHORT, true, 0, 0);
      if (bytes) {
        gl.bindBuffer(gl.ARRAY_BUFFER, values);
        gl.bufferData(gl.ARRAY_BUFFER, bytes, gl.STREAM_DRAW);
        gl.enableVertexAttribArray(value_at);
        gl.vertexAttribPointer(value_at, 1, gl.UNSIGNED_BYTE, true, 0, 0);
        gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB, 256, 1, 0, gl.RGB, gl.UNSIGNED_BYTE, palette);
      } else {
        gl.disableVertexAttribArray(value_at);
      }
      const [x0, x1, y0, y1] = film.window, w = x1 - x0, h = y1 - y0;
      gl.uniform4f(where("view"), (view.x - x0) / w, (view.y - y0) / h, 2 * w / view.w, 2 * h / view.h);
      gl.uniform4fv(where("plain"), bytes ? [0, 0, 0, 0] : WALL);
      gl.uniform1f(where("size"), Math.max(1, size));
      gl.drawArrays(gl.POINTS, 0, frame.n);
    },
  };
}

function flat_painter(canvas) {
  const c = canvas.getContext("2d");
  return {
    clear() { c.fillStyle = "white"; c.fillRect(0, 0, canvas.width, canvas.height); },
    group(film, frame, bytes, palette, size, view) {
      const s = Math.max(1, size);
      for (let i = 0; i < frame.n; i++) {
        const [x, y] = place(film, frame, i), b = bytes ? 3 * bytes[i] : 0;
        c.fillStyle = bytes ? `rgb(${palette[b]},${palette[b + 1]},${palette[b + 2]})` : "#bfbfbf";
        c.fillRect(((x - view.x) / view.w + 0.5) * canvas.width - s / 2,
                   (0.5 - (y - view.y) / view.h) * canvas.height - s / 2, s, s);
      }
    },
  };
}

// --- the page ---

function start(film) {
  const $ = id => document.getElementById(id);
  const canvas = $("scene"), over = $("over"), curve = $("curve");
  const painter = gl_painter(canvas) || flat_painter(canvas);
  const [x0, x1, y0, y1] = film.window;
  const state = { index: 0, playing: false, field: {}, probe: 0, ruler: null, zoom: 1, x: (x0 + x1) / 2, y: (y0 + y1) / 2 };

  function view() {
    const aspect = canvas.width / canvas.height, fit = Math.max(x1 - x0, (y1 - y0) * aspect) / state.zoom;
    return { x: state.x, y: state.y, w: fit, h: fit / aspect };
  }
  function metres(event) {
    const box = over.getBoundingClientRect(), v = view();
    return [v.x + ((event.clientX - box.left) / box.width - 0.5) * v.w,
            v.y + (0.5 - (event.clientY - box.top) / box.height) * v.h];
  }
  function pixels([x, y]) {
    const v = view();
    return [((x - v.x) / v.w + 0.5) * over.width, (0.5 - (y - v.y) / v.h) * over.height];
  }

  function draw_scene() {
    const v = view();
    painter.clear();
    for (const name of ["wall", "fluid", "solid"]) {
      const group = film.groups[name];
      if (!group) continue;
      const frame = frame_at(group, state.index), k = state.field[name];
      const coloured = group.fields.length > 0;
      painter.group(film, frame, coloured ? frame.fields[k] : null, coloured ? group.fields[k].palette : null,
                    1.1 * film.dp / v.w * canvas.width, v);
    }
    $("time").textContent = `t = ${digits(film.times[state.index])} s`;
    $("scrub").value = state.index;
    document.body.dataset.frame = state.index;
  }
  function draw_ruler() {
    const c = over.getContext("2d");
    c.clearRect(0, 0, over.width, over.height);
    if (!state.ruler) return;
    const [a, b] = state.ruler, [p, q] = [pixels(a), pixels(b)];
    c.strokeStyle = "#d00";
    c.lineWidth = 2;
    c.beginPath(); c.moveTo(...p); c.lineTo(...q); c.stroke();
    const dx = b[0] - a[0], dy = b[1] - a[1];
    const words = `${digits(Math.hypot(dx, dy))} m  (${digits(dx)}, ${digits(dy)})`;
    c.font = "14px sans-serif";
    c.fillStyle = "white"; c.fillRect(q[0] + 8, q[1] - 20, c.measureText(words).width + 8, 20);
    c.fillStyle = "#d00"; c.fillText(words, q[0] + 12, q[1] - 5);
    document.body.dataset.length = Math.hypot(dx, dy);
  }
  function draw_curve() {
    const c = curve.getContext("2d"), probe = film.probes[state.probe];
    c.clearRect(0, 0, curve.width, curve.height);
    if (!probe) return;
    const left = 70, right = 12, top = 12, bottom = 28, end = film.times[film.times.length - 1] || 1;
    const all = probe.value.concat(...probe.references.map(r => r.value)).filter(Number.isFinite);
    let low = Math.min(...all), high = Math.max(...all);
    if (!(high > low)) { low -= 1; high += 1; }
    const px = t => left + (curve.width - left - right) * t / end;
    const py = v => curve.height - bottom - (curve.height - top - bottom) * (v - low) / (high - low);
    c.font = "12px sans-serif"; c.fillStyle = "#333"; c.strokeStyle = "#999"; c.lineWidth = 1;
    c.strokeRect(left, top, curve.width - left - right, curve.height - top - bottom);
    for (const v of [low, (low + high) / 2, high]) c.fillText(digits(v), 4, py(v) + 4);
    for (const t of [0, end / 2, end]) c.fillText(digits(t) + " s", Math.min(px(t), curve.width - 46), curve.height - 8);
    for (const r of probe.references)
      r.time.forEach((t, k) => { c.beginPath(); c.arc(px(t), py(r.value[k]), 2.5, 0, 7); c.stroke(); });
    c.strokeStyle = "#0072b2"; c.lineWidth = 1.5; c.beginPath();
    probe.time.forEach((t, k) => c[k ? "lineTo" : "moveTo"](px(t), py(probe.value[k])));
    c.stroke();
    const now = film.times[state.index], k = nearest_index(probe.time, now);
    c.strokeStyle = "#d00"; c.beginPath(); c.moveTo(px(now), top); c.lineTo(px(now), curve.height - bottom); c.stroke();
    $("reading").textContent = `${digits(probe.value[k])} ${probe.unit} at ${digits(probe.time[k])} s`;
    curve.onclick = event => {
      const at = (event.clientX - curve.getBoundingClientRect().left) / curve.clientWidth * curve.width;
      go(nearest_index(film.times, (at - left) / (curve.width - left - right) * end));
    };
  }
  function draw_bar(name) {
    const group = film.groups[name];
    if (!group || !group.fields.length) return;
    const field = group.fields[state.field[name]], canvas = $(name + "-bar"), c = canvas.getContext("2d");
    for (let k = 0; k < 256; k++) {
      c.fillStyle = `rgb(${field.palette.slice(3 * k, 3 * k + 3).join(",")})`;
      c.fillRect(k / 256 * canvas.width, 0, canvas.width / 256 + 1, canvas.height);
    }
    $(name + "-range").textContent = `${digits(field.low)} to ${digits(field.high)} ${field.unit}`;
  }
  function draw() { draw_scene(); draw_ruler(); draw_curve(); draw_bar("fluid"); draw_bar("solid"); }
  function go(index) { state.index = Math.max(0, Math.min(film.times.length - 1, index)); draw(); }

  function play() {
    if (!state.playing) return;
    go(state.index + 1 < film.times.length ? state.index + 1 : 0);
    setTimeout(play, 1000 / Number($("fps").value));
  }
  function toggle() {
    state.playing = !state.playing;
    $("play").textContent = state.playing ? "Pause" : "Play";
    if (state.playing) play();
  }

  for (const name of ["fluid", "solid"]) {
    const group = film.groups[name];
    state.field[name] = 0;
    if (!group) { $(name + "-box").hidden = true; continue; }
    group.fields.forEach((field, k) => $(name).add(new Option(field.label, k)));
    $(name).onchange = () => { state.field[name] = Number($(name).value); draw(); };
  }
  film.probes.forEach((probe, k) => $("probe").add(new Option(probe.label, k)));
  $("probe").onchange = () => { state.probe = Number($("probe").value); draw(); };
  if (!film.probes.length) $("probes").hidden = true;
  $("scrub").max = film.times.length - 1;
  $("scrub").oninput = () => go(Number($("scrub").value));
  $("play").onclick = toggle;
  document.onkeydown = event => {
    if (event.target.tagName === "SELECT" || event.target.tagName === "INPUT") return;
    if (event.key === " ") { toggle(); event.preventDefault(); }
    if (event.key === "ArrowRight") go(state.index + 1);
    if (event.key === "ArrowLeft") go(state.index - 1);
  };

  let drag = null;
  over.onmousedown = event => { drag = { from: metres(event), pan: event.shiftKey, x: state.x, y: state.y }; };
  window.addEventListener("mouseup", () => { drag = null; });
  over.onmousemove = event => {
    const at = metres(event);
    if (drag && drag.pan) {
      state.x += drag.from[0] - at[0]; state.y += drag.from[1] - at[1];
      draw();
      return;
    }
    if (drag) { state.ruler = [drag.from, at]; draw_ruler(); }
    const hit = nearest(film, state.index, at[0], at[1], film.dp);
    let words = `x = ${digits(at[0])} m, y = ${digits(at[1])} m`;
    if (hit) {
      words += `; ${hit.name}`;
      hit.group.fields.forEach((field, k) => {
        words += `, ${field.label} ${digits(value(field, hit.frame.fields[k][hit.i]))} ${field.unit}`;
      });
    }
    $("where").textContent = words;
  };
  over.ondblclick = () => { Object.assign(state, { zoom: 1, x: (x0 + x1) / 2, y: (y0 + y1) / 2, ruler: null }); draw(); };
  over.onwheel = event => {
    event.preventDefault();
    const before = metres(event);
    state.zoom = Math.min(200, Math.max(0.5, state.zoom * Math.exp(-0.0015 * event.deltaY)));
    const after = metres(event);
    state.x += before[0] - after[0]; state.y += before[1] - after[1];
    draw();
  };

  function resize() {
    const wide = $("stage").clientWidth, tall = Math.min(0.6 * window.innerHeight, wide * (y1 - y0) / (x1 - x0));
    for (const c of [canvas, over]) { c.width = wide; c.height = Math.max(120, Math.round(tall)); }
    $("stage").style.height = canvas.height + "px";
    curve.width = wide;
    draw();
  }
  window.addEventListener("resize", resize);
  resize();
  document.body.dataset.ready = "yes";
}

async function load() {
  const film = JSON.parse(document.getElementById("film").textContent);
  const packed = Uint8Array.from(atob(document.getElementById("frames").textContent.trim()), c => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  for (const group of Object.values(film.groups)) {
    group.frames = frames_of(group, bytes);
    for (const field of group.fields) field.palette = Uint8Array.from(film.palettes[field.colours]);
  }
  start(film);
}

if (typeof document !== "undefined")
  load().catch(problem => { document.body.dataset.problem = problem; document.getElementById("where").textContent = problem; });
