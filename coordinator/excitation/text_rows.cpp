#include "coordinator/excitation/text_rows.hpp"

#include <cmath>
#include <cstdio>

#include "coordinator/excitation/read_ground_motion.hpp"

namespace hybridtest::motion_text {
namespace {

/// Printed times are rounded. Spacings that differ by more than this share of the step are unequal.
constexpr double kSpacingTolerance = 0.01;

std::string formatted(const char* format, double first, double second) {
  char text[160];
  // The formats are the constants below.
  std::snprintf(text, sizeof text, format, first, second);
  return text;
}

std::string_view without_comment(std::string_view line) { return line.substr(0, line.find('#')); }

bool is_header(const std::vector<std::string_view>& words) {
  for (const auto word : words) {
    if (number(word)) return false;
  }
  return true;
}

/// What the rows of a file must be.
struct Expected {
  std::size_t columns_max = 0;
  std::string_view columns;  // for messages
};

void append_row(Rows& rows, const std::vector<std::string_view>& words, const Line& line, const std::string& name,
                const Expected& expected) {
  if (rows.columns == 0) rows.columns = words.size();
  if (words.size() != rows.columns || rows.columns > expected.columns_max) {
    refuse(name, line.number,
           "found " + std::to_string(words.size()) + " columns, expected " +
               (rows.columns <= expected.columns_max ? std::to_string(rows.columns) + " as in the lines before"
                                                     : std::string{expected.columns}));
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

}  // namespace

Rows read_rows(const std::vector<Line>& lines, const std::string& name, std::size_t columns_max,
               std::string_view expected) {
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
    append_row(rows, words, line, name, {columns_max, expected});
  }
  if (rows.lines.empty()) {
    refuse(name, lines.back().number,
           "the file holds no values, expected columns of numbers: " + std::string{expected});
  }
  return rows;
}

void check_time_name(const Rows& rows, const std::string& name) {
  if (rows.names.empty()) return;
  const std::string text = upper_case(rows.names.front());
  if (text == "TIME_S" || text == "TIME" || text == "T" || text == "T_S") return;
  refuse(name, rows.names_line,
         "the first column is named " + shown(rows.names.front()) + ", expected 'time_s', the time in seconds");
}

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

}  // namespace hybridtest::motion_text
