// A line for panels that need the trainer, shown while it is silent.

import { element } from "./elements.js";
import { trainer } from "./trainer.js";

const LOOK_MS = 500;
const TEXT = "The service model_trainer does not answer. Start it with 'python -m model_trainer', or all services with 'actum up'.";

export function trainerMissing() {
  const line = element("p", { class: "missing wide", role: "status" });
  const look = () => {
    const text = trainer.isThere ? "" : TEXT;
    if (line.textContent !== text) line.textContent = text;
    line.hidden = !text;
  };
  setInterval(look, LOOK_MS);
  trainer.on(look);
  look();
  return line;
}
