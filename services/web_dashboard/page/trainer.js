// The trainer as the page knows it: what it does now, which sets and models there are, and which set is chosen.

import { guarded } from "./guarded.js";
import { link } from "./link.js";

const SILENT_MS = 3500;   // it publishes its state each second

class Trainer {
  constructor() {
    // now: its newest `training` message; all: its newest list of sets and models; both null before the first.
    Object.assign(this, { now: null, all: null, chosen: null, callbacks: new Set(), choosing: new Set(), listing: null });
    link.on("training", (training) => this.take(training));
  }

  // Calls back with each change of its state, of the list, or of the choice.
  on(callback) {
    this.callbacks.add(guarded(callback));
  }

  // Calls back when another set is shown: what was said of the one before no longer holds.
  onChoice(callback) {
    this.choosing.add(guarded(callback));
  }

  ask(command, fields = {}) {
    return link.ask("model_trainer", command, fields);
  }

  get isThere() {
    return link.silentMs("training") < SILENT_MS;
  }

  // The chosen set as it is listed; the newest one where the chosen one is gone; null without any.
  get set() {
    const sets = this.all?.sets ?? [];
    const newest = sets.reduce((one, other) => (one && one.created >= other.created ? one : other), null);
    return sets.find(({ name }) => name === this.chosen) ?? newest;
  }

  choose(name) {
    this.chosen = name;
    this.tell();
  }

  take(training) {
    this.now = training;
    if (training.revision !== this.all?.revision) this.list();
    this.tell();
  }

  // Chooses a set that has just been created or renamed, once it is listed.
  async chooseNew(name) {
    await this.listAnew();
    this.choose(name);
  }

  async listAnew() {
    await this.listing;  // which may have been asked for before
    await this.list();
  }

  // Lists sets and models anew; where that fails, the next message has it asked again.
  list() {
    this.listing ??= this.ask("list")
      .then((all) => (this.all = all), () => {})
      .then(() => {
        this.listing = null;
        this.tell();
      });
    return this.listing;
  }

  tell() {
    const shown = this.set?.name ?? null;
    const isOther = this.shown !== undefined && this.shown !== shown;
    if (this.all) this.shown = shown;
    if (isOther) for (const callback of this.choosing) callback();
    for (const callback of this.callbacks) callback();
  }
}

export const trainer = new Trainer();
