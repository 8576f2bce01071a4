// The page: controls on the left, the picture on the right. A worker has the program.

const DATA = JSON.parse(document.getElementById("data").textContent);
const FIELDS = {
  fluid: { pressure: ["pressure", "Pa"], velocity: ["speed", "m/s"], density: ["density", "kg/m³"] },
  solid: { von_mises: ["von Mises stress", "Pa"], displacement: ["displacement", "m"], velocity: ["speed", "m/s"] },
};
const $ = id => document.getElementById(id);

const painter = painter_of($("scene"));
const worker = new Worker(URL.createObjectURL(new Blob([$("worker").textContent], { type: "text/javascript" })));
const state = { chosen: null, frame: null, columns: [], rows: [], ranges: {}, spacing: {}, view: null,
                moved: false, after: null, running: false, changed: false };

function palette(kind) { return Uint8Array.from(DATA.palettes[kind]); }

function list(element, texts) {
  element.replaceChildren(...texts.map(text => Object.assign(document.createElement("li"), { textContent: text })));
}

// --- the case and its constants ---

const NUMBER = /^(\s*)([A-Za-z_]\w*)\s*=\s*(-?\d[\d.]*(?:[eE][-+]?\d+)?)\s*([A-Za-z][A-Za-z0-9^*/-]*)?\s*(?:#\s*(.*))?$/;
const OF_SOLIDS = ["young", "density", "poisson"];

// What sliders move: dp, end_time, named constants, and the material of solids.
function constants_of(text) {
  const found = [];
  let kind = "top", section = "";
  for (const line of text.split("\n")) {
    const head = line.match(/^\s*\[(\w+)\s*([^\]]*)\]/);
    if (head) [kind, section] = [head[1], head[2].trim()];
    const hit = line.match(NUMBER);
    if (!hit || Number(hit[3]) === 0) continue;
    const [, , name, value, unit = "", about = ""] = hit;
    const moves = kind === "constants" || (kind === "top" && ["dp", "end_time"].includes(name)) ||
                  (kind === "solid" && OF_SOLIDS.includes(name));
    if (moves) found.push({ key: kind === "solid" ? `${section}.${name}` : name, value: Number(value), unit, about,
                            whole: !unit && /^\d+$/.test(value) && Number(value) < 1000 });
  }
  return found;
}

function make_sliders() {
  $("sliders").replaceChildren(...constants_of($("text").value).map(constant => {
    const label = document.createElement("label"), slider = document.createElement("input");
    const name = document.createElement("span"), shown = document.createElement("output");
    Object.assign(slider, { type: "range", min: -1, max: 1, step: 0.01, value: 0 });
    name.textContent = constant.key;
    label.title = constant.about;
    slider.addEventListener("input", () => {
      const moved = constant.value * 2 ** Number(slider.value);
      constant.now = constant.whole ? Math.max(1, Math.round(moved)) : Number(moved.toPrecision(3));
      show();
    });
    const show = () => {
      const now = slider.value === "0" ? constant.value : constant.now;
      shown.textContent = `${now} ${constant.unit}`;
      shown.className = now === constant.value ? "" : "moved";
      label.dataset.set = now === constant.value ? "" : `${constant.key}=${now} ${constant.unit}`.trim();
    };
    show();
    label.append(name, slider, shown);
    return label;
  }));
}

function sets() {
  return [...$("sliders").querySelectorAll("label")].map(label => label.dataset.set).filter(set => set);
}

// Numbers of the lines, those with a problem marked.
function number_lines(wrong = []) {
  const count = $("text").value.split("\n").length;
  $("lines").replaceChildren(...Array.from({ length: count }, (_, k) => {
    const line = document.createElement("span");
    line.textContent = k + 1;
    if (wrong.includes(k + 1)) line.className = "wrong";
    return line;
  }));
  if (wrong.length) $("text").scrollTop = 16 * Math.max(0, wrong[0] - 8);
  $("lines").scrollTop = $("text").scrollTop;
}

function show_problems(problems) {
  const places = problems.map(text => text.match(/^[^\s:]+:(\d+): |^line (\d+): /)).filter(hit => hit);
  number_lines(places.map(hit => Number(hit[1] || hit[2])));
  list($("problems"), problems);
}

function choose(name) {
  state.chosen = DATA.cases.find(c => c.name === name) || DATA.cases[0];
  $("case").value = state.chosen.name;
  $("text").value = state.chosen.text;
  make_sliders();
  $("fluid").value = state.chosen.fluid;
  build();
}

// --- the program ---

// Builds the simulation at time zero; `after` is then sent to the worker.
function build(after = null) {
  Object.assign(state, { after, frame: null, rows: [], ranges: {}, spacing: {}, view: null, moved: false,
                         changed: $("text").value !== state.chosen.text || sets().length > 0 });
  $("verdict").textContent = $("verdict").className = "";
  document.body.dataset.state = "building";
  show_problems([]);
  worker.postMessage({ what: "create", name: `${state.chosen.name}.cfg`, text: $("text").value, sets: sets(),
                       fields: shown_fields() });
}

