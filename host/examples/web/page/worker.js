// A thread: instances of the engine that trace what the page asks for.
import { Engine } from "./engine.js";

let module;
let engine;
let prepared;

const answers = {
  begin(question) {
    module = question.module;
  },
  // Reads a volume into an instance of its own, beside the one that is in use.
  async prepare({ kind, file }) {
    prepared = undefined;
    const instance = new Engine(await WebAssembly.instantiate(module, {}));
    const text = instance.load(kind, file);
    prepared = instance;
    return { text, bytes: instance.bytes };
  },
  use() {
    engine = prepared;
    prepared = undefined;
  },
  trace({ controls, first, end, sample }) {
    engine.controls = controls;
    const begun = performance.now();
    const radiance = engine.trace(first, end, sample);
    return { radiance, seconds: (performance.now() - begun) / 1000 };
  },
  describe({ controls }) {
    engine.controls = controls;
    return { text: engine.describe() };
  },
  // The same rows in eight lanes and in one, in turns, for so many seconds: paths a second of each, and whether bits are the same.
  compare({ controls, seconds }) {
    const rows = Math.min(40, controls.height);
    const spent = [0, 0];
    let [paths, same] = [0, true];
    const end = performance.now() + 1000 * seconds;
    for (let sample = 0; performance.now() < end; sample++) {
      const first = (sample * rows) % (controls.height - rows + 1);
      const found = [1, 0].map((packets) => {
        engine.controls = { ...controls, packets };
        const begun = performance.now();
        const radiance = engine.trace(first, first + rows, sample);
        spent[packets] += performance.now() - begun;
        return new Uint32Array(radiance.buffer);
      });
      same &&= found[0].every((bits, i) => bits === found[1][i]);
      paths += rows * controls.width;
      // Until then the browser has not yet compiled all it can.
      if (performance.now() < end - 600 * seconds) {
        spent.fill(0);
        paths = 0;
      }
    }
    return { scalar: (1000 * paths) / spent[0], packets: (1000 * paths) / spent[1], same };
  },
};

onmessage = async ({ data }) => {
  try {
    const answer = (await answers[data.ask](data)) ?? {};
    const lent = answer.radiance ? [answer.radiance.buffer] : [];
    postMessage({ ...answer, number: data.number }, lent);
  } catch (error) {
    // Of an instance: no memory, or no stack.
    const broken = error instanceof WebAssembly.RuntimeError || error instanceof RangeError;
    postMessage({ number: data.number, wrong: broken ? "it is more than this page has memory for" : error.message });
  }
};
