#include "coordinator/ground_motion/motion_text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <system_error>

#include "core/config_error.hpp"

namespace hybridtest::motion_text {
namespace {

constexpr std::size_t kLongestNumber = 64;
constexpr std::size_t kLongestShown = 60;

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\f' || c == '\v'; }

}  // namespace

std::vector<Line> split_lines(std::string_view text) {
  std::vector<Line> lines;
  while (!text.empty()) {
    const std::size_t end = text.find_first_of("\r\n");
    lines.push_back({.text = text.substr(0, end), .number = static_cast<int>(lines.size()) + 1});
    if (end == std::string_view::npos) break;
    // Files that went through several systems end their lines in \r\r\n.
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
  // The library's reader takes no plus sign.
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  if (word.empty() || word.size() > kLongestNumber) return std::nullopt;
  char buffer[kLongestNumber];
  std::transform(word.begin(), word.end(), buffer, [](char c) { return c == 'D' || c == 'd' ? 'E' : c; });
  // Only what a decimal number is made of: the library also reads "nan" and "infinity".
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
  for (const char c : text.substr(0, kLongestShown)) result += c >= ' ' && c <= '~' ? c : '?';
  result += text.size() > kLongestShown ? "…'" : "'";
  return result;
}

void refuse(const std::string& file, int line, const std::string& what) {
  throw ConfigError{{ConfigIssue{.file = file, .line = line, .column = 0, .what = what}}};
}

}  // namespace hybridtest::motion_text
