// The page: asks threads for samples, sums them up, shows what there is.
import { Engine } from "./engine.js";
import { orbit } from "./orbit.js";
import { Pool } from "./pool.js";

const byId = (id) => document.getElementById(id);
const canvas = byId("view");
const context = canvas.getContext("2d", { willReadFrequently: true }); // written by the CPU

// Pixels are so much larger while something moves.
const COARSE = 4;
const MOVING = 250; // milliseconds after the last change
const QUEUED = 2; // questions a thread has, so that it never waits for the page
const SECONDS_A_QUESTION = 0.03;
const FIRST_VIEW = { turn: 4, height_angle: -2, distance: 3.2 };

const view = { ...FIRST_VIEW };
const sliders = ["density", "g", "albedo", "sun_turn", "sun_height", "sun", "sky"];
const choices = ["volume", "estimator", "packets", "stop"];

// A link may set any control, the view, and the size of the picture: #density=2&stop=64&width=320.
const link = new URLSearchParams(location.hash.slice(1));
const stops = Number.parseInt(link.get("stop"), 10);
if (stops > 0) byId("stop").add(new Option(`${stops.toLocaleString("en")} samples`, stops), 0);
for (const name of [...sliders, ...choices]) {
  const asked = link.get(name);
  const input = byId(name);
  if (asked !== null && (!input.options || [...input.options].some((option) => option.value === asked))) input.value = asked;
}
for (const name of Object.keys(view)) {
  const asked = Number.parseFloat(link.get(name));
  if (Number.isFinite(asked)) view[name] = asked;
}

function size() {
  const asked = Number.parseInt(link.get("width"), 10);
  const width = asked > 0 ? asked : Math.min(640, canvas.clientWidth || 640);
  const whole = Math.max(COARSE, Math.min(2048, width - (width % COARSE)));
  const height = Math.round(whole * 0.625);
  return { width: whole, height: height - (height % COARSE) };
}

function controls() {
  const values = { ...view };
  for (const name of sliders) values[name] = Number(byId(name).value);
  for (const name of choices) values[name] = Number(byId(name).value);
  values.density = 10 ** values.density;
  const scale = run.coarse ? COARSE : 1;
  return { ...values, width: full.width / scale, height: full.height / scale };
}

let full = size();
let engine; // of this thread: the film
let pool;
let paused = false;
let movedAt = -Infinity;
let moving = 0;
// What is being traced: every change begins another one.
let run = { coarse: false, controls: undefined, row: 0, sample: 0, done: 0, begun: 0, paths: 0, busy: 0 };

function begin(coarse) {
  run = { coarse, row: 0, sample: 0, done: 0, begun: performance.now(), paths: 0, busy: 0 };
  run.controls = controls();
  engine.controls = run.controls;
  engine.newFilm();
  canvas.dataset.samples = 0;
  feed();
}

function changed() {
  for (const output of document.querySelectorAll("label output")) {
    const input = byId(output.htmlFor[0]);
    const value = input.id === "density" ? (10 ** input.value).toPrecision(3) : input.value;
    output.textContent = value + (input.dataset.unit ?? "");
  }
  if (!pool?.count) return;
  movedAt = performance.now();
  begin(true);
  clearTimeout(moving);
  moving = setTimeout(() => {
    if (run.coarse) begin(false);
  }, MOVING);
}

// A job of a thread, until there is no more.
function next() {
  if (paused || run.sample >= run.controls.stop) return;
  const { width, height } = run.controls;
  const rate = run.busy > 0 ? run.paths / run.busy : 2e5;
  const rows = Math.max(1, Math.min(height - run.row, Math.round((rate * SECONDS_A_QUESTION) / width)));
  const question = { ask: "trace", controls: run.controls, first: run.row, end: run.row + rows, sample: run.sample };
  run.row += rows;
  if (run.row >= height) [run.row, run.sample] = [0, run.sample + 1];
  return question;
}

function feed() {
  for (const thread of pool.threads) {
    while (thread.idle < QUEUED) {
      const question = next();
      if (!question) return;
      answer(thread, question, run);
    }
  }
}

async function answer(thread, question, asker) {
  try {
    const { radiance, seconds } = await thread.ask(question);
    if (asker !== run) return feed();
    engine.expose(question.first, radiance);
    run.paths += radiance.length / 3;
    run.busy += seconds;
    feed();
  } catch (error) {
    say(`A thread has stopped: ${error.message}`, true);
  }
}

let shownAt = 0;
function show() {
  requestAnimationFrame(show);
  if (!run.controls) return;
  const { width, height } = run.controls;
  const samples = run.paths / (width * height);
  // An unfinished first picture would be black below.
  if (samples < 1 || samples === run.done) return;
  const now = performance.now();
  const finished = samples === run.controls.stop;
  if (now - shownAt < (run.coarse ? 0 : 100) && !finished) return;
  shownAt = now;
  run.done = samples;
  if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
  context.putImageData(engine.picture(), 0, 0);
  byId("samples").value = Math.floor(samples).toLocaleString("en");
  const seconds = (now - run.begun) / 1000;
  byId("speed").value = (run.paths / seconds / 1e6).toPrecision(3);
  const noise = engine.calls.noise();
  byId("noise").value = Number.isFinite(noise) ? `${(100 * noise).toPrecision(3)} %` : "–";
  canvas.dataset.mean = engine.calls.mean();
  canvas.dataset.samples = run.coarse ? 0 : Math.floor(samples);
}

