#include "validation/sweep/sweep_page.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/config_error.hpp"
#include "core/parameters/unit_of.hpp"
#include "report/plotting/line_figure.hpp"
#include "report/plotting/page.hpp"

namespace hybridtest {
namespace {

/// More curves than that cannot be told apart.
constexpr std::size_t kCurvesMax = 7;

/// A little more than 0 to 1, so that curves at its ends are seen.
const plot::Axis kShares{.label = "share of cases", .low = -0.03, .high = 1.03};

/// `N` of `peak_force_storey_1_floor_1_n`; the title has the name.
std::string axis_label(const std::string& column) {
  const std::string unit{unit_of(column)};
  return unit.empty() ? "ratio" : unit;
}

/// Which rows have each value of a key, in the order of the values.
struct Groups {
  std::string key;
  std::vector<std::string> names;
  std::vector<double> numbers;  // empty where a value is no number
  std::vector<std::vector<std::size_t>> rows;
};

Groups groups_of(const SweepTable& table, const Varied& varied, std::size_t column) {
  Groups groups{varied.key, {}, {}, {}};
  for (const std::string& value : varied.values) {
    if (value.find(kSeedValue) != std::string::npos) continue;
    groups.names.push_back(value);
    groups.rows.emplace_back();
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
      if (table.rows[row][column] == value) groups.rows.back().push_back(row);
    }
    if (const auto number = number_of(value)) groups.numbers.push_back(*number);
  }
  if (groups.numbers.size() != groups.names.size()) groups.numbers.clear();
  return groups;
}

/// Magnitudes of a result in these rows, sorted; those that have it.
std::vector<double> magnitudes(const SweepTable& table, std::size_t column, const std::vector<std::size_t>& rows) {
  std::vector<double> values;
  for (const std::size_t row : rows) {
    const auto value = number_of(table.rows[row][column]);
    if (value && std::isfinite(*value)) values.push_back(std::fabs(*value));
  }
  std::ranges::sort(values);
  return values;
}

double quantile(const std::vector<double>& sorted, double share) {
  const double at = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (at - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

/// The share of cases at most as large as each value.
plot::Line distribution(const std::string& name, const std::vector<double>& sorted) {
  plot::Line line{.name = name};
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const auto count = static_cast<double>(sorted.size());
    for (const double share : {static_cast<double>(i) / count, static_cast<double>(i + 1) / count}) {
      line.x.push_back(sorted[i]);
      line.y.push_back(share);
    }
  }
  return line;
}

/// Results that are drawn: peaks, tracking and energy errors.
std::vector<std::size_t> drawn_columns(const SweepTable& table, std::size_t keys) {
  std::vector<std::size_t> columns;
  for (std::size_t i = 2 + keys; i < table.columns.size(); ++i) {
    const std::string& name = table.columns[i];
    if (name.starts_with("peak_") || name.starts_with("tracking_rms_relative_") ||
        name.starts_with("energy_error_peak_")) {
      columns.push_back(i);
    }
  }
  return columns;
}

plot::PageSection distributions(const SweepTable& table, const std::vector<std::size_t>& columns,
                                const std::vector<Groups>& groups) {
  std::vector<std::size_t> all(table.rows.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
  // By the values of the key that has the most of them and can still be told apart.
  const Groups* by = nullptr;
  for (const Groups& one : groups) {
    if (one.names.size() > 1 && one.names.size() <= kCurvesMax &&
        (by == nullptr || one.names.size() > by->names.size()))
      by = &one;
  }
  plot::LineFigure figure{.panels = {}, .columns = 2};
  for (const std::size_t column : columns) {
    plot::Panel panel{
        .title = table.columns[column], .x = {.label = axis_label(table.columns[column])}, .y = kShares, .lines = {}};
    if (by == nullptr) {
      panel.lines.push_back(distribution("all cases", magnitudes(table, column, all)));
    } else {
      for (std::size_t i = 0; i < by->names.size(); ++i) {
        panel.lines.push_back(distribution(by->names[i], magnitudes(table, column, by->rows[i])));
      }
    }
    std::erase_if(panel.lines, [](const plot::Line& line) { return line.x.empty(); });
    if (!panel.lines.empty()) figure.panels.push_back(std::move(panel));
  }
  const std::string text = "The share of cases in which the magnitude is at most that value" +
                           (by == nullptr ? std::string{"."} : ", for each value of " + by->key + ".");
  return {"Distributions", text, figure.panels.empty() ? "" : to_svg(figure)};
}

/// What is counted over the values of a key.
struct Counted {
  std::string title;
  std::function<std::optional<bool>(std::size_t row)> is_so;  // nothing for a case that is not done
};

plot::PageSection fragility(const Groups& groups, const std::vector<Counted>& counted) {
  plot::LineFigure figure{.panels = {}, .columns = 2};
  for (const Counted& one : counted) {
    plot::Line share{.name = "share of cases", .is_emphasised = true};
    plot::Line low{.name = "95 % interval", .is_dashed = true};
    plot::Line high = low;
    for (std::size_t i = 0; i < groups.numbers.size(); ++i) {
      std::size_t count = 0;
      std::size_t of = 0;
      for (const std::size_t row : groups.rows[i]) {
        const auto is_so = one.is_so(row);
        of += is_so.has_value() ? 1U : 0U;
        count += is_so.value_or(false) ? 1U : 0U;
      }
      if (of == 0) continue;
      const Share found = share_of(count, of);
      for (plot::Line* line : {&share, &low, &high}) line->x.push_back(groups.numbers[i]);
      share.y.push_back(found.share);
      low.y.push_back(found.low);
      high.y.push_back(found.high);
    }
    if (share.x.empty()) continue;
    figure.panels.push_back(
        {.title = one.title, .x = {.label = groups.key}, .y = kShares, .lines = {share, low, high}});
  }
  return {"Fragility over " + groups.key,
          "The share of cases at each value, with the interval of Wilson for the number of cases that were run.",
          figure.panels.empty() ? "" : to_svg(figure)};
}

plot::PageSection quantiles(const SweepTable& table, const std::vector<std::size_t>& columns, const Groups& groups) {
  plot::LineFigure figure{.panels = {}, .columns = 2};
  for (const std::size_t column : columns) {
    plot::Line median{.name = "median", .is_emphasised = true};
    plot::Line low{.name = "5 and 95 % of cases", .is_dashed = true};
    plot::Line high = low;
    for (std::size_t i = 0; i < groups.numbers.size(); ++i) {
      const std::vector<double> sorted = magnitudes(table, column, groups.rows[i]);
      if (sorted.empty()) continue;
      for (plot::Line* line : {&median, &low, &high}) line->x.push_back(groups.numbers[i]);
      median.y.push_back(quantile(sorted, 0.5));
      low.y.push_back(quantile(sorted, 0.05));
      high.y.push_back(quantile(sorted, 0.95));
    }
    if (median.x.empty()) continue;
    figure.panels.push_back({.title = table.columns[column],
                             .x = {.label = groups.key},
                             .y = {.label = axis_label(table.columns[column])},
                             .lines = {median, low, high}});
  }
  return {"Results over " + groups.key, "Magnitudes, of all cases with that value.",
          figure.panels.empty() ? "" : to_svg(figure)};
}

}  // namespace

Exceedance read_exceedance(std::string_view text) {
  const auto equals = text.find('=');
  const auto limit = number_of(text.substr(equals == std::string_view::npos ? 0 : equals + 1));
  if (equals == std::string_view::npos || equals == 0 || !limit) {
    throw ConfigError{fmt::format("--exceed {}: expected column=limit, with a column of the table", text)};
  }
  return {std::string{text.substr(0, equals)}, *limit};
}

Share share_of(std::size_t count, std::size_t of) {
  constexpr double kZ = 1.959963984540054;  // of a two-sided 95 % interval
  const auto n = static_cast<double>(of);
  const double share = static_cast<double>(count) / n;
  const double middle = (share + kZ * kZ / (2.0 * n)) / (1.0 + kZ * kZ / n);
  const double half = kZ / (1.0 + kZ * kZ / n) * std::sqrt(share * (1.0 - share) / n + kZ * kZ / (4.0 * n * n));
  return {share, std::max(0.0, middle - half), std::min(1.0, middle + half)};
}

std::string sweep_page(const SweepPlan& plan, const SweepTable& table, const std::vector<Exceedance>& exceedances) {
  std::vector<Groups> groups;
  for (std::size_t i = 0; i < plan.varied.size(); ++i) groups.push_back(groups_of(table, plan.varied[i], 2 + i));
  const std::size_t exit_code = table.column("exit_code");
  std::vector<Counted> counted{{"ended early", [&table, exit_code](std::size_t row) -> std::optional<bool> {
                                  const std::string& cell = table.rows[row][exit_code];
                                  if (cell.empty()) return {};
                                  return cell != "0";
                                }}};
  for (const Exceedance& one : exceedances) {
    const std::size_t column = table.column(one.column);
    counted.push_back({fmt::format("{} above {:g}", one.column, one.limit),
                       [&table, column, limit = one.limit](std::size_t row) -> std::optional<bool> {
                         const auto value = number_of(table.rows[row][column]);
                         if (!value) return {};
                         return std::fabs(*value) > limit;
                       }});
  }
  const std::vector<std::size_t> columns = drawn_columns(table, plan.varied.size());
  std::vector<plot::PageSection> sections;
  for (const Groups& one : groups) {
    if (one.numbers.size() < 2) continue;
    sections.push_back(fragility(one, counted));
    sections.push_back(quantiles(table, columns, one));
  }
  sections.push_back(distributions(table, columns, groups));
  std::erase_if(sections, [](const plot::PageSection& section) { return section.html.empty(); });

  std::vector<std::vector<std::string>> varied;
  for (const Varied& one : plan.varied) varied.push_back({one.key, fmt::format("{}", fmt::join(one.values, ", "))});
  varied.push_back({"seed", fmt::format("{} to {}", plan.first_seed, plan.last_seed)});
  sections.push_back({"What varies", "Every combination of these.", plot::html_table({"key", "values"}, varied)});
  std::size_t completed = 0;
  for (const auto& row : table.rows) completed += row[exit_code] == "0" ? 1U : 0U;
  const std::string lead =
      fmt::format("{} cases of {}, {} of them done; {} completed their test. The numbers are in table.csv.",
                  table.rows.size(), plan.scenario_file.filename().string(), table.done, completed);
  return plot::html_page("Sweep of " + plan.scenario_file.stem().string(), lead, sections);
}

}  // namespace hybridtest
