// What is expected: where people will be, and the ways of hands and objects; all in the camera's frame (m).

import { JOINT } from "../body.js";
import { link } from "../link.js";
import { LEAST } from "./ahead.js";

const AHEAD_S = 0.5;
const LATE_NS = 0.3e9;      // the newest message of a person is older where they stand, or where nobody puts any
const SLOWEST_MPS = 0.1;    // an object at rest seems to move because its sightings are not exact
const MOST_PEOPLE = 64;     // people come with ever new numbers

const newest = { continuation: new Map(), intent: new Map() };

for (const [type, of] of Object.entries(newest)) {
  link.on(type, (message) => {
    if (of.size > MOST_PEOPLE) of.clear();
    of.set(message.agent, message);
  });
}

export const NOTHING = Object.freeze({ bodies: [], ways: [] });

// What is expected of the people in a skeleton message and of objects: bodies of fifteen joints, and ways [from, to].
export function expected(skeleton, objects) {
  return { bodies: bodiesAhead(skeleton), ways: [...waysOfHands(skeleton), ...waysOfObjects(objects)] };
}

// The joints of each person of a skeleton message who moves, as they are expected after AHEAD_S.
export function bodiesAhead(skeleton, continuations = newest.continuation) {
  const moving = skeleton.agents.map(({ agent }) => continuations.get(agent)).filter((message) => isCurrent(skeleton, message));
  return moving.flatMap(({ ahead }) => ahead.filter(({ ahead_s: seconds }) => seconds === AHEAD_S).map(({ joints_m: joints }) => joints));
}

// The ways [from, to] of hands to the place where they will touch the likeliest object, of the people in a skeleton message.
export function waysOfHands(skeleton, intents = newest.intent) {
  return skeleton.agents.flatMap(({ agent, joints }) => {
    const intent = intents.get(agent);
    const likeliest = isCurrent(skeleton, intent) ? intent.intended.find(({ soon_probability: soon }) => soon >= LEAST) : undefined;
    if (!likeliest) return [];
    const hand = joints[likeliest.hand === "left" ? JOINT.leftHand : JOINT.rightHand];
    return hand ? [[hand, likeliest.place_m]] : [];
  });
}

// The ways [from, to] of moving objects in AHEAD_S, if they go on at their speed.
export function waysOfObjects(objects) {
  const moving = objects.filter((object) => isFollowed(object) && Math.hypot(...(object.velocity_mps ?? [])) >= SLOWEST_MPS);
  return moving.map(({ position_m: from, velocity_mps: velocity }) => [from, from.map((value, axis) => value + AHEAD_S * velocity[axis])]);
}

function isFollowed({ seen, predicted, followed }) {
  return seen || predicted || followed;
}

function isCurrent({ stamp_ns: now, session_id: session }, message) {
  return message !== undefined && message.session_id === session && Math.abs(now - message.stamp_ns) <= LATE_NS;
}
