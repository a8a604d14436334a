// The live panel: everything that goes on now, and what led to it.

import { acting } from "./acting.js";
import { courses } from "./courses.js";
import { explanation } from "./explanation.js";
import { health } from "./health.js";
import { maps } from "./maps.js";
import { neurons } from "./neurons.js";
import { now } from "./now.js";
import { picture } from "./picture.js";
import { scene } from "./scene.js";
import { markSwitch } from "./switch.js";
import { timeline } from "./timeline.js";

export const live = {
  name: "live",
  title: "Live",
  mount(section) {
    section.append(scene(), now(), picture(), neurons(), courses(), markSwitch(), acting(), timeline(), explanation(), ...maps(), health());
  },
};
