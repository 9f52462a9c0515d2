#include "coordinator/excitation/motion_text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <system_error>

#include "core/config_error.hpp"

namespace hybridtest::motion_text {
namespace {

constexpr std::size_t kNumberLengthMax = 64;
constexpr std::size_t kShownLengthMax = 60;

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\f' || c == '\v'; }

}  // namespace

std::string_view without_byte_order_mark(std::string_view text) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  return text.starts_with(kByteOrderMark) ? text.substr(kByteOrderMark.size()) : text;
}

std::vector<Line> split_lines(std::string_view text) {
  std::vector<Line> lines;
  while (!text.empty()) {
    const std::size_t end = text.find_first_of("\r\n");
    lines.push_back({.text = text.substr(0, end), .number = static_cast<int>(lines.size()) + 1});
    if (end == std::string_view::npos) break;
    // Files converted between operating systems can end their lines in \r\r\n.
    const std::size_t after_returns = text.find_first_not_of('\r', end);
    const bool has_feed = after_returns != std::string_view::npos && text[after_returns] == '\n';
    text.remove_prefix(has_feed ? after_returns + 1 : end + 1);
  }
  return lines;
}

std::vector<std::string_view> split_words(std::string_view line, bool comma_separates) {
  std::vector<std::string_view> words;
  std::size_t position = 0;
  bool expects_word = false;  // a comma has been seen and nothing since
  while (true) {
    while (position < line.size() && is_blank(line[position])) ++position;
    if (position >= line.size()) break;
    if (comma_separates && line[position] == ',') {
      if (expects_word || words.empty()) words.push_back(line.substr(position, 0));
      expects_word = true;
      ++position;
      continue;
    }
    const std::size_t begin = position;
    while (position < line.size() && !is_blank(line[position]) && !(comma_separates && line[position] == ',')) {
      ++position;
    }
    words.push_back(line.substr(begin, position - begin));
    expects_word = false;
    while (position < line.size() && is_blank(line[position])) ++position;
    if (comma_separates && position < line.size() && line[position] == ',') {
      expects_word = true;
      ++position;
    }
  }
  if (expects_word) words.push_back(line.substr(line.size()));
  return words;
}

std::optional<double> number(std::string_view word) {
  // std::from_chars accepts no plus sign.
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  if (word.empty() || word.size() > kNumberLengthMax) return std::nullopt;
  char buffer[kNumberLengthMax];
  std::transform(word.begin(), word.end(), buffer, [](char c) { return c == 'D' || c == 'd' ? 'E' : c; });
  // Only characters of a decimal number: std::from_chars also reads "nan" and "infinity".
  if (std::any_of(buffer, buffer + word.size(), [](char c) {
        return (c < '0' || c > '9') && c != '.' && c != '-' && c != '+' && c != 'E' && c != 'e';
      })) {
    return std::nullopt;
  }
  double value = 0.0;
  const auto [end, error] = std::from_chars(buffer, buffer + word.size(), value);
  if (error != std::errc{} || end != buffer + word.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::string upper_case(std::string_view text) {
  std::string result{text};
  std::transform(result.begin(), result.end(), result.begin(),
                 [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
  return result;
}

std::string shown(std::string_view text) {
  std::string result{"'"};
  for (const char c : text.substr(0, kShownLengthMax)) result += c >= ' ' && c <= '~' ? c : '?';
  result += text.size() > kShownLengthMax ? "…'" : "'";
  return result;
}

void refuse(const std::string& file, int line, const std::string& what) {
  throw ConfigError{{ConfigIssue{.file = file, .line = line, .column = 0, .what = what}}};
}

}  // namespace hybridtest::motion_text

namespace hybridtest {

double metres_per_second_squared(AccelerationUnit unit) noexcept {
  switch (unit) {
    case AccelerationUnit::g: return kStandardGravity_m_per_s2;
    case AccelerationUnit::cm_per_s2: return 0.01;
    case AccelerationUnit::m_per_s2: break;
  }
  return 1.0;
}

void require_same_step(const std::string& file, int line, double dt_s, const GroundMotionOptions& options) {
  if (!options.dt_s || std::abs(*options.dt_s - dt_s) <= 0.01 * dt_s) return;
  char text[160];
  std::snprintf(text, sizeof text,
                "the step in the file is %.6g s, the step given for the file is %.6g s; leave out the latter", dt_s,
                *options.dt_s);
  motion_text::refuse(file, line, text);
}

}  // namespace hybridtest
