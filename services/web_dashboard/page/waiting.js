// What the page waits for, in the order in which things are needed.

import { link } from "./link.js";

const STILL_MS = 2000;    // a sensor puts frames many times a second
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

// {kind, text}: what is missing; null where nothing is. Kind `trouble` means that nothing on the page is current.
export function waitedFor() {
  return unreached() ?? withoutSensor() ?? withoutService() ?? (people ? null : { kind: "idle", text: "live: nobody is in view" });
}

function unreached() {
  const { connected, silent, refused, router, connect } = link.state;
  if (refused === 401) return trouble("This page needs its token again: open it with ?token=…");
  if (!connected && performance.now() - began < 1000) return trouble("Connecting …");
  if (!connected) return trouble("Waiting for the page's service: is it running? Trying again …");
  if (silent) return trouble("Nothing comes any more: waiting for the network …");
  if (!router) return trouble(`Waiting for the router at ${connect}: 'actum up' starts one`);
  return null;
}

function withoutSensor() {
  if (link.silentMs("skeleton") < STILL_MS) return null;
  const { state } = (isThere("sensor_gateway") && statusOf("sensor_gateway")) || {};
  if (!state) return trouble("Waiting for a sensor: no gateway and no simulated scene runs");
  if (state.startsWith("camera lost") || state === "source ended") return trouble(`The sensor gives nothing: ${state}`);
  return trouble("Waiting for a skeleton from the sensor …");
}

function withoutService() {
  const missing = NEEDED.filter((service) => !isThere(service));
  if (missing.length) return { kind: "idle", text: `Waiting for ${missing.join(", ")}` };
  const { state } = statusOf("som_classifier") ?? {};
  if (state?.startsWith("no model")) return { kind: "idle", text: "The classifier has no model yet, so nothing is recognised" };
  return null;
}

function trouble(text) {
  return { kind: "trouble", text };
}
