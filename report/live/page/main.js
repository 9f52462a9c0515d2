// Asks the server for news, one request after another, and draws them.

import { Charts } from "./charts.js";
import { Control } from "./control.js";
import { element, keep_children, set_hidden, set_text } from "./elements.js";
import { Signals } from "./signals.js";
import { Status } from "./status.js";

const kPollMs = 50;
const kHiddenPollMs = 1000;
const kRetryMs = 500;
const kTestsMs = 2000;
const kPatienceMs = 5000;
const kServerLostMs = 3000;
const kDrawMs = 45;        // a little less than a poll, so that each is drawn
const kStatusMs = 200;     // text changes no faster than someone can read

const find = (id) => document.getElementById(id);

const signals = new Signals();
const charts = new Charts(find("charts"));
const status = new Status();
const control = new Control();

let chosen = null;           // name of the test on the page
// Nobody knows yet whether this page may control a test: until the server says no, the emergency stop is there.
let tests = { tests: [], control: null };
let cursor = 0;
let newest = null;           // the last answer
let is_whole = false;
let whole_is_here = false;
let answered_ms = performance.now();
let answered_at = null;      // when the last answer came, for people
let has_news = false;
let drawn_ms = -Infinity;
let status_ms = -Infinity;

const pause = (ms) => new Promise((resolve) => { setTimeout(resolve, ms); });

async function ask(path) {
  const answer = await fetch(path, { cache: "no-store", signal: AbortSignal.timeout(kPatienceMs) });
  if (!answer.ok) throw new Error(`${path}: ${answer.status}`);
  return answer.json();
}

function choose(name) {
  if (name === chosen) return;
  chosen = name;
  begin_anew();
  const address = new URL(location.href);
  address.searchParams.set("test", name);
  history.replaceState(null, "", address);
}

function begin_anew() {
  cursor = 0;
  newest = null;
  signals.clear();
  status.clear();
  whole_is_here = false;
}

async function ask_for_tests() {
  tests = await ask("api/tests");
  const names = tests.tests.map(({ name }) => name);
  if (chosen === null) {
    const wanted = new URLSearchParams(location.search).get("test");
    const live = tests.tests.find(({ phase }) => phase !== "stopped" && phase !== "lost");
    const name = names.includes(wanted) ? wanted : live?.name ?? names[0];
    if (name !== undefined) choose(name);
  }
  // One that is no longer heard of stays on the page.
  const rows = chosen === null || names.includes(chosen) ? tests.tests : [{ name: chosen, phase: "lost" }, ...tests.tests];
  keep_children(find("test_choice"), rows, ({ name }) => name, ({ name }) => {
    const option = element("option");
    option.value = name;
    return option;
  }, (option, { name, phase }) => set_text(option, `${name} (${phase})`));
  find("test_choice").value = chosen ?? "";
  if (chosen === null) set_text(find("verdict_text"), "Waiting for a test: none is heard on this network.");
}

async function ask_for_news() {
  const name = chosen;
  const answer = await ask(`api/tests/${encodeURIComponent(name)}?since=${cursor}`);
  if (name !== chosen) return;
  if (answer.reset) begin_anew();
  cursor = answer.cursor;
  newest = answer;
  signals.take(answer.signals);
  status.add_events(answer.events);
  has_news ||= answer.signals.length > 0;
}

async function ask_for_whole() {
  const name = chosen;
  const answer = await ask(`api/tests/${encodeURIComponent(name)}/whole`);
  if (name !== chosen) return;
  signals.take_whole(answer.signals);
  whole_is_here = true;
  has_news = true;
}

async function poll() {
  let tests_ms = -Infinity;
  let due_ms = performance.now();
  for (;;) {
    const begin_ms = performance.now();
    try {
      if (begin_ms - tests_ms > kTestsMs) {
        await ask_for_tests();
        tests_ms = begin_ms;  // without an answer the next turn asks again
      }
      if (chosen !== null) await ask_for_news();
      if (chosen !== null && is_whole && !whole_is_here) await ask_for_whole();
      answered_ms = performance.now();
      answered_at = new Date();
    } catch {
      await pause(kRetryMs);
    }
    const period_ms = document.hidden ? kHiddenPollMs : kPollMs;
    // From when it was due: timers that fire late do not add up.
    due_ms = Math.max(due_ms + period_ms, performance.now());
    await pause(due_ms - performance.now());
  }
}

function draw(now_ms) {
  requestAnimationFrame(draw);
  if (now_ms - drawn_ms < kDrawMs) return;
  drawn_ms = now_ms;
  charts.arrange(signals);
  charts.draw(signals, is_whole, (limit) => status.limit_of(limit), has_news, now_ms);
  has_news = false;
  if (now_ms - status_ms < kStatusMs) return;
  status_ms = now_ms;
  if (newest !== null) status.show(newest, now_ms);
  control.show(chosen, newest?.test.phase ?? "waiting", tests.control);
  show_server_lost(now_ms);
}

function show_server_lost(now_ms) {
  const silent_ms = performance.now() - answered_ms;
  const is_lost = silent_ms > kServerLostMs;
  const notice = find("server_lost");
  if (is_lost) {
    const since = answered_at === null ? "" : ` What stands here is from ${answered_at.toLocaleTimeString()}.`;
    set_text(notice, `⚠ hybridtest watch has not answered for ${Math.floor(silent_ms / 1000)} s.${since}`);
  }
  set_hidden(notice, !is_lost);
}

find("test_choice").addEventListener("change", (event) => choose(event.target.value));
find("span_choice").addEventListener("change", (event) => {
  is_whole = event.target.value === "whole";
  has_news = true;
});
find("large_mode").addEventListener("click", (event) => {
  const is_large = document.documentElement.classList.toggle("large");
  event.currentTarget.setAttribute("aria-pressed", String(is_large));
  charts.draw_all_again();
});

poll();
requestAnimationFrame(draw);
