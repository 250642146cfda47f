// Runs the module of this example: node run.mjs MODULE.wasm LIMIT. Fails where its results are not those of the firmware, which
// tracks the same rays one by one, or where it has more bytes than the limit.
import { readFile } from "node:fs/promises";

const [file, limit] = process.argv.slice(2);
const code = await readFile(file);
const { instance } = await WebAssembly.instantiate(code, {});
const { memory, __heap_base, flights, transmittances, scatter, density } = instance.exports;
const begin = Math.ceil(__heap_base.value / 16) * 16;
memory.grow(1);
const words = new Uint32Array(memory.buffer, begin, 256);
const numbers = new Float32Array(memory.buffer, begin, 256);

// A page, eight rays, 17 x 2 x 2 samples that rise from 0 to 1 and fall back, and the bounds of two blocks within their rim.
const [page, rays, samples, majorants] = [0, 16, 100, 168];
words.set([begin + 4 * samples, begin + 4 * majorants, 17, 2, 2], page);
numbers.set([0.25], page + 5);
for (let i = 0; i < 68; i++) numbers[samples + i] = 0.125 * Math.min(i % 17, 16 - (i % 17));
numbers.fill(1 + 2 ** -20, majorants + 17, majorants + 19);
// Of the rays: a seed of 64 bits, pixels, samples, origins, directions, lengths, results.
words.set([6, 0], rays);
words.fill(2, rays + 2, rays + 10);
[0, 0.5, 0.5, 1, 0, 0, 16].forEach((x, i) => numbers.fill(x, rays + 18 + 8 * i, rays + 26 + 8 * i));
const results = numbers.subarray(rays + 74, rays + 82);

const paths = 4096;
let [sum, left] = [0, 0];
for (let sample = 0; sample < paths; sample += 8) {
  for (let lane = 0; lane < 8; lane++) words[rays + 10 + lane] = sample + lane;
  transmittances(begin, begin + 4 * rays);
  for (const weight of results) sum = Math.fround(sum + weight);
  flights(begin, begin + 4 * rays);
  left += results.filter((t) => t === Infinity).length;
}
numbers[255] = sum / paths;
const transmittance = words[255];
results.fill(0.25);
scatter(results.byteOffset, 0.5);
const cosine = results[3];
density(results.byteOffset, 0.5);
const checks = {
  "transmittance has the bits of the firmware": transmittance === 0x3e092bb3,
  "flights leave as often as e^-2 says": Math.abs(left / paths - Math.exp(-2)) < (4 * 0.3421) / 64,
  "scattering inverts its distribution": Math.abs(cosine - 0.25) < 1e-6,
  "and knows its density": Math.abs(results[3] - 0.75 / (4 * Math.PI)) < 1e-6,
  [`${code.length} bytes of ${limit}`]: code.length <= Number(limit),
};
for (const [what, holds] of Object.entries(checks)) console.log(holds ? "holds:" : "FAILED:", what);
process.exit(Object.values(checks).every(Boolean) ? 0 : 1);