function set_running(running) {
  const begun = running || (state.frame && state.frame.time > 0);
  state.running = running;
  $("run").textContent = begun ? "Restart" : "Run";
  $("pause").textContent = begun && !running ? "Continue" : "Pause";
  $("pause").disabled = !running && !(begun && state.frame.time < state.frame.end);
}

function verdict(hash) {
  const native = state.chosen.hash;
  document.body.dataset.hash = hash;
  const say = (kind, text) => { $("verdict").className = kind; $("verdict").textContent = text; };
  if (state.changed)
    return say("", `State hash ${hash}. The native program has run the case as shipped only; ` +
               "summary.json has its state_hash for the same case and --set.");
  if (hash === native)
    return say("equal", `State hash ${hash}, here and of the native program: the same bits.`);
  return say("differs", `State hash ${hash} here, ${native} of the native program: not the same bits. ` +
             `This page is of version ${DATA.version}; please report browser and machine.`);
}

const answers = {
  ready({ kind, version }) {
    document.body.dataset.multiply_add = kind;
    document.querySelector("footer").append(` Multiply-add: ${kind === "fused" ? "fused, by the machine" :
      "exact, in software, since this browser or machine does not fuse it"}. Version ${version}.`);
    const asked = new URLSearchParams(location.search);
    choose(asked.get("case"));
  },
  created({ columns, notes }) {
    state.columns = columns;
    $("notes").querySelector("summary").textContent = `${notes.length} warnings and notes`;
    $("notes").hidden = !notes.length;
    list($("notes").querySelector("ul"), notes);
    const named = state.chosen.references.map(r => r.column), before = $("probe").value;
    $("probe").replaceChildren(...columns.map(name => new Option(name)));
    $("probe").value = columns.includes(before) ? before : columns.find(c => named.includes(c)) || columns[0] || "";
    $("curves").hidden = !columns.length;
    document.body.dataset.state = "built";
    set_running(false);
    if (state.after) act(state.after);
    state.after = null;
  },
  refused({ problems }) {
    show_problems(problems);
    set_running(false);
    document.body.dataset.state = "refused";
  },
  frame(frame) {
    state.rows.push(...frame.rows);
    state.frame = frame;
    if (!state.running) set_running(false);
    requestAnimationFrame(() => { draw(); worker.postMessage({ what: "drawn" }); });
  },
  stopped({ problems }) {
    show_problems(problems);
    set_running(false);
    document.body.dataset.state = "stopped";
  },
  finished({ hash, busy }) {
    set_running(false);
    verdict(hash);
    document.body.dataset.seconds = (busy / 1000).toFixed(3);
    document.body.dataset.state = "finished";
  },
};
worker.onmessage = ({ data }) => answers[data.what](data);
worker.onerror = event => show_problems([`The program failed: ${event.message}`]);

function act(what) {
  worker.postMessage({ what });
  if (what === "run") set_running(true);
  if (what === "pause") set_running(false);
  document.body.dataset.state = what === "run" ? "running" : "paused";
}

// --- drawing ---

function first_view(frame) {
  const given = state.chosen.view;
  let [x0, x1, y0, y1] = given || [Infinity, -Infinity, Infinity, -Infinity];
  for (const points of given ? [] : [frame.fluid, frame.wall, frame.solid])
    for (let i = 0; i < points.length; i += 3) {
      x0 = Math.min(x0, points[i]); x1 = Math.max(x1, points[i]);
      y0 = Math.min(y0, points[i + 1]); y1 = Math.max(y1, points[i + 1]);
    }
  const margin = given ? 0 : 0.04 * Math.max(x1 - x0, y1 - y0), w = x1 - x0 + 2 * margin, h = y1 - y0 + 2 * margin;
  const aspect = Math.min(Math.max(h / w, 0.25), 0.8);
  return { x: (x0 + x1) / 2, y: (y0 + y1) / 2, w: Math.max(w, h / aspect), aspect };
}

// Moves the view by as little as keeps a moving tank in it; what is larger than the view stays where it is.
function keep_in_view(view, points) {
  for (const [k, axis, size] of [[0, "x", view.w], [1, "y", view.w * view.aspect]]) {
    let low = Infinity, high = -Infinity;
    for (let i = k; i < points.length; i += 3) { low = Math.min(low, points[i]); high = Math.max(high, points[i]); }
    if (high - low <= size) view[axis] = Math.min(Math.max(view[axis], high - size / 2), low + size / 2);
  }
}

// A range of colours only grows, so that colours of different times can be compared.
function range(kind, points) {
  const now = range_of(points), before = state.ranges[kind];
  state.ranges[kind] = before ? [Math.min(before[0], now[0]), Math.max(before[1], now[1])] : now;
  return state.ranges[kind];
}

