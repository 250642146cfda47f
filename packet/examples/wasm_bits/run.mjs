// Runs modules of this example: node run.mjs MODULE.wasm... Fails unless each repeats the hash at every width.
import { readFile } from "node:fs/promises";

let failed = false;
for (const file of process.argv.slice(2)) {
  const { instance } = await WebAssembly.instantiate(await readFile(file), {});
  const { expected, scalar, eight_lanes, sixteen_lanes } = instance.exports;
  const hex = (hash) => BigInt.asUintN(64, hash).toString(16).padStart(16, "0");
  for (const width of [scalar, eight_lanes, sixteen_lanes]) {
    const found = width();
    failed ||= found !== expected();
    console.log(hex(found), found === expected() ? "as expected" : `and not ${hex(expected())}`);
  }
}
process.exit(failed ? 1 : 0);
