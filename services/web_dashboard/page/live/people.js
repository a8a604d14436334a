// Who is there, whom the panel shows, and the sensor's clock.

import { link } from "../link.js";

const MOST_PEOPLE = 64;     // people come with ever new numbers
const NEWEST = new Map();
let skeleton = { agents: [], stamp_ns: 0 };
let cameAt = 0;

// chosen: the number of the person to show, null for whoever comes first.
export const people = { present: [], chosen: null };

link.on("skeleton", (message) => {
  skeleton = message;
  cameAt = performance.now();
  people.present = message.agents.map(({ agent }) => agent);
});
link.on("posture", (message) => {
  if (NEWEST.size > MOST_PEOPLE) NEWEST.clear();
  NEWEST.set(message.agent, message);
});

export function shownAgent() {
  return people.present.includes(people.chosen) ? people.chosen : (people.present[0] ?? people.chosen);
}

// Whether what an agent does is shown: also before anybody is known to be there.
export function isShown(agent) {
  return agent === (shownAgent() ?? agent);
}

export function newestSkeleton() {
  return skeleton;
}

export function newestPosture(agent) {
  return NEWEST.get(agent);
}

// The stamp that a frame captured now would have (ns), told from the newest one; 0 before the first.
export function nowNs() {
  const goneOn = Math.min(performance.now() - cameAt, 1000);
  return skeleton.stamp_ns && skeleton.stamp_ns + goneOn * 1e6;
}
