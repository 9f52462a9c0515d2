// Which charts stand on the page, from the signals that have arrived.

import { in_words } from "./quantities.js";

// Colours as on every page of this project; a dash tells the lines apart without colour.
const kTarget = { colour: "target", dash: [7, 4], width: 1.5 };
const kCommand = { colour: "target", dash: [2, 3], width: 1.5 };
const kMeasured = { colour: "measured", dash: [], width: 2 };
const kModelled = { colour: "modelled", dash: [], width: 2 };
const kGround = { colour: "ground", dash: [], width: 1.5 };
const kOther = { colour: "ink", dash: [], width: 1.5 };

const kEnergies = {
  input_energy: kGround,
  restoring_energy: kModelled,
  damping_energy: { colour: "completed", dash: [2, 3], width: 2 },
  kinetic_energy: { colour: "modelled", dash: [7, 4], width: 1.5 },
};

/** @returns sections [{title, charts: [{title, kind, lines, diagonal, limit}]}] in the order of the page. */
export function chart_plan(signals) {
  const by_participant = new Map();
  for (const signal of signals) {
    const groups = by_participant.get(signal.participant) ?? new Map();
    by_participant.set(signal.participant, groups);
    groups.set(signal.group, [...(groups.get(signal.group) ?? []), signal]);
  }
  const sections = [];
  for (const [participant, groups] of by_participant) {
    for (const [group, make, rank] of [["structure", structure, 0], ["control", site, 1], ["steps", numerical, 2]]) {
      if (!groups.has(group)) continue;
      const title = { structure: "Structure", control: `Site ${participant}`, steps: `Numerical substructure ${participant}` };
      sections.push({ rank, key: `${participant} ${group}`, title: title[group], charts: make(groups.get(group), participant) });
    }
  }
  return sections.sort((a, b) => a.rank - b.rank || (a.title < b.title ? -1 : 1));
}

function line(signal, style, label = in_words(signal.name)) {
  return { signal, style, label };
}

function titled(name, subject) {
  const words = in_words(name);
  return `${words[0].toUpperCase()}${words.slice(1)}${subject ? ` · ${subject.replace("_relative_to_", " relative to ")}` : ""}`;
}

function history(signal, style, limit = null) {
  return { title: titled(signal.name, signal.subject), kind: "history", lines: [line(signal, style)], limit };
}

function structure(signals) {
  const named = (name) => signals.filter((signal) => signal.name === name);
  const energies = Object.entries(kEnergies).flatMap(([name, style]) => named(name).map((signal) => line(signal, style)));
  return [
    ...named("displacement").map((signal) => history(signal, kModelled)),
    ...named("drift").map((signal) => history(signal, kModelled)),
    ...named("base_shear").map((signal) => history(signal, kOther)),
    ...(energies.length > 0 ? [{ title: "Energy balance", kind: "history", lines: energies, limit: null }] : []),
    ...named("energy_balance_error").map((signal) => history(signal, kOther)),
    ...named("ground_acceleration").map((signal) => history(signal, kGround)),
    ...named("velocity").map((signal) => history(signal, kModelled)),
    ...named("restoring_force").map((signal) => history(signal, kOther)),
  ];
}

function site(signals, participant) {
  const limit = (interlock) => ({ participant, interlock });
  const subjects = [...new Set(signals.map((signal) => signal.subject))].filter((subject) => subject !== "");
  const charts = [];
  for (const subject of subjects) {
    const named = (name) => signals.find((signal) => signal.name === name && signal.subject === subject);
    const [target, command, measured] = ["target", "command", "measured"].map((name) => named(`${name}_displacement`));
    const of = subjects.length > 1 ? subject : "";
    const displacements = [[target, kTarget, "target"], [command, kCommand, "command"], [measured, kMeasured, "measured"]]
      .filter(([signal]) => signal !== undefined).map(([signal, style, label]) => line(signal, style, label));
    if (displacements.length > 0) {
      charts.push({ title: titled("displacement", of), kind: "history", lines: displacements, limit: limit("displacement") });
    }
    const force = named("force");
    if (force) charts.push({ ...history(force, kMeasured, limit("force")), title: titled("force", of) });
    if (force && measured) charts.push(loop(measured, force, kMeasured, of));
    const delay = named("estimated_delay");
    const error = named("tracking_error");
    if (error) charts.push({ ...history(error, kOther, limit("tracking_error")), title: titled("tracking_error", of) });
    if (delay) charts.push({ ...history(delay, kOther), title: titled("estimated_delay", of) });
    if (target && measured) {
      charts.push({
        title: titled("measured against target", of), kind: "path", diagonal: true, limit: null,
        lines: [line(target, kMeasured, "target, across"), line(measured, kMeasured, "measured, upwards")],
      });
    }
  }
  const alone = (name) => signals.filter((signal) => signal.name === name).map((signal) => history(signal, kOther));
  return [...charts, ...alone("energy_error"), ...alone("tracking_lag_sine")];
}

function numerical(signals) {
  return signals.filter((signal) => signal.name === "displacement").flatMap((displacement) => {
    const force = signals.find((signal) => signal.name === "force" && signal.subject === displacement.subject);
    const charts = [history(displacement, kModelled)];
    if (force) charts.push(history(force, kModelled), loop(displacement, force, kModelled, displacement.subject));
    return charts;
  });
}

function loop(displacement, force, style, subject) {
  return {
    title: titled("force against displacement", subject), kind: "path", diagonal: false, limit: null,
    lines: [line(displacement, style, "displacement, across"), line(force, style, "force, upwards")],
  };
}
