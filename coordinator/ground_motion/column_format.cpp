#include "coordinator/ground_motion/column_format.hpp"

#include <cmath>
#include <cstddef>
#include <cstdio>
#include <optional>
#include <string_view>

namespace hybridtest {
namespace {

using motion_text::Line;
using motion_text::number;
using motion_text::refuse;
using motion_text::shown;
using motion_text::upper_case;

/// Printed times are rounded. Spacings that differ by more than this share of the step are unequal.
constexpr double kSpacingTolerance = 0.01;

std::string formatted(const char* format, double first, double second) {
  char text[160];
  // The formats are the constants below.
  std::snprintf(text, sizeof text, format, first, second);
  return text;
}

std::string_view without_comment(std::string_view line) { return line.substr(0, line.find('#')); }

/// Rows of numbers with the lines they are on.
struct Rows {
  std::size_t columns = 0;
  std::vector<double> values;  // row by row
  std::vector<int> lines;
  std::vector<std::string> names;  // of the columns; empty without a header line
  int names_line = 0;

  [[nodiscard]] double value(std::size_t row, std::size_t column) const { return values[row * columns + column]; }
};

bool is_header(const std::vector<std::string_view>& words) {
  for (const auto word : words) {
    if (number(word)) return false;
  }
  return true;
}

void append_row(Rows& rows, const std::vector<std::string_view>& words, const Line& line, const std::string& name) {
  if (rows.columns == 0) rows.columns = words.size();
  if (words.size() != rows.columns || rows.columns > 2) {
    refuse(name, line.number,
           "found " + std::to_string(words.size()) + " columns, expected " +
               (rows.columns <= 2 ? std::to_string(rows.columns) + " as in the lines before"
                                  : std::string{"one (acceleration) or two (time, acceleration)"}));
  }
  if (rows.lines.size() == kGroundMotionPointsMax) {
    refuse(name, line.number, "more rows follow, expected at most " + std::to_string(kGroundMotionPointsMax));
  }
  for (const auto word : words) {
    const auto value = number(word);
    if (!value) refuse(name, line.number, "found " + shown(word) + ", expected a number");
    rows.values.push_back(*value);
  }
  rows.lines.push_back(line.number);
}

Rows read_rows(const std::vector<Line>& lines, const std::string& name) {
  Rows rows;
  for (const Line& line : lines) {
    const auto words = motion_text::split_words(without_comment(line.text), true);
    if (words.empty()) continue;
    if (rows.lines.empty() && rows.names.empty() && is_header(words)) {
      for (const auto word : words) rows.names.emplace_back(word);
      rows.names_line = line.number;
      rows.columns = words.size();
      continue;
    }
    append_row(rows, words, line, name);
  }
  if (rows.lines.empty()) {
    refuse(name, lines.back().number, "the file holds no values, expected one or two columns of numbers");
  }
  return rows;
}

std::optional<AccelerationUnit> unit_in_name(const std::string& column) {
  const std::string text = upper_case(column);
  if (text.ends_with("_CM_PER_S2")) return AccelerationUnit::cm_per_s2;
  if (text.ends_with("_M_PER_S2")) return AccelerationUnit::m_per_s2;
  if (text.ends_with("_G")) return AccelerationUnit::g;
  return std::nullopt;
}

AccelerationUnit unit_of(const Rows& rows, const std::string& name, const GroundMotionOptions& options) {
  const auto named = rows.names.empty() ? std::nullopt : unit_in_name(rows.names.back());
  if (named && options.unit && *named != *options.unit) {
    refuse(name, rows.names_line,
           "the column " + shown(rows.names.back()) +
               " is in another unit than the one given for the file; remove one of the two");
  }
  const auto unit = options.unit ? options.unit : named;
  if (!unit) {
    refuse(name, rows.names.empty() ? rows.lines.front() : rows.names_line,
           "the unit of the acceleration is unknown; give it in the scenario, or begin the file with a line of names "
           "such as 'time_s,ground_acceleration_m_per_s2' ('_g' and '_cm_per_s2' likewise)");
  }
  return *unit;
}

void check_time_name(const Rows& rows, const std::string& name) {
  if (rows.names.empty() || rows.columns != 2) return;
  const std::string text = upper_case(rows.names.front());
  if (text == "TIME_S" || text == "TIME" || text == "T" || text == "T_S") return;
  refuse(name, rows.names_line,
         "the first column is named " + shown(rows.names.front()) + ", expected 'time_s', the time in seconds");
}

/// @return the spacing, from first and last time so that rounded prints average out.
double even_spacing(const Rows& rows, const std::string& name) {
  const std::size_t count = rows.lines.size();
  if (count < 2) refuse(name, rows.lines.front(), "the file has one row, expected at least two to know the step");
  const double first = rows.value(1, 0) - rows.value(0, 0);
  if (first <= 0.0) {
    refuse(name, rows.lines[1],
           formatted("the time %.9g s follows %.9g s, expected increasing times", rows.value(1, 0), rows.value(0, 0)));
  }
  for (std::size_t row = 2; row < count; ++row) {
    const double spacing = rows.value(row, 0) - rows.value(row - 1, 0);
    if (std::abs(spacing - first) <= kSpacingTolerance * first) continue;
    refuse(name, rows.lines[row],
           formatted("the time is %.6g s after the one before, expected %.6g s as at the start: the values must be "
                     "equally spaced",
                     spacing, first));
  }
  return (rows.value(count - 1, 0) - rows.value(0, 0)) / static_cast<double>(count - 1);
}

double start_of(const Rows& rows, double dt_s, const std::string& name) {
  const double start_s = rows.value(0, 0);
  if (start_s < 0.0) {
    refuse(name, rows.lines.front(), formatted("the first time is %.9g s, expected not less than %g s", start_s, 0.0));
  }
  return start_s <= kSpacingTolerance * dt_s ? 0.0 : start_s;
}

}  // namespace

GroundMotion parse_columns(const std::vector<Line>& lines, const std::string& name,
                           const GroundMotionOptions& options) {
  const Rows rows = read_rows(lines, name);
  check_time_name(rows, name);
  const double factor = metres_per_second_squared(unit_of(rows, name, options)) * options.scale;
  GroundMotion motion;
  if (rows.columns == 2) {
    motion.dt_s = even_spacing(rows, name);
    require_same_step(name, rows.lines.front(), motion.dt_s, options);
    motion.start_s = start_of(rows, motion.dt_s, name);
  } else {
    if (!options.dt_s) {
      refuse(name, rows.lines.front(),
             "the file has one column and no times; give its step, in seconds, in the scenario");
    }
    motion.dt_s = *options.dt_s;
  }
  motion.acceleration_m_per_s2.reserve(rows.lines.size());
  for (std::size_t row = 0; row < rows.lines.size(); ++row) {
    motion.acceleration_m_per_s2.push_back(rows.value(row, rows.columns - 1) * factor);
  }
  return motion;
}

}  // namespace hybridtest
