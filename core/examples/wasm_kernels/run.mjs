// Runs the module of this example: node run.mjs MODULE.wasm LIMIT. Fails where its results are not those of the firmware, which
// tracks the same rays, or where it has more bytes than the limit.
import { readFile } from "node:fs/promises";

const [file, limit] = process.argv.slice(2);
const code = await readFile(file);
const { instance } = await WebAssembly.instantiate(code, {});
const { memory, __heap_base, key, flight, transmittance, scatter, density } = instance.exports;
const begin = __heap_base.value;
memory.grow(1);
const words = new Uint32Array(memory.buffer, begin, 256);
const numbers = new Float32Array(memory.buffer, begin, 256);

// A page, a stream, 17 x 2 x 2 samples that rise from 0 to 1 and fall back, and the bounds of two blocks within their rim.
const [page, stream, samples, majorants] = [0, 16, 20, 88];
words.set([begin + 4 * samples, begin + 4 * majorants, 17, 2, 2], page);
numbers.set([0.25, 0, 0.5, 0.5, 1, 0, 0, 16], page + 5);
for (let i = 0; i < 68; i++) numbers[samples + i] = 0.125 * Math.min(i % 17, 16 - (i % 17));
numbers.fill(1 + 2 ** -20, majorants + 17, majorants + 19);

const paths = 4096;
let [sum, left] = [0, 0];
for (let sample = 0; sample < paths; sample++) {
  key(begin + 4 * stream, 6n, 2, sample);
  sum = Math.fround(sum + transmittance(begin, begin + 4 * stream));
  left += flight(begin, begin + 4 * stream) === Infinity ? 1 : 0;
}
numbers[255] = sum / paths;
const cosine = scatter(0.25, 0.5);
const checks = {
  "transmittance has the bits of the firmware": words[255] === 0x3e092bb3,
  "flights leave as often as e^-2 says": Math.abs(left / paths - Math.exp(-2)) < (4 * 0.3421) / 64,
  "scattering inverts its distribution": Math.abs(cosine - (1.25 - (0.75 / 0.75) ** 2)) < 1e-6,
  "and knows its density": Math.abs(density(cosine, 0.5) - 0.75 / (4 * Math.PI)) < 1e-6,
  [`${code.length} bytes of ${limit}`]: code.length <= Number(limit),
};
for (const [what, holds] of Object.entries(checks)) console.log(holds ? "holds:" : "FAILED:", what);
process.exit(Object.values(checks).every(Boolean) ? 0 : 1);
