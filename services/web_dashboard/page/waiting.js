// What the page waits for, in the order in which things are needed.

import { link } from "./link.js";

const STILL_MS = 2000;    // a sensor publishes frames many times a second
const GONE_S = 3.5;       // services report each second
const NEEDED = ["pose_preprocessor", "som_classifier", "marker_tracker", "action_fusion"];

const status = new Map();
const began = performance.now();
let people = 0;

link.on("status", (message) => status.set(message.service, message));
link.on("skeleton", ({ agents }) => (people = agents.length));

// Whether a service reports now.
export function isThere(service) {
  return (link.state.silentS[`status/${service}`] ?? Infinity) < GONE_S;
}

export function statusOf(service) {
  return status.get(service);
}

// Whether the sensor publishes no frames now.
export function isSensorStill() {
  return link.silentMs("skeleton") > STILL_MS;
}

// {kind, text, stale}: what is missing; null where nothing is. `stale` says what is not current: everything on the page
// (`stale`), or only what shows the sensor's frames (`sensorless`).
export function waitedFor() {
  return unreached() ?? withoutSensor() ?? withoutService() ?? (people ? null : { kind: "idle", text: "live: nobody is in view" });
}

function unreached() {
  const { connected, silent, refused, router, connect } = link.state;
  if (refused === 401) return trouble("The page needs its token: add ?token=… with ACTUM_PAGE_TOKEN to its address");
  if (!connected && performance.now() - began < 1000) return trouble("Connecting …");
  if (!connected) return trouble("Waiting for web_dashboard, which serves this page: start it. Trying again …");
  if (silent) return trouble("No data has arrived for a while. Check the network; the page goes on waiting …");
  if (!router) return trouble(`Waiting for the router at ${connect}: start one with 'actum router' or 'actum up'`);
  return null;
}

function withoutSensor() {
  if (!isSensorStill()) return null;
  const { state } = (isThere("sensor_gateway") && statusOf("sensor_gateway")) || {};
  if (!state) return trouble("Waiting for a sensor: start sensor_gateway or scene_simulator", "sensorless");
  if (state === "source ended") return trouble("The video or recording has ended. Teaching from videos and training still work", "sensorless");
  if (state.startsWith("camera lost")) return trouble(`The sensor publishes nothing: ${state}`, "sensorless");
  return trouble("Waiting for a skeleton from the sensor …", "sensorless");
}

function withoutService() {
  const missing = NEEDED.filter((service) => !isThere(service));
  if (missing.length) return { kind: "idle", text: `Waiting for ${missing.join(", ")}` };
  const { state } = statusOf("som_classifier") ?? {};
  if (state?.startsWith("no model")) return { kind: "idle", text: "The classifier has no model, so nothing is recognised: train one" };
  return null;
}

function trouble(text, stale = "stale") {
  return { kind: "trouble", text, stale };
}
