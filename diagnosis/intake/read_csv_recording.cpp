#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "diagnosis/intake/intake.hpp"
#include "diagnosis/tuning.hpp"

namespace hybridtest {
namespace {

constexpr std::size_t kHeaderRow = 1;

std::string_view trimmed(std::string_view text) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') text = text.substr(1, text.size() - 2);
  return text;
}

/// Removes the text up to and including the separator; returns the text before it.
std::string_view cut(std::string_view& text, char separator) {
  const std::size_t end = std::min(text.find(separator), text.size());
  const std::string_view part = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return part;
}

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  const auto count = static_cast<std::size_t>(std::ranges::count(line, ',')) + 1;
  for (std::size_t i = 0; i < count; ++i) cells.push_back(trimmed(cut(line, ',')));
  return cells;
}

/// The step of the last digit after the decimal point; 0 for numbers with an exponent.
double resolution_of(std::string_view number) {
  if (number.find_first_of("eE") != std::string_view::npos) return 0.0;
  const std::size_t point = number.find('.');
  const std::size_t digits = point == std::string_view::npos ? 0 : number.size() - point - 1;
  return std::pow(10.0, -static_cast<double>(digits));
}

/// Reads a file row by row into columns; a cell that is not a number becomes a finding.
class CsvReader {
 public:
  CsvReader(std::string_view text, const std::string& file, TimeBase time) : rest_{text}, time_{time} {
    raw_.file = file;
    raw_.first_row = kHeaderRow + 1;
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (rest_.starts_with(kByteOrderMark)) rest_.remove_prefix(kByteOrderMark.size());
  }

  Intake read() {
    read_header();
    if (findings_.empty()) read_rows();
    if (!findings_.empty()) return {{}, findings_.sorted()};
    return check_recording(std::move(raw_), time_);
  }

 private:
  static constexpr std::size_t kTime = std::numeric_limits<std::size_t>::max() - 1;
  static constexpr std::size_t kStep = std::numeric_limits<std::size_t>::max() - 2;
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  static constexpr std::size_t kFirstInput = kNone / 2;  // and those after it: the inputs of raw_

  void read_header() {
    const std::string_view line = cut(rest_, '\n');
    if (trimmed(line).empty())
      return findings_.add(0, {}, {}, "the file is empty; expected a header row with the measured columns, and time_s");
    if (line.find(',') == std::string_view::npos && line.find_first_of(";\t") != std::string_view::npos) {
      return findings_.add(
          kHeaderRow, {}, {},
          "columns are separated by semicolons or tabs; expected commas between columns and points in decimal numbers");
    }
    const std::vector<std::string_view> names = cells_of(line);
    if (names.size() > tuning::kColumnsMax) {
      return findings_.add(kHeaderRow, {}, {},
                           fmt::format("{} columns; expected at most {}", names.size(), tuning::kColumnsMax));
    }
    for (const std::string_view name : names) place(std::string{name}, names);
    // Beside time, the number of a step says nothing.
    if (std::ranges::find(target_, kTime) != target_.end()) std::ranges::replace(target_, kStep, kNone);
  }

  /// Where the values of the next column go.
  void place(const std::string& name, const std::vector<std::string_view>& names) {
    names_.push_back(name);
    const auto channel = channel_of_header(name);
    if (is_input_header(name)) return place_input(name);
    const bool is_order = name == kTimeColumn || name == kStepColumn;
    target_.push_back(name == kTimeColumn ? kTime : is_order ? kStep : channel ? raw_.columns.size() : kNone);
    if (!is_order && !channel && !is_left_aside(name)) {
      // A header of numbers probably means that the header row is missing.
      double number = 0.0;
      const bool is_number = std::from_chars(name.data(), name.data() + name.size(), number).ptr != name.data();
      findings_.add(kHeaderRow, name, {},
                    is_number ? "number in the header row; expected a first row with column names such as time_s"
                              : unknown_column_advice(name));
    }
    if (is_order && std::ranges::count(names, std::string_view{name}) > 1) return twice(name);
    if (!channel) return;
    const bool is_there = std::ranges::any_of(raw_.columns, [&](const RawColumn& column) {
      return column.channel == channel->channel && column.dof == channel->dof;
    });
    if (is_there) return twice(name);
    raw_.columns.push_back({name, channel->channel, channel->dof, {}});
  }

