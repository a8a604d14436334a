// What the simulated person is to do, where one takes requests: an action, or everyday movements.

import { attempt, button, counted, field, outcome } from "../asking.js";
import { card, element } from "../elements.js";
import { link } from "../link.js";

const GATEWAY = "sensor_gateway";
const EVERYDAY_S = 20;
const MOST = 20;          // repetitions

export function acting() {
  const action = element("select");
  const count = element("input", { type: "number", min: "1", max: String(MOST), value: "1" });
  const line = outcome();
  const ask = (fields, done) => attempt(line, () => link.ask(GATEWAY, "perform", fields), done);
  const act = (event) => {
    event.preventDefault();
    const [label, times] = [action.value, Number(count.value)];
    ask({ actions: Array(times).fill(label) }, `Requested: ${label}, ${counted(times, "time")}.`);
  };
  const everyday = button("Everyday movements", () => ask({ everyday_s: EVERYDAY_S }, `Requested: ${EVERYDAY_S} s of everyday movements.`));
  const form = element("form", { class: "row", on: { submit: act } },
    field("What to do", action), field("How often", count), element("button", { class: "primary" }, "Do it"), everyday);
  const made = card("acting", "Simulated person", { wide: true }, form, line);
  made.hidden = true;
  offer(made, action);
  return made;
}

// Lists the actions of each simulated scene that is started; hidden without one that takes requests.
function offer(made, action) {
  let known = null;
  link.on("info", async ({ service, instance, commands }) => {
    if (service !== GATEWAY) return;
    made.hidden = !commands.includes("repertoire");
    if (made.hidden || instance === known) return;
    known = instance;
    const { actions } = await link.ask(GATEWAY, "repertoire").catch(() => ({ actions: [] }));
    if (!actions.length) known = null;  // it is asked again with its next description
    action.replaceChildren(...actions.map((name) => element("option", { value: name }, name)));
  });
}
