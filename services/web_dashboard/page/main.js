// The page: its panels, and one line that says whether all is well or what is waited for.

import { element } from "./elements.js";
import { link } from "./link.js";
import { live } from "./live/live.js";
import { models } from "./models/models.js";
import { parameters } from "./parameters/parameters.js";
import { takeNote } from "./takenote.js";
import { teach } from "./teach/teach.js";
import { waitedFor } from "./waiting.js";

// A panel has a name for the address, a title, and mount(section), which fills its section once. To add one, list it.
const PANELS = [live, teach, models, parameters];

const content = document.getElementById("content");
const state = document.getElementById("state");

function show(name) {
  const shown = PANELS.find((panel) => panel.name === name) ?? PANELS[0];
  for (const panel of PANELS) {
    document.getElementById(panel.name).hidden = panel !== shown;
    document.getElementById(`to-${panel.name}`)?.setAttribute("aria-current", panel === shown ? "page" : "false");
  }
  document.title = `actum · ${shown.title}`;
}

function build() {
  for (const panel of PANELS) {
    const section = element("section", { id: panel.name, "aria-label": panel.title, class: "panel" });
    content.append(section);
    panel.mount(section);
    if (PANELS.length > 1) {
      document.getElementById("panels").append(element("a", { id: `to-${panel.name}`, href: `#${panel.name}` }, panel.title));
    }
  }
  addEventListener("hashchange", () => show(location.hash.slice(1)));
  show(location.hash.slice(1));
}

function tellState() {
  const waiting = waitedFor();
  const text = waiting?.text ?? "live";
  if (state.textContent !== text) state.textContent = text;
  state.className = waiting?.kind ?? "well";
  for (const name of ["stale", "sensorless"]) document.body.classList.toggle(name, waiting?.stale === name);
}

build();
state.before(takeNote());
link.on("hello", ({ sensor }) => (document.getElementById("sensor").textContent = sensor));
link.on("state", tellState);
setInterval(tellState, 500);
tellState();
link.start();
