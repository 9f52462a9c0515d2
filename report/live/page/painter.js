// Draws on a canvas: axes, histories over time with their extremes, and paths of one value against another.
//
// A history is reduced to one least, most and last value for each column of pixels, so that no peak is lost and the cost
// does not depend on the number of points. docs/decisions/0011-live-charts-without-a-library.md has the figures.

import { number_text } from "./quantities.js";
import { first_from } from "./signals.js";

const kLeft = 58;
const kRight = 10;
const kTop = 8;
const kBottom = 22;
const kPathStep = 0.7;  // a path is drawn on when it has moved by this many pixels

/** Ticks at 1, 2 or 5 times a power of ten. */
export function ticks_between(low, high, count) {
  const rough = (high - low) / Math.max(1, count);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * ([1, 2, 5, 10].find((factor) => factor * power >= rough) ?? 10);
  const ticks = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i) ticks.push(i * step);
  return { step, ticks };
}

function tick_text(value, step) {
  if (Math.abs(value) < step / 1e6) return "0";
  if (Math.abs(value) >= 1e5 || step < 1e-4) return number_text(value);
  return value.toFixed(Math.max(0, -Math.floor(Math.log10(step) + 1e-9))).replace("-", "−");
}

/** The range of an axis. It grows at once and shrinks only when the values fill less than a third of it. */
class Range {
  constructor() {
    this.low = NaN;
    this.high = NaN;
  }

  cover(low, high) {
    if (!(low <= high)) [low, high] = [-1, 1];
    const size = Math.max(Math.abs(low), Math.abs(high));
    if (high - low < 1e-3 * size || size === 0) {
      const half = size === 0 ? 1 : 0.1 * size;
      low -= half;
      high += half;
    }
    const fits = low >= this.low && high <= this.high && high - low > (this.high - this.low) / 3;
    if (fits) return;
    const room = 0.08 * (high - low);
    this.low = low - room;
    this.high = high + room;
  }
}

/** Colours of the page; read again when it turns light or dark. */
let theme = null;
export function forget_theme() {
  theme = null;
}
function colour(name) {
  theme ??= {};
  return theme[name] ??= getComputedStyle(document.body).getPropertyValue(`--${name}`).trim();
}

export class Painter {
  /** @param resized   called when the canvas needs to be drawn again. */
  constructor(canvas, resized) {
    this.canvas = canvas;
    this.pen = canvas.getContext("2d");
    this.width = 0;
    this.height = 0;
    this.vertical = new Range();
    this.horizontal = new Range();
    new ResizeObserver(() => {
      this.fit();
      resized();
    }).observe(canvas);
  }

  fit() {
    const box = this.canvas.getBoundingClientRect();
    const density = window.devicePixelRatio || 1;
    this.width = box.width;
    this.height = box.height;
    this.canvas.width = Math.round(box.width * density);
    this.canvas.height = Math.round(box.height * density);
    this.density = density;
    this.font_px = parseFloat(getComputedStyle(this.canvas).fontSize);
    this.left = Math.round(kLeft * this.font_px / 12);
    this.bottom = kBottom * this.font_px / 12;
    const columns = Math.max(1, Math.floor(this.width - this.left - kRight));
    this.least = new Float64Array(columns);
    this.most = new Float64Array(columns);
    this.last = new Float64Array(columns);
  }

  /** @returns whether there is room to draw in. */
  begin() {
    if (this.width < this.left + kRight + 20) return false;
    this.pen.setTransform(this.density, 0, 0, this.density, 0, 0);
    this.pen.clearRect(0, 0, this.width, this.height);
    this.pen.font = `${this.font_px}px sans-serif`;
    return true;
  }

  x(value, low, high) {
    return this.left + (value - low) / (high - low) * (this.width - this.left - kRight);
  }

  y(value) {
    const { low, high } = this.vertical;
    return this.height - this.bottom - (value - low) / (high - low) * (this.height - this.bottom - kTop);
  }

