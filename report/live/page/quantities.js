// Numbers, units and names in words.

/** Unit on the page by the SI unit that a value arrives in, with the factor that takes it there. */
const kShown = {
  m: ["mm", 1e3], N: ["kN", 1e-3], J: ["kJ", 1e-3], s: ["s", 1], us: ["µs", 1],
  "m/s": ["mm/s", 1e3], "m/s2": ["m/s²", 1], "m/s^2": ["m/s²", 1], rad: ["mrad", 1e3], "N m": ["kN m", 1e-3], "1": ["", 1],
};

/** [unit on the page, factor]. A delay is shown in ms although other times are in s, and an error of energy in J. */
export function shown_unit(unit, name = "") {
  if (unit === "s" && /delay|age/.test(name)) return ["ms", 1e3];
  if (unit === "J" && name.includes("error")) return ["J", 1];
  return kShown[unit] ?? [unit, 1];
}

/** Three significant digits, without an exponent where that is readable. */
export function number_text(value) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  if (size === 0) return "0";
  if (size >= 1e6 || size < 1e-4) return value.toExponential(1).replace("-", "−");
  return value.toFixed(Math.max(0, Math.min(4, 2 - Math.floor(Math.log10(size))))).replace("-", "−");
}

/** A value with its unit on the page. */
export function quantity_text(value, unit, name = "") {
  const [shown, factor] = shown_unit(unit, name);
  return `${number_text(value === null ? NaN : value * factor)} ${shown}`.trim();
}

export function seconds_text(seconds) {
  if (seconds === null || seconds === undefined || !Number.isFinite(seconds)) return "–";
  if (seconds < 120) return `${seconds.toFixed(1)} s`;
  const minutes = Math.floor(seconds / 60);
  return minutes < 120 ? `${minutes} min ${String(Math.floor(seconds % 60)).padStart(2, "0")} s`
    : `${Math.floor(minutes / 60)} h ${String(minutes % 60).padStart(2, "0")} min`;
}

/** `tracking_error` as "tracking error". */
export function in_words(name) {
  return String(name).replaceAll("_", " ");
}