function draw_scene(frame) {
  const canvas = $("scene"), ratio = devicePixelRatio || 1;
  state.view = state.view || first_view(frame);
  if (!state.moved) keep_in_view(state.view, frame.wall.length ? frame.wall : frame.fluid);
  canvas.width = Math.round(canvas.clientWidth * ratio);
  canvas.height = Math.round(canvas.width * state.view.aspect);
  painter.clear();
  state.spacing.fluid = state.spacing.fluid || spacing_of(frame.fluid);
  const [walls, beams] = split_beams(frame.wall, 1.5 * state.view.w / canvas.width, 4 * state.spacing.fluid);
  for (const kind of ["wall", "fluid", "solid"]) {
    const points = kind === "wall" ? walls : frame[kind];
    state.spacing[kind] = state.spacing[kind] || spacing_of(points);
    painter.draw(points, state.spacing[kind], state.view, kind === "wall" ? null : palette(kind),
                 kind === "wall" ? null : range(kind, points));
  }
  painter.fill(beams, state.view);
}

function draw_legends(frame) {
  for (const kind of ["fluid", "solid"]) {
    const legend = $(`${kind}-legend`), ends = state.ranges[kind] || [0, 0];
    legend.hidden = !frame[kind].length;
    const [factor, unit] = readable(FIELDS[kind][$(kind).value][1], Math.max(Math.abs(ends[0]), Math.abs(ends[1])));
    legend.querySelector(".low").textContent = digits(factor * ends[0]);
    legend.querySelector(".high").textContent = `${digits(factor * ends[1])} ${unit}`;
  }
}

function draw_curves(frame) {
  const column = $("probe").value, at = state.columns.indexOf(column);
  if (at < 0) return;
  const time = state.rows.map(row => row[0]), value = state.rows.map(row => row[at + 1]);
  const curves = state.chosen.references.filter(r => r.column === column).map((r, k) => ({
    time: r.time, value: r.value, style: r.measured ? "dots" : "dashes", colour: ["#000", "#888", "#b60"][k % 3],
    name: r.label + (state.changed ? " (of the case as shipped)" : "") }));
  curves.unshift({ time, value, style: "line", colour: "#0072b2", name: "here" });
  const [, name, unit] = column.match(/^(.+?)_((?:m2|m|Pa|Nm|N|J|rad|1)(?:_per_\w+)?)$/) || [0, column, "1"];
  draw_chart($("chart"), curves, frame.end, { name, unit: unit.replace("_per_", "/") });
  $("legend").replaceChildren(...legend_of(curves));
}

function draw() {
  const frame = state.frame;
  if (!frame) return;
  draw_scene(frame);
  draw_legends(frame);
  draw_curves(frame);
  const particles = (frame.fluid.length + frame.solid.length) / 3;
  const rate = frame.busy > 0 ? `, ${digits(frame.steps * particles / frame.busy / 1e3)} million particle steps a second` : "";
  $("done").value = frame.time / frame.end;
  $("clock").textContent = `${digits(frame.time, 4)} of ${digits(frame.end, 4)} s, ${frame.steps} steps, ` +
                           `${particles} particles${rate}`;
}

// --- controls ---

function shown_fields() { return { fluid: $("fluid").value, solid: $("solid").value }; }

for (const kind of ["fluid", "solid"]) {
  $(kind).replaceChildren(...Object.entries(FIELDS[kind]).map(([name, [label]]) => new Option(label, name)));
  draw_bar($(`${kind}-legend`).querySelector("canvas"), palette(kind));
  $(kind).addEventListener("change", () => {
    state.ranges = {};
    worker.postMessage({ what: "fields", fields: shown_fields() });
  });
}
$("case").replaceChildren(...DATA.cases.map(c => new Option(c.title, c.name)));
$("case").addEventListener("change", () => choose($("case").value));
$("run").addEventListener("click", () => build("run"));
$("pause").addEventListener("click", () => act(state.running ? "pause" : "run"));
$("step").addEventListener("click", () => act("step"));
$("reset").addEventListener("click", () => choose(state.chosen.name));
$("sliders").addEventListener("change", () => build());
$("probe").addEventListener("change", draw);
$("text").addEventListener("scroll", () => { $("lines").scrollTop = $("text").scrollTop; });
$("text").addEventListener("input", () => number_lines());
$("text").addEventListener("change", () => { make_sliders(); build(); });
window.addEventListener("resize", draw);
$("scene").addEventListener("wheel", event => {
  event.preventDefault();
  if (!state.view) return;
  state.moved = true;
  state.view.w *= 1.1 ** Math.sign(event.deltaY);
  draw();
}, { passive: false });
$("scene").addEventListener("pointermove", event => {
  if (!state.view || event.buttons !== 1) return;
  state.moved = true;
  const metres = state.view.w / $("scene").clientWidth;
  state.view.x -= event.movementX * metres;
  state.view.y += event.movementY * metres;
  draw();
});

worker.postMessage({ what: "load", ...DATA.programs });
