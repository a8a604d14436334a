// The take that is being recorded, in the page's head: on every panel, with the way back to it.

import { element, seconds } from "./elements.js";
import { trainer } from "./trainer.js";

const LOOK_MS = 1000;

export function takeNote() {
  const note = element("a", { id: "take-note", href: "#teach", hidden: true });
  const look = () => {
    const take = trainer.now?.recording;
    const isGoing = trainer.isThere && Boolean(take) && take.phase !== "done";
    note.hidden = !isGoing;
    if (isGoing) note.textContent = wording(take);
  };
  trainer.on(look);
  setInterval(look, LOOK_MS);  // a trainer that has ended says nothing
  return note;
}

function wording({ kind, label, person, asked, counted, seconds: lasted, set }) {
  const what = kind === "background" ? `background, ${seconds(lasted)}` : `${label}, ${counted} of ${asked}`;
  return `Recording ${what}${person && ` by ${person}`} into ${set}`;
}
