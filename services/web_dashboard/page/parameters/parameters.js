// The panel of parameters: each service's settings that may be changed while it runs.

import { attempt, button, outcome } from "../asking.js";
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
    const add = (service) => {
      none.hidden = true;
      services.set(service, new Service(service));
      const rank = (name) => (ORDER.includes(name) ? ORDER.indexOf(name) : ORDER.length);
      const sorted = [...services.keys()].sort((one, other) => rank(one) - rank(other));
      section.append(...sorted.map((name) => services.get(name).card));
    };
    link.on("info", ({ service, instance, commands }) => {
      if (!services.has(service) && commands.includes("set_parameters")) add(service);
      services.get(service)?.isThere(instance);
    });
    addEventListener("hashchange", () => location.hash === "#parameters" && services.forEach((each) => each.read()));
  },
};

class Service {
  constructor(name) {
    Object.assign(this, { name, instance: null, line: outcome(), list: element("div", { class: "parameters" }), rows: new Map() });
    const again = button("Read again", () => this.read(), { label: `Read the parameters of ${name} again`, kind: "small" });
    this.card = card(`parameters-${name}`, name, { controls: [again] }, this.line, this.list);
  }

  // Reads the parameters of a process that has not been read yet: the first, and each that is started in its place.
  isThere(instance) {
    if (instance === this.instance) return;
    this.instance = instance;
    this.read();
  }

  async read() {
    const reply = await attempt(this.line, () => link.ask(this.name, "parameters"));
    if (reply) this.show(reply);
    else this.instance = null;  // it is read again once it is heard of
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
