// SPDX-License-Identifier: MIT
// The film of a run in a page of its own: see view.py, which writes the data. web/draw.js comes before it.
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

// x, y (m) and value of each particle of a frame; without a field the value is 0.
function points_of(film, group, frame, k) {
  const points = new Float32Array(3 * frame.n);
  for (let i = 0; i < frame.n; i++) {
    [points[3 * i], points[3 * i + 1]] = place(film, frame, i);
    points[3 * i + 2] = group.fields.length ? value(group.fields[k], frame.fields[k][i]) : 0;
  }
  return points;
}

if (typeof module !== "undefined")
  module.exports = { frames_of, frame_at, place, value, nearest, nearest_index, points_of };

// --- the page ---

function start(film) {
  const $ = id => document.getElementById(id);
  const canvas = $("scene"), over = $("over"), curve = $("curve");
  const painter = painter_of(canvas);
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
      const k = state.field[name], field = group.fields[k];
      const points = points_of(film, group, frame_at(group, state.index), k);
      group.spacing = group.spacing || spacing_of(points);
      painter.draw(points, group.spacing, v, field ? field.palette : null,
                   field ? [field.low, field.high] : null);
    }
    $("time").textContent = `t = ${digits(film.times[state.index], 4)} s`;
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
    const words = `${digits(Math.hypot(dx, dy), 4)} m  (${digits(dx, 4)}, ${digits(dy, 4)})`;
    c.font = "14px sans-serif";
    c.fillStyle = "white"; c.fillRect(q[0] + 8, q[1] - 20, c.measureText(words).width + 8, 20);
    c.fillStyle = "#d00"; c.fillText(words, q[0] + 12, q[1] - 5);
    document.body.dataset.length = Math.hypot(dx, dy);
  }
  function draw_curve() {
    const probe = film.probes[state.probe];
    if (!probe) return;
    const now = film.times[state.index], end = film.times[film.times.length - 1] || 1;
    const curves = probe.references.map((r, k) => ({
      time: r.time, value: r.value, style: r.measured ? "dots" : "dashes", colour: ["#000", "#888", "#b60"][k % 3],
      name: r.label }));
    curves.push({ time: probe.time, value: probe.value, style: "line", colour: "#0072b2", name: "this run" });
    const chart = draw_chart(curve, curves, end, { name: probe.name, unit: probe.unit });
    const c = curve.getContext("2d");
    c.strokeStyle = "#d00";
    c.strokeRect(chart.x_of(now), chart.top, 0, chart.bottom - chart.top);
    $("legend").replaceChildren(...legend_of(curves));
    const k = nearest_index(probe.time, now);
    $("reading").textContent = `${digits(probe.value[k], 4)} ${probe.unit} at ${digits(probe.time[k], 4)} s`;
    curve.onclick = event => {
      go(nearest_index(film.times, chart.time_of(event.clientX - curve.getBoundingClientRect().left)));
    };
  }
  function draw_colours(name) {
    const group = film.groups[name];
    if (!group || !group.fields.length) return;
    const field = group.fields[state.field[name]];
    draw_bar($(name + "-bar"), field.palette);
    $(name + "-range").textContent = `${digits(field.low, 4)} to ${digits(field.high, 4)} ${field.unit}`;
  }
  function draw() { draw_scene(); draw_ruler(); draw_curve(); draw_colours("fluid"); draw_colours("solid"); }
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
    let words = `x = ${digits(at[0], 4)} m, y = ${digits(at[1], 4)} m`;
    if (hit) {
      words += `; ${hit.name}`;
      hit.group.fields.forEach((field, k) => {
        words += `, ${field.label} ${digits(value(field, hit.frame.fields[k][hit.i]), 4)} ${field.unit}`;
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
