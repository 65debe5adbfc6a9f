// The connection to Python: messages of one kind each, the last value wins, and it comes back by itself.

const AGAIN = [200, 500, 1000, 2000]; // milliseconds between two tries; the last repeats
const PATIENCE = 20000; // milliseconds until a question without an answer is given up

export class Link {
  /** @param {function(string, *): void} take what is done with a message; @param {function(boolean): void} tell whether connected */
  constructor(take, tell) {
    Object.assign(this, { take, tell, socket: null, tries: 0, waiting: new Map(), asked: new Map(), number: 0 });
    this.connect();
  }

  get open() {
    return this.socket !== null && this.socket.readyState === WebSocket.OPEN;
  }

  connect() {
    const { host, search } = window.location;
    this.socket = new WebSocket(`ws://${host}/live${search}`);
    this.socket.addEventListener("open", () => {
      this.tries = 0;
      this.tell(true);
    });
    this.socket.addEventListener("message", ({ data }) => this.receive(JSON.parse(data)));
    this.socket.addEventListener("close", () => this.lost());
  }

  lost() {
    this.tell(false);
    this.waiting.clear();
    this.asked.forEach(({ fail }) => fail(new Error("not connected")));
    this.asked.clear();
    const wait = AGAIN[Math.min(this.tries, AGAIN.length - 1)];
    this.tries += 1;
    window.setTimeout(() => this.connect(), wait);
  }

  receive(message) {
    const [[kind, content]] = Object.entries(message);
    if (kind !== "answer") {
      this.take(kind, content);
      return;
    }
    const asked = this.asked.get(content.id);
    this.asked.delete(content.id);
    if (asked) asked.done(content);
  }

  /** Send a message at once; not connected, it is dropped. */
  send(kind, content = null) {
    if (this.open) this.socket.send(JSON.stringify({ [kind]: content }));
  }

  /** Send the newest value of a kind with the next picture, as soon as what was sent before is on its way. */
  post(kind, content) {
    const idle = this.waiting.size === 0;
    this.waiting.set(kind, content);
    if (idle) window.setTimeout(() => this.flush(), 0);
  }

  flush() {
    if (!this.open) return;
    if (this.socket.bufferedAmount > 0) {
      window.setTimeout(() => this.flush(), 5);
      return;
    }
    this.waiting.forEach((content, kind) => this.send(kind, content));
    this.waiting.clear();
  }

  /** Ask a question; the promise fails where nobody answers. */
  ask(question) {
    return new Promise((done, fail) => {
      if (!this.open) {
        fail(new Error("not connected"));
        return;
      }
      this.number += 1;
      const id = this.number;
      this.asked.set(id, { done, fail });
      this.send("ask", { id, ...question });
      window.setTimeout(() => {
        if (this.asked.delete(id)) fail(new Error("no answer"));
      }, PATIENCE);
    });
  }
}
