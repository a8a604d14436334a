// The panel of models: trained and tested on a set, compared, put into use and back.

import { trainerMissing } from "../missing.js";
import { modelList } from "./modellist.js";
import { setList } from "./setlist.js";
import { testing } from "./testing.js";
import { training } from "./training.js";

export const models = {
  name: "models",
  title: "Models",
  mount(section) {
    section.append(trainerMissing(), training(), testing(), modelList(), setList());
  },
};
