// The panel in which somebody teaches: a set, takes that are recorded or read from videos, and their examples.

import { element } from "../elements.js";
import { trainerMissing } from "../missing.js";
import { examples } from "./examples.js";
import { recording } from "./recording.js";
import { sets } from "./sets.js";
import { video } from "./video.js";

export const teach = {
  name: "teach",
  title: "Teach",
  mount(section) {
    const take = recording();
    section.append(trainerMissing(), sets(), take.card, video(take.form), examples());
  },
};
