// A button that has the simulated person do what is recorded, where one takes requests.

import { button } from "../asking.js";
import { link } from "../link.js";
import { trainer } from "../trainer.js";
import { attempt, outcome } from "../asking.js";
import { element } from "../elements.js";

export function simulatedPerson() {
  const line = outcome();
  const perform = button("Have the simulated person do it", () => attempt(line, () => link.ask("sensor_gateway", "perform", wanted()), "on its way"));
  const whole = element("div", { class: "simulated", hidden: true }, perform, line);
  link.on("info", ({ service, commands }) => {
    if (service === "sensor_gateway") whole.hidden = !commands.includes("perform");
  });
  return whole;
}

function wanted() {
  const take = trainer.now?.recording;
  if (!take || take.phase === "done") throw new Error("No take is being recorded: press Record first");
  const { kind, label, asked, counted } = take;
  if (kind === "background") return { everyday_s: 30 };
  return { actions: Array(Math.max(asked - counted, 1)).fill(label), object_id: 1 };
}