  axes(low, high, unit) {
    const pen = this.pen;
    const right = this.width - kRight;
    const floor = this.height - this.bottom;
    pen.lineWidth = 1;
    pen.setLineDash([]);
    pen.strokeStyle = colour("grid");
    pen.fillStyle = colour("quiet");
    pen.beginPath();
    const vertical = ticks_between(this.vertical.low, this.vertical.high, Math.max(2, floor / (3.2 * this.font_px)));
    pen.textAlign = "right";
    pen.textBaseline = "middle";
    for (const tick of vertical.ticks) {
      const y = Math.round(this.y(tick)) + 0.5;
      pen.moveTo(this.left, y);
      pen.lineTo(right, y);
      pen.fillText(tick_text(tick, vertical.step), this.left - 5, Math.max(this.font_px / 2, y));
    }
    const along = ticks_between(low, high, Math.max(2, (right - this.left) / (7 * this.font_px)));
    pen.textAlign = "center";
    pen.textBaseline = "top";
    const unit_width = pen.measureText(unit).width;
    for (const tick of along.ticks) {
      const x = Math.round(this.x(tick, low, high)) + 0.5;
      pen.moveTo(x, kTop);
      pen.lineTo(x, floor);
      const text = tick_text(tick, along.step);
      const half = pen.measureText(text).width / 2;
      if (x + half < right - unit_width - 6) pen.fillText(text, x, floor + 5);
    }
    pen.stroke();
    pen.textAlign = "right";
    pen.fillText(unit, right, floor + 5);
  }

  /** @param offsets   where, in the unit of the vertical axis; drawn where they are within it. */
  limits(offsets) {
    const pen = this.pen;
    pen.strokeStyle = colour("limit");
    pen.fillStyle = colour("limit");
    pen.lineWidth = 1.5;
    pen.setLineDash([8, 5]);
    pen.textAlign = "left";
    for (const value of offsets) {
      if (value < this.vertical.low || value > this.vertical.high) continue;
      const y = this.y(value);
      pen.beginPath();
      pen.moveTo(this.left, y);
      pen.lineTo(this.width - kRight, y);
      pen.stroke();
      pen.textBaseline = value > 0 ? "top" : "bottom";
      pen.fillText("limit", this.left + 4, y + (value > 0 ? 3 : -3));
    }
  }

  /**
   * Histories over time.
   * @param lines     [{points, factor, style: {colour, dash, width}}]; a value times its factor is in the unit of the axis.
   * @param from_s    left end of the axis; `to_s` its right end, later.
   * @param limit     magnitude of a limit that is drawn when the values come near it; NaN: none.
   */
  histories(lines, from_s, to_s, limit = NaN) {
    if (!this.begin()) return;
    let low = Infinity;
    let high = -Infinity;
    for (const { points, factor } of lines) {
      for (let i = first_from(points.t, from_s); i < points.t.length; ++i) {
        if (points.least[i] * factor < low) low = points.least[i] * factor;
        if (points.most[i] * factor > high) high = points.most[i] * factor;
      }
    }
    const is_near = Math.max(Math.abs(low), Math.abs(high)) > 0.5 * limit;
    if (is_near && high > 0.5 * limit) high = Math.max(high, limit);
    if (is_near && low < -0.5 * limit) low = Math.min(low, -limit);
    this.vertical.cover(low, high);
    this.axes(from_s, to_s, "s");
    for (const line of lines) this.history(line, from_s, to_s);
    if (is_near) this.limits([limit, -limit]);
  }

  history({ points, factor, style }, from_s, to_s) {
    const columns = this.least.length;
    this.least.fill(Infinity);
    this.most.fill(-Infinity);
    this.last.fill(NaN);
    const per_second = columns / (to_s - from_s);
    for (let i = first_from(points.t, from_s); i < points.t.length; ++i) {
      const column = Math.min(columns - 1, Math.max(0, Math.floor((points.t[i] - from_s) * per_second)));
      if (points.least[i] < this.least[column]) this.least[column] = points.least[i];
      if (points.most[i] > this.most[column]) this.most[column] = points.most[i];
      this.last[column] = points.last[i];
    }
    const pen = this.pen;
    pen.fillStyle = colour(style.colour);
    pen.globalAlpha = 0.35;
    // Whole pixels: rectangles of parts of pixels, or one path of all of them, cost several times as much.
    for (let column = 0; column < columns; ++column) {
      const top = Math.round(this.y(this.most[column] * factor));
      const height = Math.round(this.y(this.least[column] * factor)) - top;
      if (height > style.width) pen.fillRect(this.left + column, top, 1, height);
    }
    pen.globalAlpha = 1;
    pen.beginPath();
    for (let column = 0; column < columns; ++column) {
      if (!Number.isNaN(this.last[column])) pen.lineTo(this.left + column + 0.5, this.y(this.last[column] * factor));
    }
    this.stroke(style);
  }

