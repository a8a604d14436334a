// The choice of a set, the same on all panels.

import { element } from "./elements.js";
import { trainer } from "./trainer.js";

export function setChoice() {
  const choice = element("select");
  choice.addEventListener("change", () => trainer.choose(choice.value));
  trainer.on(() => {
    const names = (trainer.all?.sets ?? []).map((set) => set.name);
    if (names.join("/") !== choice.dataset.names) {
      choice.dataset.names = names.join("/");
      choice.replaceChildren(...(names.length ? names : [""]).map((text) => element("option", { value: text }, text || "none yet")));
    }
    choice.value = trainer.set?.name ?? "";
  });
  return choice;
}
