// An instance of the engine, and what it takes and gives.

// The order of `Controls` in view.rs: whole numbers, then floats.
const WHOLE = ["width", "height", "packets", "estimator"];
const FLOATS = ["turn", "height_angle", "distance", "density", "g", "albedo", "sun_turn", "sun_height", "sun", "sky"];

export class Engine {
  constructor(instance) {
    this.calls = instance.exports;
  }

  // Pointers come as signed numbers: `>>> 0` makes them places.
  get #buffer() {
    return this.calls.memory.buffer; // another one whenever memory grows
  }

  // Of its memory.
  get bytes() {
    return this.#buffer.byteLength;
  }

  set controls(values) {
    const at = this.calls.controls() >>> 0;
    new Uint32Array(this.#buffer, at, WHOLE.length).set(WHOLE.map((name) => values[name]));
    new Float32Array(this.#buffer, at + 4 * WHOLE.length, FLOATS.length).set(FLOATS.map((name) => values[name]));
    this.width = values.width;
    this.height = values.height;
  }

  // Asking for room may move the memory: its place is known before the view is made.
  #write(at, bytes) {
    new Uint8Array(this.#buffer, at, bytes.byteLength).set(new Uint8Array(bytes));
  }

  // Takes a cloud (0), a ball of fog (1), the bytes of a file (2). Gives what it is; throws what is wrong.
  load(kind, file) {
    if (file) this.#write(this.calls.room(file.byteLength) >>> 0, file);
    const loaded = this.calls.load(kind);
    const [at, length] = [this.calls.message() >>> 0, this.calls.message_length()];
    const text = new TextDecoder().decode(new Uint8Array(this.#buffer, at, length));
    if (!loaded) throw new Error(text);
    return text;
  }

  // Radiance of a sample of each pixel of some rows.
  trace(first, end, sample) {
    const at = this.calls.trace(first, end, sample) >>> 0;
    return new Float32Array(this.#buffer, at, 3 * this.width * (end - first)).slice();
  }

  // The scene in the language of the program.
  describe() {
    const length = this.calls.describe();
    return new Uint8Array(this.#buffer, this.calls.bytes() >>> 0, length).slice();
  }

  newFilm() {
    this.pictureAt = this.calls.film() >>> 0;
  }

  expose(first, radiance) {
    const rows = radiance.length / (3 * this.width);
    const at = this.calls.rows(rows) >>> 0;
    new Float32Array(this.#buffer, at, radiance.length).set(radiance);
    this.calls.expose(first);
  }

  // Standard error of a pixel over what it shows, and the mean of all pixels.
  get noise() {
    return this.calls.noise();
  }

  get mean() {
    return this.calls.mean();
  }

  picture() {
    this.calls.develop();
    const bytes = new Uint8ClampedArray(this.#buffer, this.pictureAt, 4 * this.width * this.height);
    return new ImageData(bytes.slice(), this.width, this.height);
  }
}