  /** The time below a place on the canvas; null beside the axes. */
  time_at(x, from_s, to_s) {
    const share = (x - this.left) / (this.width - this.left - kRight);
    return share < 0 || share > 1 ? null : from_s + share * (to_s - from_s);
  }

  hairline(x) {
    const pen = this.pen;
    pen.beginPath();
    pen.moveTo(x, kTop);
    pen.lineTo(x, this.height - this.bottom);
    this.stroke({ colour: "quiet", dash: [], width: 1 });
  }

  /**
   * One value against another.
   * @param along, upward   {points, factor}: two signals with the same times.
   * @param diagonal        whether to draw where the two are equal, on axes with the same ends.
   */
  path(along, upward, from_s, style, unit, diagonal) {
    if (!this.begin()) return;
    const xs = along.points.last;
    const ys = upward.points.last;
    const begin = first_from(along.points.t, from_s);
    // Two signals of one group arrive together. Should a block of one be missing, times that differ are left out.
    const shift = first_from(upward.points.t, from_s) - begin;
    const ends = [Infinity, -Infinity, Infinity, -Infinity];
    const is_pair = (i) => along.points.t[i] === upward.points.t[i + shift];
    for (let i = begin; i < xs.length; ++i) {
      if (!is_pair(i)) continue;
      const x = xs[i] * along.factor;
      const y = ys[i + shift] * upward.factor;
      if (x < ends[0]) ends[0] = x;
      if (x > ends[1]) ends[1] = x;
      if (y < ends[2]) ends[2] = y;
      if (y > ends[3]) ends[3] = y;
    }
    if (diagonal) {
      ends[0] = ends[2] = Math.min(ends[0], ends[2]);
      ends[1] = ends[3] = Math.max(ends[1], ends[3]);
    }
    this.horizontal.cover(ends[0], ends[1]);
    this.vertical.cover(ends[2], ends[3]);
    const { low, high } = this.horizontal;
    this.axes(low, high, unit);
    const pen = this.pen;
    if (diagonal) {
      pen.beginPath();
      pen.moveTo(this.x(low, low, high), this.y(low));
      pen.lineTo(this.x(high, low, high), this.y(high));
      this.stroke({ colour: "quiet", dash: [3, 4], width: 1 });
    }
    pen.beginPath();
    let [x, y] = [NaN, NaN];
    let [drawn_x, drawn_y] = [-Infinity, -Infinity];
    for (let i = begin; i < xs.length; ++i) {
      if (!is_pair(i)) continue;
      const [next_x, next_y] = [this.x(xs[i] * along.factor, low, high), this.y(ys[i + shift] * upward.factor)];
      if (Number.isNaN(next_x + next_y)) continue;
      [x, y] = [next_x, next_y];
      if (Math.abs(x - drawn_x) + Math.abs(y - drawn_y) < kPathStep) continue;
      pen.lineTo(x, y);
      [drawn_x, drawn_y] = [x, y];
    }
    this.stroke(style);
    if (Number.isNaN(x)) return;
    pen.fillStyle = colour("ink");
    pen.beginPath();
    pen.arc(x, y, 4 * this.font_px / 12, 0, 2 * Math.PI);
    pen.fill();
  }

  stroke({ colour: name, dash, width }) {
    const pen = this.pen;
    pen.strokeStyle = colour(name);
    pen.lineWidth = width;
    pen.lineJoin = "bevel";  // the cheapest
    pen.setLineDash(dash);
    pen.stroke();
    pen.setLineDash([]);
  }
}
