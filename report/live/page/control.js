// Pause, resume, stop and emergency stop.
//
// The dialogs are not modal: a modal one would take the emergency stop away.

import { element, set_hidden } from "./elements.js";

const kQuestions = {
  resume: (test) => `Resume ${test}? Specimens will move.`,
  stop: (test) => `Stop ${test}? It cannot go on afterwards.`,
};
const kPossible = {
  pause: ["running", "held"], resume: ["paused"], stop: ["assembling", "armed", "running", "paused", "held"],
};

const find = (id) => document.getElementById(id);

export class Control {
  constructor() {
    this.test = null;
    this.is_allowed = null;
    // Kept in memory alone. The address keeps it too, so that a page that is loaded again can still stop the test.
    this.token = new URLSearchParams(location.hash.slice(1)).get("token");
    for (const button of document.querySelectorAll(".control")) {
      button.addEventListener("click", () => this.ask(button.dataset.verb));
    }
    document.addEventListener("keydown", (event) => {
      if (event.key === "Escape") for (const dialog of document.querySelectorAll("dialog[open]")) dialog.close("no");
    });
  }

  show(test, phase, is_allowed) {
    this.test = test;
    for (const button of document.querySelectorAll(".control:not(.emergency)")) {
      button.disabled = test === null || !kPossible[button.dataset.verb].includes(phase);
    }
    if (is_allowed === this.is_allowed) return;
    this.is_allowed = is_allowed;
    for (const button of document.querySelectorAll(".control")) set_hidden(button, !is_allowed);
    find("watching_only")?.remove();
    if (!is_allowed) {
      const words = element("span", "", "Watching only");
      words.id = "watching_only";
      words.title = "Start hybridtest watch with --allow-control to pause and stop tests from here.";
      find("controls").append(words);
    }
  }

  async ask(verb) {
    const test = this.test;
    if (test === null) return this.say("There is no test to send it to.");
    const question = kQuestions[verb];
    if (question !== undefined) {
      find("confirmation_text").textContent = question(test);
      if (!(await said_yes(find("confirmation")))) return;
    }
    if (!this.token && !(await this.ask_for_token())) return;
    await this.send(test, verb);
  }

  async ask_for_token() {
    find("token").value = "";
    if (!(await said_yes(find("token_entry")))) return false;
    this.token = find("token").value.trim();
    return this.token !== "";
  }

  async send(test, verb) {
    const words = verb.replace("_", " ");
    try {
      const answer = await fetch(`api/tests/${encodeURIComponent(test)}/control`, {
        method: "POST",
        priority: "high",
        headers: { Authorization: `Bearer ${this.token}`, "Content-Type": "application/json" },
        body: JSON.stringify({ verb }),
      });
      if (answer.ok) return this.say(`Sent: ${words}, to ${test}.`);
      if (answer.status === 401) this.token = null;
      this.say(`NOT SENT: ${words}. ${reason(answer.status)}`, true);
    } catch {
      this.say(`NOT SENT: ${words}. The server does not answer. Use hybridtest ${verb.replace("_", "-")} ${test}, `
        + "or the emergency stop of the laboratory.", true);
    }
  }

  say(text, is_alarm = false) {
    const place = find("control_answer");
    place.textContent = text;
    place.classList.toggle("alarm", is_alarm);
  }
}

function reason(status) {
  if (status === 401) return "The token is not that of this server. Press again to enter another.";
  if (status === 403) return "This server takes no control requests from this page.";
  if (status === 404) return "The server does not hear this test.";
  return `The server answered with status ${status}.`;
}

/** Opens a dialog beside the page; whether it was left with yes. */
function said_yes(dialog) {
  if (dialog.open) dialog.close("no");
  dialog.returnValue = "no";
  dialog.show();
  return new Promise((resolve) => {
    dialog.addEventListener("close", () => resolve(dialog.returnValue === "yes"), { once: true });
  });
}
