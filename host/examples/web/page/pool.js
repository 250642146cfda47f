// Threads that answer questions, each with a memory of its own: no shared memory, so no headers are needed.

class Thread {
  #asked = new Map();
  #number = 0;

  constructor() {
    this.worker = new Worker(new URL("worker.js", import.meta.url), { type: "module" });
    this.worker.onmessage = ({ data }) => {
      const asked = this.#asked.get(data.number);
      this.#asked.delete(data.number);
      if (data.wrong === undefined) return asked.resolve(data);
      asked.reject(Object.assign(new Error(data.wrong), { fatal: data.fatal }));
    };
    this.worker.onerror = (event) => {
      for (const asked of this.#asked.values()) asked.reject(new Error(event.message || "a thread does not start"));
      this.#asked.clear();
    };
  }

  ask(question, lent = []) {
    return new Promise((resolve, reject) => {
      this.#asked.set(++this.#number, { resolve, reject });
      this.worker.postMessage({ ...question, number: this.#number }, lent);
    });
  }

  get idle() {
    return this.#asked.size;
  }
}

export class Pool {
  #module;
  #count;

  constructor(module, count) {
    this.#module = module;
    this.#count = count;
    this.threads = [];
  }

  get count() {
    return this.threads.length;
  }

  // Gives all threads the same volume; where it cannot be had they keep theirs, and what is wrong is thrown.
  //
  // `kind`: as the engine counts them; `file`: its bytes.
  async load(kind, file) {
    const made = await this.#made(1, kind, file);
    const rest = await this.#made(this.#count - 1, kind, file).catch(() => ({ threads: [] })); // memory may be enough for one only
    for (const thread of this.threads) thread.worker.terminate();
    this.threads = [...made.threads, ...rest.threads];
    return made.text;
  }

  // New threads with a volume: what the old ones held is given back whole.
  async #made(count, kind, file) {
    const threads = Array.from({ length: count }, () => new Thread());
    try {
      const texts = await Promise.all(
        threads.map(async (thread) => {
          await thread.ask({ ask: "begin", module: this.#module });
          const { text } = await thread.ask({ ask: "load", kind, file });
          return text;
        }),
      );
      return { threads, text: texts[0] };
    } catch (error) {
      for (const thread of threads) thread.worker.terminate();
      throw error;
    }
  }
}
