// One chart: title, legend with the newest values or those under the pointer, and the canvas.

import { element, set_text } from "./elements.js";
import { Painter } from "./painter.js";
import { number_text, shown_unit } from "./quantities.js";
import { first_from, kRecentSeconds } from "./signals.js";

const kTextPeriodMs = 200;

export class Chart {
  /** @param plan   one of chart_plan(). */
  constructor(plan) {
    this.plan = plan;
    this.is_visible = false;
    this.needs_drawing = true;
    this.pointer_x = null;
    this.text_ms = -Infinity;
    const upward = plan.lines[plan.lines.length - 1].signal;
    const unit = shown_unit(upward.unit, upward.name)[0];
    this.canvas = element("canvas");
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", plan.kind === "path" ? `${plan.title}, as a path` : `${plan.title} over time`);
    this.values = plan.lines.map(() => element("output"));
    this.at = element("span", "at");
    const legend = element("p", "legend", plan.lines.map((line, i) => {
      const entry = element("span", "entry");
      if (plan.kind === "history") entry.append(sample(line.style));
      entry.append(`${line.label} `, this.values[i]);
      return entry;
    }));
    legend.append(this.at);
    const title = element("h3", "", plan.title + (unit ? ` [${unit}]` : ""));
    this.figure = element("figure", `chart ${plan.kind}`, [title, legend, this.canvas]);
    this.painter = new Painter(this.canvas, () => { this.needs_drawing = true; });
    this.canvas.addEventListener("pointermove", (event) => this.point_at(event.offsetX));
    this.canvas.addEventListener("pointerleave", () => this.point_at(null));
  }

  point_at(x) {
    this.pointer_x = x;
    this.needs_drawing = true;
    this.text_ms = -Infinity;
  }

  /** @param limit_of   gives the limit of an interlock of a participant, NaN without one. */
  draw(signals, is_whole, limit_of, now_ms) {
    this.needs_drawing = false;
    const to_s = Math.max(signals.newest_s, is_whole ? 1 : kRecentSeconds);
    const from_s = is_whole ? 0 : to_s - kRecentSeconds;
    const lines = this.plan.lines.map(({ signal, style }) => ({
      points: is_whole && signal.whole !== null ? signal.whole : signal.recent,
      factor: shown_unit(signal.unit, signal.name)[1],
      style,
    }));
    if (this.plan.kind === "path") {
      const [along, upward] = lines;
      const unit = shown_unit(this.plan.lines[0].signal.unit, this.plan.lines[0].signal.name)[0];
      this.painter.path(along, upward, from_s, along.style, unit, this.plan.diagonal);
    } else {
      this.painter.histories(lines, from_s, to_s, this.limit_shown(limit_of));
    }
    const pointer_s = this.plan.kind === "history" && this.pointer_x !== null
      ? this.painter.time_at(this.pointer_x, from_s, to_s) : null;
    if (pointer_s !== null) this.painter.hairline(this.pointer_x);
    if (now_ms - this.text_ms < kTextPeriodMs) return;
    this.text_ms = now_ms;
    lines.forEach(({ points, factor }, i) => set_text(this.values[i], number_text(value_at(points, pointer_s) * factor)));
    const newest = lines[lines.length - 1].points.t;
    const at_s = pointer_s ?? newest[newest.length - 1];
    set_text(this.at, at_s === undefined ? "" : `at ${at_s.toFixed(3)} s`);
  }

  limit_shown(limit_of) {
    if (this.plan.limit === null) return NaN;
    const { signal } = this.plan.lines[0];
    return limit_of(this.plan.limit) * shown_unit(signal.unit, signal.name)[1];
  }
}

/** The newest value, or the last one at a time. */
function value_at(points, time_s) {
  const end = time_s === null ? points.t.length : Math.min(points.t.length, first_from(points.t, time_s) + 1);
  return end > 0 ? points.last[end - 1] : NaN;
}

/** A piece of a line as the chart draws it. */
function sample({ colour, dash, width }) {
  const space = "http://www.w3.org/2000/svg";
  const picture = document.createElementNS(space, "svg");
  picture.setAttribute("width", "26");
  picture.setAttribute("height", "8");
  picture.setAttribute("aria-hidden", "true");
  const path = document.createElementNS(space, "path");
  path.setAttribute("d", "M0 4H26");
  path.setAttribute("class", `line ${colour}`);
  path.setAttribute("stroke-width", String(width));
  path.setAttribute("stroke-dasharray", dash.join(" "));
  picture.append(path);
  return picture;
}
