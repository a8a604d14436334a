// Whether the classifier uses marks: its setting `segments`, read again with each description of it that comes.

import { guarded } from "../guarded.js";
import { link } from "../link.js";

const CLASSIFIER = "som_classifier";
const callbacks = new Set();
let segments = null;      // null before it is known, or where it may not be read

export const marks = {
  get areOff() {
    return segments === "auto";
  },

  // Calls back with each change.
  on(callback) {
    callbacks.add(guarded(callback));
  },

  async turnOn() {
    take(await link.ask(CLASSIFIER, "set_parameters", { values: { segments: "both" } }));
  },
};

link.on("info", ({ service, commands }) => service === CLASSIFIER && commands.includes("parameters") && read());
addEventListener("hashchange", read);  // it may have been changed on the panel that is left

function read() {
  if (link.state.connected) link.ask(CLASSIFIER, "parameters").then(take, () => {});
}

function take({ parameters }) {
  const read = parameters.find(({ name }) => name === "segments")?.value ?? null;
  if (read === segments) return;
  segments = read;
  for (const callback of callbacks) callback();
}
