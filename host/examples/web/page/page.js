// The page: what visitors set, and what they are told.
import { Engine } from "./engine.js";
import { limited, orbit } from "./orbit.js";
import { COARSE, Picture } from "./picture.js";
import { Pool } from "./pool.js";

const byId = (id) => document.getElementById(id);
const canvas = byId("view");
const form = byId("controls");

const MOST_THREADS = 16;
const [LEAST_WIDTH, MOST_WIDTH] = [32, 2048];
const FIRST_VIEW = { turn: 4, height_angle: -2, distance: 3.2 };
const sliders = ["density", "g", "albedo", "sun_turn", "sun_height", "sun", "sky"];
const choices = ["volume", "estimator", "packets", "stop"];
const names = ["A cumulus", "A ball of fog"];
const FILE = "2";

// A link may set any control, the view, and the size of the picture: #density=2&stop=64&width=320.
const link = new URLSearchParams(location.hash.slice(1));
const number = (name) => Number.parseFloat(link.get(name) ?? "");
const stops = Math.floor(number("stop"));
if (stops > 0) byId("stop").add(new Option(`${stops.toLocaleString("en")} samples`, stops), 0);
for (const name of [...sliders, ...choices]) {
  const asked = link.get(name);
  const input = byId(name);
  if (asked !== null && (!input.options || [...input.options].some((option) => option.value === asked))) input.value = asked;
}
if (byId("volume").value === FILE) byId("volume").value = "0";
const view = { ...FIRST_VIEW };
for (const name of Object.keys(view)) {
  if (Number.isFinite(number(name))) view[name] = number(name);
}
Object.assign(view, limited(view));
addEventListener("hashchange", () => location.reload());

function size() {
  const asked = number("width") || Math.min(640, canvas.clientWidth || 640);
  const width = Math.max(LEAST_WIDTH, Math.min(MOST_WIDTH, Math.floor(asked)));
  const multiple = (n) => n - (n % COARSE);
  return { width: multiple(width), height: multiple(Math.round(0.625 * width)) };
}

let full = size();
let picture;
let pool;
let shownVolume = byId("volume").value;

function controls(coarse) {
  const values = { ...view };
  for (const name of [...sliders, ...choices]) values[name] = Number(byId(name).value);
  values.density = 10 ** values.density;
  const scale = coarse ? COARSE : 1;
  return { ...values, width: full.width / scale, height: full.height / scale };
}

function say(text, wrong = false) {
  byId("message").textContent = text;
  byId("message").classList.toggle("wrong", wrong);
}

// What sliders stand at.
function tell() {
  for (const name of sliders) {
    const input = byId(name);
    const value = name === "density" ? (10 ** input.value).toPrecision(3) : input.value;
    const text = value + (input.dataset.unit ?? "");
    form.querySelector(`output[for=${name}]`).textContent = text;
    input.setAttribute("aria-valuetext", text);
  }
}

function changed() {
  tell();
  picture?.change();
  byId("pause").textContent = "Pause";
}

const report = {
  numbers({ samples, rate, noise }) {
    byId("samples").textContent = samples.toLocaleString("en");
    byId("speed").textContent = (rate / 1e6).toPrecision(3);
    byId("noise").textContent = Number.isFinite(noise) ? `${(100 * noise).toPrecision(3)} %` : "–";
  },
  wrong: (text) => say(text, true),
};

// Shows the volume that is chosen, or a file.
async function load(file) {
  const choice = byId("volume");
  const name = file ? file.name : names[choice.value];
  say(`${name} …`);
  try {
    const text = await pool.load(Number(file ? FILE : choice.value), await file?.arrayBuffer());
    if (text === undefined) return; // another one was chosen meanwhile
    if (file) choice.value = FILE;
    shownVolume = choice.value;
    say(`${name}: ${text}.`);
    byId("threads").textContent = pool.count;
    picture.begin();
    byId("pause").textContent = "Pause";
    for (const button of form.querySelectorAll("button")) button.disabled = false;
  } catch (error) {
    choice.value = shownVolume;
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
  const { text } = await pool.threads[0].ask({ ask: "describe", controls: picture.controls });
  return new Blob([text], { type: "text/plain" });
}

const failed = (error) => say(`That cannot be done: ${error.message}.`, true);
const actions = {
  pause() {
    picture.pause(!picture.paused);
    byId("pause").textContent = picture.paused ? "Go on" : "Pause";
  },
  async reset() {
    form.reset();
    Object.assign(view, FIRST_VIEW);
    changed();
    await load();
  },
  picture: () => canvas.toBlob((blob) => save(blob, "woodcock.png")),
  scene: async () => save(await scene(), "woodcock.pbrt"),
  async compare() {
    const output = byId("compared");
    byId("compare").disabled = true;
    output.textContent = "Tracing the same rows both ways …";
    try {
      const question = { ask: "compare", controls: picture.controls, seconds: 3 };
      const { scalar, packets, same } = await pool.threads[0].ask(question);
      const [a, b] = [packets, scalar].map((rate) => (rate / 1e6).toPrecision(3));
      const ratio = packets / scalar;
      const bits = same ? "the same bits" : "other bits";
      output.textContent = `Eight lanes ${a}, one lane ${b} million paths a second and thread: ${ratio.toFixed(2)} times as fast, ${bits}.`;
      output.dataset.ratio = ratio;
    } catch (error) {
      output.textContent = "";
      throw error;
    } finally {
      byId("compare").disabled = false;
    }
  },
};
for (const [id, action] of Object.entries(actions)) {
  byId(id).addEventListener("click", () => Promise.resolve().then(action).catch(failed));
}

form.addEventListener("submit", (event) => event.preventDefault());
form.addEventListener("input", ({ target }) => {
  if (!picture) tell();
  else if (target.id === "stop") picture.stop = Number(target.value);
  else if (target.id !== "volume" && target.type !== "file") changed();
  else if (target.id === "volume" && target.value !== FILE) load();
  else if (target.id === "volume") {
    target.value = shownVolume; // until there is a file
    byId("file").click();
  }
});
byId("file").addEventListener("change", ({ target }) => {
  const [file] = target.files;
  target.value = ""; // so that the same file can be chosen again
  if (file && picture) load(file);
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
  const [file] = event.dataTransfer.files;
  if (file && picture) load(file);
});
addEventListener("resize", () => {
  const next = size();
  if (next.width === full.width) return;
  full = next;
  picture?.begin();
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
  tell();
  const module = await compiled();
  const threads = Math.floor(number("threads")) || navigator.hardwareConcurrency || 2;
  pool = new Pool(module, Math.max(1, Math.min(MOST_THREADS, threads)));
  const engine = new Engine(await WebAssembly.instantiate(module, {}));
  picture = new Picture(canvas, engine, pool, controls, report);
  await load();
} catch (error) {
  const needs = error instanceof WebAssembly.CompileError ? " It needs WebAssembly with SIMD." : "";
  say(`The engine does not start: ${error.message}.${needs}`, true);
}

// For those who drive the page by script.
globalThis.woodcock = { scene };
