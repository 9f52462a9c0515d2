// What stands above the charts, in words: verdict, progress, participants, interlocks, events.

import { element, keep_children, set_hidden, set_text } from "./elements.js";
import { in_words, number_text, quantity_text, seconds_text, shown_unit } from "./quantities.js";

const kNotHeardSeconds = 3;
const kSpokenPeriodMs = 5000;
const kEventsKept = 200;
const kNearShare = 0.8;   // of a limit, from where a bar says that it is near
const kBarEnd = 1.25;     // of a limit, at the end of a bar

// A shape for each phase, so that colour is not needed.
const kPhaseMarks = {
  waiting: "…", assembling: "◔", armed: "◑", running: "▶\uFE0E", paused: "❚❚", held: "◆", stopping: "▼", stopped: "■", lost: "✕",
};

const find = (id) => document.getElementById(id);

export class Status {
  constructor() {
    this.events = [];
    this.spoken_ms = -Infinity;
    this.limits = new Map();
  }

  clear() {
    this.events = [];
    this.limits.clear();
    find("events").replaceChildren();
  }

  /** Magnitude of the limit of an interlock of a participant; NaN without one. */
  limit_of({ participant, interlock }) {
    return this.limits.get(`${participant} ${interlock}`) ?? NaN;
  }

  show(answer, now_ms) {
    const { test, participants, interlocks } = answer;
    this.show_verdict(test);
    this.show_progress(test);
    const has_ended = test.phase === "stopped";
    keep_children(find("participants"), participants, (participant) => participant.id, make_participant,
      (card, participant) => show_participant(card, participant, has_ended));
    for (const { participant, name, limit } of interlocks) this.limits.set(`${participant} ${name}`, limit ?? NaN);
    show_interlocks(interlocks);
    this.speak(test, participants, now_ms);
  }

  show_verdict(test) {
    find("verdict").dataset.phase = test.phase;
    set_text(find("phase_mark"), kPhaseMarks[test.phase] ?? "?");
    set_text(find("verdict_text"), test.verdict || capital(in_words(test.phase)));
    document.title = `${capital(in_words(test.phase))} · ${test.name} · hybridtest watch`;
    set_hidden(find("report_link"), !test.has_report);
  }

  show_progress(test) {
    const share = test.last_step > 0 ? Math.min(1, Math.max(0, test.step / test.last_step)) : 0;
    const bar = find("progress");
    bar.setAttribute("aria-valuenow", String(Math.round(100 * share)));
    bar.firstElementChild.style.width = `${100 * share}%`;
    const real_time = test.steps_per_second * test.step_s;
    const figures = [
      ["Model time", `${number_of_seconds(test.model_time_s)} of ${number_of_seconds(test.duration_s)} s`],
      ["Step", `${grouped(test.step)} of ${grouped(test.last_step)}`],
      ["Rate", Number.isFinite(real_time) && test.steps_per_second !== null
        ? `${number_text(test.steps_per_second)} steps/s, ${real_time.toFixed(2)} × real time` : "–"],
      ["Time left", seconds_text(test.left_s)],
      ["Mode", test.mode ? in_words(test.mode) + (test.mode === "lockstep" || test.time_scale === 1 || !test.time_scale
        ? "" : `, time scale ${number_text(test.time_scale)}`) : "–"],
    ];
    keep_children(find("figures"), figures, ([name]) => name, ([name]) => element("div", "", [element("dt", "", name), element("dd")]),
      (child, [, text]) => set_text(child.lastElementChild, text));
  }

  /** To screen readers: what changed, and not more often than someone can listen. */
  speak(test, participants, now_ms) {
    const faults = participants.flatMap(({ id, faults }) => faults.map((fault) => `${id}: ${fault}`));
    // How long the coordinator has been silent changes all the time.
    const why = test.phase === "lost" ? "nothing is heard of its coordinator" : test.why;
    const text = [`${test.name} is ${in_words(test.phase)}`, why, ...faults].filter(Boolean).join(". ");
    if (text === find("spoken").textContent || now_ms - this.spoken_ms < kSpokenPeriodMs) return;
    this.spoken_ms = now_ms;
    find("spoken").textContent = text;
  }

  add_events(events) {
    if (events.length === 0) return;
    this.events = [...events].reverse().concat(this.events).slice(0, kEventsKept);
    keep_children(find("events"), this.events, (event) => String(event.cursor), make_event, () => {});
  }
}

function capital(words) {
  return words.charAt(0).toUpperCase() + words.slice(1);
}

function grouped(count) {
  return count === null || count === undefined ? "–" : String(count).replace(/\B(?=(\d{3})+$)/g, "\u202F");
}

