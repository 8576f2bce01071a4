// SPDX-License-Identifier: MIT
// Runs the program, compiled to WebAssembly, in a thread of its own. Messages to it: load, create, run, pause,
// step, fields, drawn. Messages from it: ready, created, refused, frame, stopped, finished.
"use strict";

const SLICE = 60; // ms between looks at the messages

let program, memory, built = false, running = false, shown = true, busy = 0, rows = [], columns = [];
let fields = { fluid: "pressure", solid: "von_mises" };
const KINDS = ["fluid", "wall", "solid"];

// What the C library asks of the system: a clock, no files, no environment. 52: not available; 44: no such
// file; 8: no such descriptor.
function system(module) {
  const view = () => new DataView(memory.buffer);
  const calls = {
    clock_time_get(id, precision, at) {
      view().setBigUint64(at, BigInt(Math.round(performance.now() * 1e6)), true);
      return 0;
    },
    environ_sizes_get(count, size) {
      view().setUint32(count, 0, true);
      view().setUint32(size, 0, true);
      return 0;
    },
    environ_get: () => 0,
    fd_prestat_get: () => 8,
    path_open: () => 44,
    path_filestat_get: () => 44,
    proc_exit(status) { throw new Error("the program ended with status " + status); },
  };
  for (const { name } of WebAssembly.Module.imports(module)) calls[name] = calls[name] || (() => 52);
  return { wasi_snapshot_preview1: calls };
}

function instance(bytes) {
  const module = new WebAssembly.Module(bytes);
  program = new WebAssembly.Instance(module, system(module)).exports;
  memory = program.memory;
  program._initialize();
}

function text_at(at) {
  const bytes = new Uint8Array(memory.buffer);
  return at ? new TextDecoder().decode(bytes.slice(at, bytes.indexOf(0, at))) : "";
}

function put(text) {
  const bytes = new TextEncoder().encode(text + "\0"), at = program.reserve(bytes.length);
  new Uint8Array(memory.buffer, at, bytes.length).set(bytes);
  return at;
}

async function unpacked(packed) {
  const bytes = Uint8Array.from(atob(packed), c => c.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
}

// The build with fused multiply-add where the machine has it, else the one that computes it in software: both
// give the same bits.
async function load({ fused, exact }) {
  const fast = await unpacked(fused);
  let kind = "fused";
  if (WebAssembly.validate(fast)) instance(fast);
  if (!program || !program.fused()) {
    kind = "software";
    instance(await unpacked(exact));
  }
  postMessage({ what: "ready", kind, version: text_at(program.version()) });
}

function lines(text) { return text.split("\n").filter(line => line); }

function failure() { return [text_at(program.error()), ...lines(text_at(program.more_errors()))]; }

// Points of a kind as x, y, value; the buffer is a copy that goes to the page.
function points(kind, field) {
  const name = put(field), n = program.count(kind), at = program.particles(kind, name);
  program.release(name);
  return at && n ? new Float32Array(memory.buffer, at, 3 * n).slice() : new Float32Array(0);
}

function sample() {
  const row = [program.now()];
  columns.forEach(({ probe, column }) => {
    if (column === 0) columns.values = program.probe(probe);
    row.push(columns.values ? new Float64Array(memory.buffer, columns.values, 5)[column] : NaN);
  });
  rows.push(row);
}

function send_frame() {
  const frame = { what: "frame", time: program.now(), end: program.end(), steps: program.steps(), busy, rows,
                  fluid: points(0, fields.fluid), wall: points(1, "thickness"), solid: points(2, fields.solid) };
  rows = [];
  shown = false;
  postMessage(frame, [frame.fluid.buffer, frame.wall.buffer, frame.solid.buffer]);
}

function create({ name, text, sets, fields: wanted }) {
  running = built = false;
  fields = wanted;
  if (program.create(put(name), put(text), put(sets.join("\n")), 0)) {
    postMessage({ what: "refused", problems: failure() });
    return;
  }
  built = true;
  columns = [];
  for (let probe = 0, at; (at = program.probe_column(probe, 0)); probe++)
    for (let column = 0; (at = program.probe_column(probe, column)); column++)
      columns.push({ probe, column, name: text_at(at) });
  busy = 0;
  rows = [];
  postMessage({ what: "created", columns: columns.map(c => c.name), notes: lines(text_at(program.said())) });
  sample();
  send_frame();
}

// One step; false: no more of them.
function advance() {
  const begin = performance.now(), next = program.next_output(), failed = program.step(Infinity);
  busy += performance.now() - begin;
  if (failed) {
    running = false;
    send_frame();
    postMessage({ what: "stopped", problems: failure() });
    return false;
  }
  if (program.now() >= next) sample();
  if (program.now() < program.end()) return true;
  running = false;
  send_frame();
  postMessage({ what: "finished", hash: text_at(program.hash()), busy });
  return false;
}

function slice() {
  const until = performance.now() + SLICE;
  while (running && performance.now() < until && advance()) { /* go on */ }
  if (!running) return;
  if (shown) send_frame();
  setTimeout(slice, 0);
}

const answers = {
  load,
  create,
  run() {
    if (running) return;
    running = true;
    slice();
  },
  pause() { running = false; },
  step() {
    if (program.now() < program.end() && advance()) send_frame();
  },
  fields(message) {
    fields = message.fields;
    if (built && !running) send_frame();
  },
  drawn() { shown = true; },
};

onmessage = ({ data }) => answers[data.what](data);
