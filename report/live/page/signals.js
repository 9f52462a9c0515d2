// What has arrived of each signal: the last 30 s of model time, and the whole test in fewer points.

export const kRecentSeconds = 30;
const kWholePoints = 4000;

/** Points of one signal: the times [s], the extremes that each point stands for, and the last value in it. */
class Points {
  constructor() {
    this.clear();
  }

  clear() {
    this.t = [];
    this.least = [];
    this.most = [];
    this.last = [];
  }

  /** Takes what is newer than what is here. */
  append(from) {
    const newest = this.t.length > 0 ? this.t[this.t.length - 1] : -Infinity;
    for (let i = 0; i < from.t.length; ++i) {
      if (from.t[i] <= newest) continue;
      this.t.push(from.t[i]);
      // A value that is not finite arrives as null.
      this.least.push(from.least[i] ?? NaN);
      this.most.push(from.most[i] ?? NaN);
      this.last.push(from.last[i] ?? NaN);
    }
  }

  drop_before(time_s) {
    // Rarely and many at once: removing from the front of an array moves the rest.
    const keep = first_from(this.t, time_s);
    if (keep < 500) return;
    for (const column of [this.t, this.least, this.most, this.last]) column.splice(0, keep);
  }

  /** Two neighbours become one, without losing a peak. */
  halve() {
    const half = new Points();
    for (let i = 0; i < this.t.length; i += 2) {
      const j = Math.min(i + 1, this.t.length - 1);
      half.t.push(this.t[j]);
      half.least.push(lesser(this.least[i], this.least[j]));
      half.most.push(-lesser(-this.most[i], -this.most[j]));
      half.last.push(this.last[j]);
    }
    Object.assign(this, half);
  }
}

function lesser(a, b) {
  return a <= b || Number.isNaN(b) ? a : b;
}

/** Index of the first time that is not before `time_s`. */
export function first_from(times, time_s) {
  let low = 0;
  let high = times.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] < time_s) low = middle + 1; else high = middle;
  }
  return low;
}

export class Signals {
  constructor() {
    this.by_key = new Map();
    this.newest_s = 0;
    this.revision = 0;  // changes when a signal is new
  }

  clear() {
    this.by_key.clear();
    this.newest_s = 0;
    ++this.revision;
  }

  take(signals) {
    for (const from of signals) {
      const signal = this.find_or_make(from);
      signal.recent.append(from);
      if (signal.whole !== null) {
        signal.whole.append(from);
        if (signal.whole.t.length > kWholePoints) signal.whole.halve();
      }
      if (from.t.length > 0) this.newest_s = Math.max(this.newest_s, from.t[from.t.length - 1]);
    }
    for (const signal of this.by_key.values()) signal.recent.drop_before(this.newest_s - kRecentSeconds);
  }

  /** @param signals   the whole test; what is newer arrives by take(). */
  take_whole(signals) {
    for (const from of signals) {
      const signal = this.find_or_make(from);
      signal.whole = new Points();
      signal.whole.append(from);
      signal.whole.append(signal.recent);
    }
  }

  find_or_make(from) {
    const key = JSON.stringify([from.participant, from.group, from.name, from.subject]);
    let signal = this.by_key.get(key);
    if (signal === undefined) {
      const { participant, group, name, subject, unit } = from;
      signal = { participant, group, name, subject, unit, recent: new Points(), whole: null };
      this.by_key.set(key, signal);
      ++this.revision;
    }
    return signal;
  }

  all() {
    return [...this.by_key.values()];
  }
}