function number_of_seconds(seconds) {
  return Number.isFinite(seconds) && seconds !== null ? seconds.toFixed(1) : "–";
}

function make_participant() {
  return element("li", "participant", [
    element("h3"), element("p", "state"), element("p", "heard"), element("ul", "faults"), element("dl"),
  ]);
}

function show_participant(card, { id, role, state, heard_s_ago, last_step, faults, exchange }, has_ended) {
  const [title, state_line, heard, fault_list, figures] = card.children;
  const is_silent = (heard_s_ago === null || heard_s_ago > kNotHeardSeconds) && !has_ended;
  card.classList.toggle("alarm", is_silent || faults.length > 0);
  set_text(title, id);
  set_text(state_line, `${in_words(role)}: ${in_words(state)}`);
  set_text(heard, has_ended ? "the test has ended"
    : is_silent ? heard_s_ago === null ? "⚠ not heard yet" : `⚠ not heard for ${seconds_text(heard_s_ago)}` : "heard just now");
  keep_children(fault_list, faults, (fault) => fault, (fault) => element("li", "", `⚠ ${fault}`), () => {});
  set_hidden(fault_list, faults.length === 0);
  const rows = [["last step", grouped(last_step)]];
  if (exchange) {
    const { round_trip_p50_us, round_trip_p99_us, resent, bridged, lost } = exchange;
    rows.push(["round trip p50 / p99", `${number_text(round_trip_p50_us)} / ${quantity_text(round_trip_p99_us, "us")}`],
      ["resent / bridged / lost", [resent, bridged, lost].map(grouped).join(" / ")]);
  }
  keep_children(figures, rows, ([name]) => name, ([name]) => element("div", "", [element("dt", "", name), element("dd")]),
    (child, [, text]) => set_text(child.lastElementChild, text));
}

function show_interlocks(interlocks) {
  set_hidden(find("interlocks_section"), interlocks.length === 0);
  const participants = [...new Set(interlocks.map(({ participant }) => participant))];
  keep_children(find("interlocks"), participants, (participant) => participant,
    (participant) => element("div", "interlocks", [element("h3", "", participant), element("ul")]),
    (card, participant) => {
      keep_children(card.lastElementChild, interlocks.filter((interlock) => interlock.participant === participant),
        ({ name }) => name, make_interlock, show_interlock);
    });
}

function make_interlock({ name }) {
  const bar = element("div", "meter", [element("div", "filled"), element("div", "peak"), element("div", "mark")]);
  bar.setAttribute("role", "meter");
  bar.setAttribute("aria-label", `${in_words(name)}, in percent of its limit`);
  bar.setAttribute("aria-valuemin", "0");
  bar.setAttribute("aria-valuemax", String(100 * kBarEnd));
  return element("li", "", [element("span", "name", in_words(name)), element("span", "share"), bar]);
}

function show_interlock(row, { name, unit, observed, limit, share, peak_share }) {
  const [, words, bar] = row.children;
  const [filled, peak] = bar.children;
  const percent = (part) => (Number.isFinite(part) && part !== null ? `${Math.round(100 * part)} %` : "–");
  const width = (part) => `${100 * Math.min(1, Math.max(0, part ?? 0) / kBarEnd)}%`;
  const [shown, factor] = shown_unit(unit, name);
  const value = (si) => number_text(si === null ? NaN : si * factor);
  const state = share >= 1 ? "beyond the limit" : share >= kNearShare ? "near the limit" : "of the limit";
  set_text(words, `${percent(share)} ${state}`);
  row.title = `${value(observed)} of ${value(limit)} ${shown}, `
    + `at most ${percent(peak_share)} so far`;
  row.classList.toggle("near", share >= kNearShare);
  row.classList.toggle("beyond", share >= 1);
  filled.style.width = width(share);
  peak.style.left = width(peak_share);
  bar.setAttribute("aria-valuenow", String(Math.round(100 * Math.min(kBarEnd, Math.max(0, share ?? 0)))));
  bar.setAttribute("aria-valuetext", `${words.textContent}; ${row.title}`);
}

function make_event({ time_utc, source, severity, text, model_time_s, step }) {
  const when = element("time", "", /\d\d:\d\d:\d\d/.exec(time_utc ?? "")?.[0] ?? "");
  when.title = `${time_utc} UTC`;
  const at = Number.isFinite(model_time_s) && model_time_s !== null ? `${model_time_s.toFixed(2)} s, step ${grouped(step)}` : "";
  return element("li", "", [
    when, element("span", "source", source),
    element("span", "text", `${severity === "information" ? "" : `⚠ ${severity}: `}${text}`), element("span", "at", at),
  ]);
}