  void place_input(const std::string& name) {
    target_.push_back(kFirstInput + raw_.inputs.size());
    if (std::ranges::find(raw_.inputs, name, &RawInput::column) != raw_.inputs.end()) return twice(name);
    raw_.inputs.push_back({name, {}});
  }

  void twice(const std::string& name) {
    findings_.add(kHeaderRow, name, {}, "two columns have this name; remove or rename one");
  }

  void read_rows() {
    const auto expected = static_cast<std::size_t>(std::ranges::count(rest_, '\n')) + 1;
    if (expected > tuning::kSamplesMax + 1) {
      return findings_.add(0, {}, {},
                           fmt::format("too many rows: expected at most {}, because a diagnosis keeps them in memory; "
                                       "cut a part out of the file",
                                       tuning::kSamplesMax));
    }
    raw_.time_s.reserve(expected);
    for (RawColumn& column : raw_.columns) column.values.reserve(expected);
    for (RawInput& input : raw_.inputs) input.values.reserve(expected);
    for (std::size_t row = kHeaderRow + 1; !rest_.empty(); ++row) {
      const std::string_view line = cut(rest_, '\n');
      if (!trimmed(line).empty()) {
        read_row(row, line);
      } else if (rest_.find_first_not_of(" \t\r\n") != std::string_view::npos) {
        findings_.add(row, {}, {}, "empty row; remove it, or fill in its values");
      } else {
        break;  // blank lines at the end
      }
    }
    if (rows_ == 0 && findings_.empty()) findings_.add(0, {}, {}, "a header without data; expected one row per sample");
  }

  void read_row(std::size_t row, std::string_view line) {
    const auto cells = static_cast<std::size_t>(std::ranges::count(line, ',')) + 1;
    if (cells != names_.size()) {
      findings_.add(row, {}, {},
                    fmt::format("{} cells in this row; expected {} as in the header", cells, names_.size()));
      return;
    }
    ++rows_;
    for (std::size_t i = 0; i < names_.size(); ++i) {
      const std::string_view cell = trimmed(cut(line, ','));
      if (target_[i] == kNone) continue;
      const double value = number(row, names_[i], cell);
      if (target_[i] == kTime) {
        raw_.time_s.push_back(value);
        // Programs drop trailing zeros: the row with the most digits shows the resolution.
        const double resolution_s = resolution_of(cell);
        if (raw_.time_s.size() == 1 || resolution_s < raw_.time_resolution_s) raw_.time_resolution_s = resolution_s;
      } else if (target_[i] == kStep) {
        raw_.step.push_back(value);
      } else if (target_[i] >= kFirstInput) {
        raw_.inputs[target_[i] - kFirstInput].values.push_back(value);
      } else {
        raw_.columns[target_[i]].values.push_back(value);
      }
    }
  }

  double number(std::size_t row, const std::string& column, std::string_view cell) {
    if (cell.empty()) {
      findings_.add(row, column, {}, "empty cell; expected a number");
      return 0.0;
    }
    double value = 0.0;
    const std::string_view digits = cell.size() > 1 && cell.front() == '+' ? cell.substr(1) : cell;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc{} || end != digits.data() + digits.size()) {
      findings_.add(row, column, std::string{cell}, "not a number; expected digits with a decimal point and no unit");
      return 0.0;
    }
    if (!std::isfinite(value))
      findings_.add(row, column, std::string{cell},
                    "not a finite number; expected a number, replace or remove this part of the recording");
    return value;
  }

  std::string_view rest_;
  TimeBase time_;
  std::size_t rows_ = 0;
  RawRecording raw_;
  std::vector<std::string> names_;
  std::vector<std::size_t> target_;  // per column of the file: its place in raw_, an input, kTime, kStep or kNone
  FindingList findings_;
};

}  // namespace

Intake read_csv_recording(std::string_view text, const std::string& file, TimeBase time) {
  return CsvReader{text, file, time}.read();
}

}  // namespace hybridtest
