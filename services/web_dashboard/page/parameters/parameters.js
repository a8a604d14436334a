// The panel of parameters: each service's settings that may be changed while it runs.

import { button, outcome, say } from "../asking.js";
import { card, element } from "../elements.js";
import { link } from "../link.js";
import { Parameter } from "./parameter.js";

const ORDER = ["sensor_gateway", "pose_preprocessor", "som_classifier", "marker_tracker", "action_fusion"];

export const parameters = {
  name: "parameters",
  title: "Parameters",
  mount(section) {
    const none = element("p", { class: "missing wide", role: "status" }, "No service with parameters has been seen yet.");
    const services = new Map();
    section.append(none);
    link.on("info", ({ service, commands }) => {
      if (services.has(service) || !commands.includes("set_parameters")) return;
      none.hidden = true;
      services.set(service, new Service(service));
      const rank = (name) => (ORDER.includes(name) ? ORDER.indexOf(name) : ORDER.length);
      const sorted = [...services.keys()].sort((one, other) => rank(one) - rank(other));
      section.append(...sorted.map((name) => services.get(name).card));
    });
    addEventListener("hashchange", () => location.hash === "#parameters" && services.forEach((each) => each.read()));
  },
};

class Service {
  constructor(name) {
    Object.assign(this, { name, line: outcome(), list: element("div", { class: "parameters" }), rows: new Map() });
    const again = button("Read again", () => this.read(), { label: `Read the parameters of ${name} again`, kind: "small" });
    this.card = card(`parameters-${name}`, name, { controls: [again] }, this.line, this.list);
    this.read();
  }

  async read() {
    try {
      this.show(await link.ask(this.name, "parameters"));
      say(this.line, "");
    } catch (error) {
      say(this.line, error.message, true);
    }
  }

  show({ parameters: told }) {
    for (const each of told) {
      if (!this.rows.has(each.name)) {
        this.rows.set(each.name, new Parameter(this.name, each, (value) => this.set(each.name, value)));
        this.list.append(this.rows.get(each.name).element);
      }
      this.rows.get(each.name).show(each);
    }
  }

  // Changes one parameter; what the service refuses is shown beside it.
  async set(name, value) {
    this.show(await link.ask(this.name, "set_parameters", { values: { [name]: value } }));
  }
}
