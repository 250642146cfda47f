// A picture that grows better: asks threads for samples, sums them up, shows what there is.

// Pixels are so much larger while something moves.
export const COARSE = 4;
const MOVING = 250; // milliseconds after the last change
const QUEUED = 2; // questions a thread has, so that it never waits for the page
const SECONDS_A_QUESTION = 0.03;
const SHOWN_EVERY = 100; // milliseconds

export class Picture {
  #canvas;
  #context;
  #engine;
  #pool;
  #asked; // controls, for coarse pixels or fine ones
  #report;
  #run;
  #again = false;
  #timer = 0;
  #shownAt = 0;
  #pausedAt = 0;
  paused = false;

  // `controls(coarse)`: what to trace. `report`: is told `numbers` of what is shown, and what is `wrong`.
  constructor(canvas, engine, pool, controls, report) {
    this.#canvas = canvas;
    this.#context = canvas.getContext("2d", { willReadFrequently: true }); // written by the CPU
    this.#engine = engine;
    this.#pool = pool;
    this.#asked = controls;
    this.#report = report;
    requestAnimationFrame(() => this.#show());
  }

  get controls() {
    return this.#run.controls;
  }

  // Begins anew with another volume, or size.
  begin() {
    clearTimeout(this.#timer);
    this.#begin(false);
  }

  // Begins anew with other controls: coarse until they stand still. What was begun is shown first, or nothing ever would be.
  change() {
    if (this.#run?.coarse && this.#run.shown === 0 && !this.paused) this.#again = true;
    else this.#begin(true);
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.#begin(false), MOVING);
  }

  set stop(samples) {
    this.#run.controls.stop = samples;
    this.#feed();
  }

  pause(paused) {
    if (paused) this.#pausedAt = performance.now();
    else if (this.paused) this.#run.begun += performance.now() - this.#pausedAt;
    this.paused = paused;
    this.#feed();
  }

  #begin(coarse) {
    if (this.#pool.count === 0) return;
    this.#again = false;
    this.paused = false;
    const controls = this.#asked(coarse);
    this.#run = {
      controls,
      coarse,
      // The next question.
      row: 0,
      sample: 0,
      // Samples that all pixels have, those shown, and rows that lack each of the next ones.
      whole: 0,
      shown: 0,
      lacking: new Map(),
      begun: performance.now(),
      paths: 0,
      busy: 0,
    };
    this.#engine.controls = controls;
    this.#engine.newFilm();
    this.#canvas.dataset.samples = 0;
    this.#feed();
  }

  // A question for a thread, until there is no more.
  #next() {
    const run = this.#run;
    if (this.paused || run.sample >= run.controls.stop) return undefined;
    const { width, height } = run.controls;
    const rate = run.busy > 0 ? run.paths / run.busy : 2e5;
    const rows = Math.max(1, Math.min(height - run.row, Math.round((rate * SECONDS_A_QUESTION) / width)));
    const question = { ask: "trace", controls: run.controls, first: run.row, end: run.row + rows, sample: run.sample };
    run.row += rows;
    if (run.row >= height) [run.row, run.sample] = [0, run.sample + 1];
    return question;
  }

  #feed() {
    for (const thread of this.#pool.threads) {
      while (thread.asked < QUEUED) {
        const question = this.#next();
        if (!question) return;
        this.#answer(thread, question, this.#run);
      }
    }
  }

  async #answer(thread, { first, end, sample, ...question }, run) {
    let answer;
    try {
      answer = await thread.ask({ ...question, first, end, sample });
    } catch (error) {
      this.#pool.drop(thread, error.message);
      this.#report.wrong(`A thread has stopped: ${error.message}.`);
      // Its rows are nobody's now.
      if (run === this.#run) this.#begin(run.coarse);
      return;
    }
    if (run === this.#run) {
      this.#engine.expose(first, answer.radiance);
      run.paths += answer.radiance.length / 3;
      run.busy += answer.seconds;
      const lacking = run.lacking.get(sample) ?? run.controls.height;
      run.lacking.set(sample, lacking - (end - first));
      while (run.lacking.get(run.whole) === 0) run.lacking.delete(run.whole++);
    }
    this.#feed();
  }

  #show() {
    requestAnimationFrame(() => this.#show());
    const run = this.#run;
    // Before all pixels have a sample some would be black.
    if (!run || run.whole === run.shown) return;
    const now = performance.now();
    const { width, height, stop } = run.controls;
    if (now - this.#shownAt < (run.coarse ? 0 : SHOWN_EVERY) && run.whole < stop) return;
    this.#shownAt = now;
    run.shown = run.whole;
    const canvas = this.#canvas;
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    this.#context.putImageData(this.#engine.picture(), 0, 0);
    const { noise, mean } = this.#engine;
    this.#report.numbers({ samples: run.whole, rate: (1000 * run.paths) / (now - run.begun), noise });
    canvas.dataset.mean = mean;
    canvas.dataset.samples = run.coarse ? 0 : run.whole;
    if (this.#again) this.#begin(true);
  }
}
