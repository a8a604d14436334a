// The one module that knows the WebSocket: messages come by `on`, commands go by `ask`, marks by `mark`.

import { guarded } from "./guarded.js";

const SILENT_MS = 2500;       // the service pulses twice a second
const GIVEN_UP_MS = 6000;     // a network that is gone leaves the socket open and silent: it is opened anew
const RETRY_MS = [300, 700, 1500, 3000];
const WATCH_MS = 500;
const ANSWER_MS = 60_000;     // the page's service gives up a service after 11 s, and asks eight at a time
const QUEUED = new Set(["segment", "event", "held_back", "training", "info", "hello", "pulse"]);

class Link {
  constructor() {
    // connected: the socket is open; silent: nothing has come for a while; router: whether the service has one;
    // hello: the service's greeting; silentS: seconds since the last message of each service's status.
    this.state = { connected: false, silent: false, refused: null, router: false, connect: "", hello: null, silentS: {} };
    this.callbacks = new Map();
    this.answers = new Map();
    this.newest = new Map();
    this.cameAt = new Map();
    this.number = 0;
    this.tries = 0;
    this.drawing = false;
    this.watchedAt = this.heardAt = performance.now();
  }

  start() {
    this.open();
    setInterval(() => this.watch(), WATCH_MS);
    addEventListener("online", () => this.reopen());
  }

  // Calls back with each message of a type, such as "skeleton" or "event"; "state" with each change of the link's state,
  // "frame" once for each drawn frame in which something came. Of a stream only the newest message of each drawn frame is
  // passed on; "each skeleton" calls back with every one as it arrives. Returns a function that ends it.
  on(type, callback) {
    const kept = guarded(callback);
    if (!this.callbacks.has(type)) this.callbacks.set(type, new Set());
    this.callbacks.get(type).add(kept);
    return () => this.callbacks.get(type).delete(kept);
  }

  // Asks a service to carry out a command; resolves to its reply, rejects with an Error: `refused` is true where the
  // service itself refused, false where nobody knows what became of it. Every order settles, within ANSWER_MS at most.
  ask(service, command, fields = {}) {
    return this.order({ ask: { service, command, fields } });
  }

  // Puts a start or end mark: {kind, segment_id, agent}.
  mark(mark) {
    return this.order({ mark });
  }

  order(order) {
    if (!this.state.connected) return Promise.reject(new Error("the page has no connection to web_dashboard, so nothing was sent"));
    const id = ++this.number;
    const text = JSON.stringify({ id, ...order });
    const most = this.state.hello?.longest_order_bytes ?? Infinity;
    if (new Blob([text]).size >= most) return Promise.reject(new Error(`the message is too long: at most ${most} bytes can be sent`));
    return new Promise((resolve, reject) => {
      this.answers.set(id, { resolve, reject, sentAt: performance.now() });
      this.socket.send(text);
    });
  }

  // For how long nothing of a type has come (ms), drawn or not; Infinity before the first.
  silentMs(type) {
    return performance.now() - (this.cameAt.get(type) ?? -Infinity);
  }

  open() {
    const socket = (this.socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/ws`));
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      this.tries = 0;
      this.heardAt = performance.now();
      this.change({ connected: true, silent: false, refused: null });
    };
    socket.onmessage = ({ data }) => {
      this.heardAt = performance.now();
      if (typeof data === "string") for (const line of data.split("\n")) this.take(JSON.parse(line));
      else this.take(pictureOf(data));
    };
    socket.onclose = () => socket === this.socket && this.lost();
  }

  lost() {
    this.leave();
    this.retry = setTimeout(() => this.reopen(), RETRY_MS[Math.min(this.tries++, RETRY_MS.length - 1)]);
    this.findRefusal();
  }

  // A socket does not say why it was refused; a request does.
  async findRefusal() {
    try {
      const { ok, status } = await fetch("/", { cache: "no-store" });
      this.change({ refused: ok ? null : status });
    } catch {
      this.change({ refused: null });
    }
  }

  reopen() {
    this.leave();
    this.open();
  }

  // Leaves the socket, and with it the orders that nobody answers any more.
  leave() {
    clearTimeout(this.retry);
    this.socket.onclose = null;
    this.socket.close();
    this.rejectAll("the connection was lost before the answer arrived");
    this.change({ connected: false, router: false });
  }

  watch() {
    const now = performance.now();
    const slept = now - this.watchedAt > 3 * WATCH_MS;  // the tab was stalled: what came meanwhile is not yet read
    this.watchedAt = now;
    if (slept || !this.state.connected) return;
    for (const [id, { sentAt }] of this.answers) {
      if (now - sentAt > ANSWER_MS) this.answer({ id, error: `no answer came within ${ANSWER_MS / 1000} s: see 'actum doctor'` });
    }
    if (now - this.heardAt > GIVEN_UP_MS) this.reopen();
    else this.change({ silent: now - this.heardAt > SILENT_MS });
  }

  // Tells what must not be lost at once; of streams only the newest, once for each frame that is drawn.
  take(message) {
    if (message.type === undefined) return this.answer(message);
    if (message.type === "hello") this.change({ hello: message });
    if (message.type === "pulse") {
      const { router, connect, silent_s: silentS } = message;
      this.change({ router, connect, silentS, silent: false });
    }
    this.cameAt.set(message.type, performance.now());
    this.tell(`each ${message.type}`, message);
    if (QUEUED.has(message.type) || message.final) return this.tell(message.type, message);
    this.newest.set(`${message.type}/${message.agent ?? message.service ?? ""}`, message);
    if (!this.drawing) {
      this.drawing = true;
      requestAnimationFrame(() => this.draw());
    }
  }

  draw() {
    this.drawing = false;
    const messages = [...this.newest.values()];
    this.newest.clear();
    for (const message of messages) this.tell(message.type, message);
    this.tell("frame");
  }

  answer({ id, reply, error, refused = false }) {
    if (id === null) return this.rejectAll(error);  // which one was refused is not known
    const waiting = this.answers.get(id);
    this.answers.delete(id);
    if (error === undefined) waiting?.resolve(reply);
    else waiting?.reject(Object.assign(new Error(error), { refused }));
  }

  rejectAll(text) {
    for (const id of [...this.answers.keys()]) this.answer({ id, error: text });
  }

  change(changes) {
    const before = JSON.stringify(this.state);
    Object.assign(this.state, changes);
    if (JSON.stringify(this.state) !== before) this.tell("state", this.state);
  }

  tell(type, message) {
    for (const callback of this.callbacks.get(type) ?? []) callback(message);
  }
}

// Reads an image: the length of its JSON header (4 bytes), the header, the picture's bytes.
function pictureOf(buffer) {
  const length = new DataView(buffer).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  return { ...header, data: new Uint8Array(buffer, 4 + length) };
}

export const link = new Link();