function say(text, wrong = false) {
  byId("message").textContent = text;
  byId("message").classList.toggle("wrong", wrong);
}

async function load(file) {
  const source = byId("volume");
  if (!file && source.value === "2") source.value = "0";
  const names = ["A cumulus", "A ball of fog"];
  const name = file ? file.name : names[source.value];
  say(`${name} …`);
  try {
    const text = await pool.load(file ? 2 : Number(source.value), await file?.arrayBuffer());
    if (file) source.value = "2";
    say(`${name}: ${text}.`);
    byId("threads").value = pool.count;
    begin(false);
  } catch (error) {
    say(`${name} cannot be shown: ${error.message}.`, true);
  }
}

function save(blob, name) {
  const anchor = document.createElement("a");
  anchor.href = URL.createObjectURL(blob);
  anchor.download = name;
  anchor.click();
  setTimeout(() => URL.revokeObjectURL(anchor.href), 1000);
}

async function scene() {
  const { text } = await pool.threads[0].ask({ ask: "describe", controls: run.controls });
  return new Blob([text], { type: "text/plain" });
}

byId("controls").addEventListener("input", (event) => {
  if (event.target.type === "file") return;
  if (event.target.id !== "volume") changed();
  else if (event.target.value === "2") byId("file").click();
  else load();
});
byId("controls").addEventListener("submit", (event) => event.preventDefault());
byId("file").addEventListener("change", (event) => {
  if (event.target.files.length > 0) load(event.target.files[0]);
});
byId("pause").addEventListener("click", () => {
  paused = !paused;
  byId("pause").textContent = paused ? "Go on" : "Pause";
  if (!paused) feed();
});
byId("reset").addEventListener("click", () => {
  byId("controls").reset();
  Object.assign(view, FIRST_VIEW);
  changed();
  load();
});
byId("picture").addEventListener("click", () => canvas.toBlob((blob) => save(blob, "woodcock.png")));
byId("scene").addEventListener("click", async () => save(await scene(), "woodcock.pbrt"));
byId("compare").addEventListener("click", async () => {
  const output = byId("compared");
  output.value = "Tracing the same rows both ways …";
  const { scalar, packets, same } = await pool.threads[0].ask({ ask: "compare", controls: run.controls, seconds: 3 });
  const [a, b] = [packets, scalar].map((rate) => (rate / 1e6).toPrecision(3));
  const bits = same ? "the same bits" : "other bits";
  output.value = `Eight lanes ${a}, one lane ${b} million paths a second and thread: ${(packets / scalar).toFixed(2)} times as fast, ${bits}.`;
  output.dataset.ratio = packets / scalar;
});

// Files may be dropped anywhere.
const holdsFile = (event) => event.dataTransfer?.types.includes("Files");
addEventListener("dragover", (event) => {
  if (!holdsFile(event)) return;
  event.preventDefault();
  byId("drop").hidden = false;
});
addEventListener("dragleave", (event) => {
  if (!event.relatedTarget) byId("drop").hidden = true;
});
addEventListener("drop", (event) => {
  if (!holdsFile(event)) return;
  event.preventDefault();
  byId("drop").hidden = true;
  load(event.dataTransfer.files[0]);
});
addEventListener("resize", () => {
  const next = size();
  if (next.width === full.width || !pool?.count) return;
  full = next;
  begin(false);
});

orbit(canvas, view, changed);

async function compiled() {
  const answer = await fetch(new URL("engine.wasm.gz", import.meta.url));
  if (!answer.ok) throw new Error(`engine.wasm.gz: ${answer.status} ${answer.statusText}`);
  const bytes = await answer.arrayBuffer();
  const [a, b] = new Uint8Array(bytes, 0, 2);
  // Some servers tell browsers to unpack what is named so.
  if (a !== 0x1f || b !== 0x8b) return WebAssembly.compile(bytes);
  const unpacked = new Response(bytes).body.pipeThrough(new DecompressionStream("gzip"));
  return WebAssembly.compile(await new Response(unpacked).arrayBuffer());
}

try {
  changed();
  const module = await compiled();
  engine = new Engine(await WebAssembly.instantiate(module, {}));
  const asked = Number.parseInt(link.get("threads"), 10);
  pool = new Pool(module, asked > 0 ? Math.min(asked, 64) : Math.min(navigator.hardwareConcurrency || 2, 16));
  await load();
  show();
} catch (error) {
  say(`The engine does not start: ${error.message}. It needs WebAssembly with SIMD.`, true);
}

// For those who drive the page by script.
globalThis.woodcock = { scene };
