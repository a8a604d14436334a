// A line for panels that need the trainer, shown while it is silent.

import { element } from "./elements.js";
import { trainer } from "./trainer.js";

const LOOK_MS = 500;
const TEXT = "The trainer does not answer. Is model_trainer running? 'actum up' starts all services, 'python -m actum_model_trainer' only this one.";

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
