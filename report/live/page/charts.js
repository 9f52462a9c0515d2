// The sections of charts, one for the structure and one for each substructure.

import { Chart } from "./chart.js";
import { chart_plan } from "./chart_plan.js";
import { element, keep_children, set_hidden, set_text } from "./elements.js";
import { forget_theme } from "./painter.js";

const kChartsAtFirst = 9;  // of a section; a button shows the others

export class Charts {
  constructor(place) {
    this.place = place;
    this.charts = new Map();
    this.revision = -1;
    this.shown_in_full = new Set();
    this.watcher = new IntersectionObserver((entries) => {
      for (const { target, isIntersecting } of entries) {
        const chart = this.chart_of(target);
        if (chart === undefined) continue;
        chart.is_visible = isIntersecting;
        chart.needs_drawing = true;
      }
    }, { rootMargin: "100px" });
    const repaint = () => {
      forget_theme();
      this.draw_all_again();
    };
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", repaint);
  }

  chart_of(figure) {
    return this.charts.get(figure.dataset.chart);
  }

  draw_all_again() {
    for (const chart of this.charts.values()) chart.needs_drawing = true;
  }

  /** Makes the charts of signals that are new, and removes those of signals that are gone. */
  arrange(signals) {
    if (signals.revision === this.revision) return;
    this.revision = signals.revision;
    const sections = chart_plan(signals.all());
    const before = this.charts;
    this.charts = new Map();
    keep_children(this.place, sections, (section) => section.key, () => this.make_section(), (child, section) => {
      set_text(child.querySelector("h2"), section.title);
      const figures = section.charts.map((plan) => this.keep_chart(before, section, plan).figure);
      child.querySelector(".charts").replaceChildren(...figures);
      this.hide_the_many(child, section.key);
    });
    for (const chart of before.values()) this.watcher.unobserve(chart.figure);
    for (const chart of this.charts.values()) this.watcher.observe(chart.figure);
  }

  make_section() {
    const section = element("section");
    const title = element("h2");
    title.id = `section_${this.place.children.length}_${this.revision}`;
    section.setAttribute("aria-labelledby", title.id);
    const more = element("button", "more");
    more.type = "button";
    more.addEventListener("click", () => {
      this.shown_in_full.add(section.dataset.key);
      this.hide_the_many(section, section.dataset.key);
    });
    section.append(title, element("div", "charts"), more);
    return section;
  }

  hide_the_many(section, key) {
    const figures = [...section.querySelectorAll("figure")];
    const shown = this.shown_in_full.has(key) ? figures.length : kChartsAtFirst;
    figures.forEach((figure, i) => set_hidden(figure, i >= shown));
    const more = section.querySelector(".more");
    set_hidden(more, figures.length <= shown);
    set_text(more, `Show all ${figures.length} charts`);
  }

  keep_chart(before, section, plan) {
    const signals = plan.lines.map(({ signal }) => [signal.participant, signal.group, signal.name, signal.subject]);
    const key = JSON.stringify([section.key, plan.title, signals]);
    let chart = before.get(key);
    // After a new beginning the signals are new, though their names are not.
    if (chart === undefined || chart.plan.lines.some(({ signal }, i) => signal !== plan.lines[i].signal)) {
      chart = new Chart(plan);
      chart.figure.dataset.chart = key;
    }
    this.charts.set(key, chart);
    return chart;
  }

  draw(signals, is_whole, limit_of, has_news, now_ms) {
    for (const chart of this.charts.values()) {
      if (chart.is_visible && (has_news || chart.needs_drawing)) chart.draw(signals, is_whole, limit_of, now_ms);
    }
  }
}
