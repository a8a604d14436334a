// The course of the early answers: how sure each action was over the last seconds.

import uPlot from "uplot";
import { colourOf, dark, theme } from "../colours.js";
import { card, element } from "../elements.js";
import { link } from "../link.js";
import { isShown, nowNs } from "./people.js";

const SPAN_S = 20;
const REFRESH_MS = 200;
const GAP_S = 0.3;       // early answers further apart are not joined by a line
const HEIGHT_PX = 150;

export function courses() {
  const box = element("div", { class: "course", role: "img", "aria-label": "Confidence of each action over the last 20 seconds" });
  new Courses(box);
  return card("courses", "Early answers", {}, box, element("p", { class: "caption" }, "Confidence of the likeliest action while somebody moves; the colour is the action's. The dashed line is the share of the action that is done."));
}

class Courses {
  constructor(box) {
    Object.assign(this, { box, points: [], labels: [], plot: null });
    link.on("action", ({ agent, final, stamp_ns: stamp, action, confidence, completeness }) => {
      if (final || !isShown(agent) || !action) return;
      this.points.push({ at: stamp / 1e9, label: action, confidence, completeness });
      if (!this.labels.includes(action)) this.labels = [...this.labels, action].sort();
    });
    dark.addEventListener("change", () => this.rebuild());
    new ResizeObserver(() => this.rebuild()).observe(box);
    setInterval(() => !document.hidden && this.show(), REFRESH_MS);
  }

  show() {
    if (this.plot?.series.length !== this.labels.length + 2) this.rebuild();
    const now = nowNs() / 1e9;
    this.points = this.points.filter(({ at }) => at > now - SPAN_S && at <= now + 2);
    this.plot?.setData(this.columns(now), false);
    this.plot?.redraw(false);
  }

  // Columns as uPlot wants them: times before now (s), then a course each, null where it has none.
  columns(now) {
    const rows = [];
    this.points.forEach((point, i) => {
      if (i && point.at - this.points[i - 1].at > GAP_S) rows.push({ at: this.points[i - 1].at + GAP_S / 2 });
      rows.push(point);
    });
    return [
      rows.map(({ at }) => at - now),
      rows.map(({ completeness }) => completeness ?? null),
      ...this.labels.map((label) => rows.map((row) => (row.label === label ? row.confidence : null))),
    ];
  }

  rebuild() {
    this.plot?.destroy();
    this.plot = null;
    const width = this.box.clientWidth;
    if (!width) return;
    const axis = { stroke: theme("muted"), grid: { stroke: theme("grid"), width: 1 }, ticks: { show: false }, font: "13px system-ui" };
    this.plot = new uPlot(
      {
        width, height: HEIGHT_PX, legend: { show: false }, cursor: { show: false }, pxAlign: 0,
        scales: { x: { time: false, range: [-SPAN_S, 0] }, y: { range: [0, 1.02] } },
        axes: [
          { ...axis, size: 26, values: (_, ticks) => ticks.map((s) => (s ? `−${-s} s` : "now")) },
          { ...axis, size: 46, splits: [0, 0.5, 1], values: (_, ticks) => ticks.map((share) => `${100 * share} %`) },
        ],
        series: [{}, { points: { show: false }, stroke: theme("muted"), dash: [4, 4], width: 1.5 }, ...this.labels.map((label) => ({ stroke: colourOf(label), width: 3, points: { show: false } }))],
      },
      this.columns(nowNs() / 1e9),
      this.box,
    );
  }
}
