// What is remembered of each segment: its marks, its early answers, its final action, its event; and of what was held back.

import { guarded } from "../guarded.js";
import { link } from "../link.js";

const MOST = 300;          // segments
const MOST_HELD = 100;     // of these, what was held back: it takes no room from events
const MOST_EARLY = 900;    // early answers of one segment: half a minute at 30 Hz
const segments = new Map();
const callbacks = new Set();

link.on("segment", ({ segment_id: id, kind, stamp_ns: stamp, agent, origin }) => {
  const known = segments.get(id);
  if (kind === "start" && known?.event && stamp !== null && stamp !== known.start) segments.delete(id);
  const segment = of(id);
  segment.marked = origin !== "auto";
  segment.origin = origin;
  segment.agent ??= agent;
  segment[kind === "start" ? "start" : "end"] ??= stamp;
  tell(segment);
});
link.on("action", (action) => {
  const segment = of(action.segment_id, action.session_id);
  segment.agent = action.agent;
  segment.start = action.start_ns;
  if (action.final) {
    segment.action = action;
    segment.end = action.end_ns;
  } else if (segment.early.length < MOST_EARLY) {
    const { stamp_ns: stamp, action: label, confidence, completeness } = action;
    segment.early.push({ stamp, label, confidence, completeness });
  }
  tell(segment);
});
link.on("held_back", (held) => {
  const segment = of(`held back ${held.agent} ${held.start_ns}`, held.session_id);
  Object.assign(segment, { held, agent: held.agent, start: held.start_ns, end: held.end_ns });
  const all = [...segments.values()].filter((each) => each.held);
  if (all.length > MOST_HELD) segments.delete(all[0].id);
  tell(segment);
});
link.on("event", (event) => {
  const segment = of(event.segment_id, event.session_id);
  Object.assign(segment, { event, agent: event.agent, start: event.start_ns, end: event.end_ns });
  tell(segment);
});

// The segment of a name: another one once its source has been started anew, which may use its names again.
function of(id, session = "") {
  if (session && (segments.get(id)?.session || session) !== session) segments.delete(id);
  if (!segments.has(id)) {
    segments.set(id, { id, session, agent: null, start: null, end: null, early: [], action: null, event: null, held: null });
    if (segments.size > MOST + MOST_HELD) segments.delete(segments.keys().next().value);
  }
  const segment = segments.get(id);
  segment.session ||= session;
  return segment;
}

function tell(segment) {
  for (const callback of callbacks) callback(segment);
}

// Calls back with each segment of which something new is known.
export function onSegment(callback) {
  callbacks.add(guarded(callback));
}

export function allSegments() {
  return [...segments.values()];
}

export function segmentOf(id) {
  return segments.get(id);
}
