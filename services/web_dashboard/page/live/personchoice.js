// The choice of the person to show, where there are several.

import { element } from "../elements.js";
import { link } from "../link.js";
import { people, shownAgent } from "./people.js";

export function personChoice() {
  const who = element("select", { "aria-label": "Person to show" });
  let offered = "";
  who.addEventListener("change", () => (people.chosen = Number(who.value) || null));
  const offer = () => {
    if (String(people.present) === offered) return;
    offered = String(people.present);
    who.hidden = people.present.length < 2;
    who.replaceChildren(...people.present.map((agent) => element("option", { value: String(agent) }, `Person ${agent}`)));
    who.value = String(shownAgent());
  };
  link.on("skeleton", offer);
  offer();
  return who;
}
