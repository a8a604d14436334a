// The last second or two of a stream, to find what belongs to the instant of an image.

import { link } from "../link.js";

const KEPT = 60;          // messages
const NEAR_NS = 50e6;     // a hand moves 5 cm in this time: what is further off would be drawn beside what it is of
const SILENT_MS = 1000;   // a stream that has stopped is not waited for

export class Moments {
  constructor(type) {
    Object.assign(this, { type, kept: [] });
    link.on(`each ${type}`, (message) => this.add(message));
  }

  add(message) {
    if (message.stamp_ns < this.kept[0]?.stamp_ns) this.kept = [];  // the sensor's clock began anew
    this.kept.unshift(message);
    this.kept.length = Math.min(this.kept.length, KEPT);
  }

  // The message whose stamp is nearest, null where none is near.
  at(stamp) {
    const apart = (message) => Math.abs(message.stamp_ns - stamp);
    const nearest = this.kept.reduce((one, other) => (one && apart(one) <= apart(other) ? one : other), null);
    return nearest && apart(nearest) <= NEAR_NS ? nearest : null;
  }

  // Whether nothing nearer to a stamp is to be expected.
  isComplete(stamp) {
    return link.silentMs(this.type) > SILENT_MS || (this.kept[0]?.stamp_ns >= stamp && this.at(stamp) !== null);
  }
}
