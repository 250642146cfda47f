// Threads that answer questions, each with a memory of its own: no shared memory, so no headers are needed.

class Thread {
  #waiting = new Map();
  #number = 0;
  #ended = "";
  #worker = new Worker(new URL("worker.js", import.meta.url), { type: "module" });

  constructor(module) {
    this.#worker.onmessage = ({ data }) => {
      const { resolve, reject } = this.#waiting.get(data.number);
      this.#waiting.delete(data.number);
      if (data.wrong === undefined) resolve(data);
      else reject(new Error(data.wrong));
    };
    this.#worker.onerror = (event) => this.end(event.message || "it does not start");
    this.ask({ ask: "begin", module }).catch(() => {}); // what follows fails, too
  }

  ask(question) {
    if (this.#ended) return Promise.reject(new Error(this.#ended));
    return new Promise((resolve, reject) => {
      this.#waiting.set(++this.#number, { resolve, reject });
      this.#worker.postMessage({ ...question, number: this.#number });
    });
  }

  // Questions that it has not answered.
  get asked() {
    return this.#waiting.size;
  }

  end(why) {
    this.#worker.terminate();
    this.#ended = why;
    const waiting = [...this.#waiting.values()];
    this.#waiting.clear();
    for (const { reject } of waiting) reject(new Error(why));
  }
}

export class Pool {
  #all;
  #loads = 0;
  // Those that have the volume.
  threads = [];

  constructor(module, count) {
    this.#all = Array.from({ length: count }, () => new Thread(module));
  }

  get count() {
    return this.threads.length;
  }

  // Gives the threads a volume, as many as have memory for it; `kind` as the engine counts them, `file` its bytes. Gives what it is, or
  // nothing if another volume was asked for meanwhile. Where it cannot be had threads keep theirs, and what is wrong is thrown.
  async load(kind, file) {
    const mine = ++this.#loads;
    const question = { ask: "prepare", kind, file };
    const [first, ...others] = this.#all;
    if (!first) throw new Error("no thread is left; load the page again");
    const { text, bytes } = await first.ask(question).catch((error) => {
      if (mine === this.#loads) throw error;
      return {};
    });
    if (mine !== this.#loads) return undefined;
    // Copies for half of the memory there is, as far as browsers tell.
    const room = ((navigator.deviceMemory ?? 4) * 2 ** 30) / 2;
    const further = others.slice(0, Math.max(0, Math.floor(room / bytes) - 1));
    const found = await Promise.allSettled(further.map((thread) => thread.ask(question)));
    if (mine !== this.#loads) return undefined;
    this.threads = [first, ...further.filter((_, i) => found[i].status === "fulfilled")];
    for (const thread of this.threads) thread.ask({ ask: "use" }).catch(() => {});
    return text;
  }

  // A thread that did not answer is not asked again.
  drop(thread, why) {
    thread.end(why);
    this.#all = this.#all.filter((other) => other !== thread);
    this.threads = this.threads.filter((other) => other !== thread);
  }
}
