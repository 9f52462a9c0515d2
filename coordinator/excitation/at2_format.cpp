#include "coordinator/excitation/at2_format.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string_view>

namespace hybridtest {
namespace {

using motion_text::Line;
using motion_text::number;
using motion_text::refuse;
using motion_text::shown;
using motion_text::upper_case;

constexpr std::size_t kHeaderLines = 4;
constexpr const char* kExpectedHeader =
    "expected the number of points and the step, as in 'NPTS= 1559, DT= .02000 SEC' or '4000 .0050 NPTS, DT'";

struct Sampling {
  std::size_t points = 0;
  double dt_s = 0.0;
  int line = 0;
};

/// Words of the header line: separated by blanks, commas and equal signs.
std::vector<std::string> header_words(std::string_view line) {
  std::string text = upper_case(line);
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == ',' || c == '=' || c == ';'; }, ' ');
  std::vector<std::string> words;
  for (const auto& word : motion_text::split_words(text, false)) words.emplace_back(word);
  return words;
}

/// The number that belongs to a name: the word after it or, in older files, the number in the same
/// order, all numbers standing before all names.
std::optional<double> named_number(const std::vector<std::string>& words, const std::string& name,
                                   std::size_t place_in_old_files) {
  const auto found = std::find(words.begin(), words.end(), name);
  if (found == words.end()) return std::nullopt;
  if (found + 1 != words.end()) {
    if (const auto value = number(*(found + 1))) return value;
  }
  if (words.size() < 2 || !number(words[0]) || !number(words[1])) return std::nullopt;
  return number(words[place_in_old_files]);
}

Sampling read_sampling(const std::vector<Line>& lines, const std::string& name) {
  const auto header_end = lines.begin() + static_cast<std::ptrdiff_t>(std::min(lines.size(), kHeaderLines));
  const auto header = std::find_if(lines.begin(), header_end, [](const Line& line) {
    const auto words = header_words(line.text);
    return std::find(words.begin(), words.end(), "NPTS") != words.end();
  });
  if (header == header_end) {
    const Line& last = *(header_end - 1);
    refuse(name, last.number, std::string{kExpectedHeader} + " in the first four lines, found " + shown(last.text));
  }
  const auto words = header_words(header->text);
  const auto points = named_number(words, "NPTS", 0);
  const auto dt_s = named_number(words, "DT", 1);
  if (!dt_s) refuse(name, header->number, "the header has no step DT; " + std::string{kExpectedHeader});
  if (!points) refuse(name, header->number, "the header has no number of points; " + std::string{kExpectedHeader});
  if (*dt_s <= 0.0) refuse(name, header->number, "the step DT is not positive, expected seconds such as .005");
  if (*points < 1.0 || *points > static_cast<double>(kGroundMotionPointsMax) || *points != std::floor(*points)) {
    refuse(name, header->number,
           "the number of points NPTS is out of range, expected a whole number from 1 to " +
               std::to_string(kGroundMotionPointsMax));
  }
  return {.points = static_cast<std::size_t>(*points), .dt_s = *dt_s, .line = header->number};
}

/// The values start after four lines, or after the line with NPTS and DT where fewer are before it.
std::size_t first_row(const std::vector<Line>& lines, const Sampling& sampling) {
  const auto after_sampling = static_cast<std::size_t>(sampling.line);
  for (std::size_t row = after_sampling; row < std::min(lines.size(), kHeaderLines); ++row) {
    const auto words = motion_text::split_words(lines[row].text, false);
    if (!words.empty() && number(words.front())) return row;
  }
  return std::max(after_sampling, std::min(lines.size(), kHeaderLines));
}

/// PEER distributes velocity and displacement in the same layout.
AccelerationUnit header_unit(const std::vector<Line>& lines, std::size_t header_lines, const std::string& name,
                             const GroundMotionOptions& options) {
  for (std::size_t row = 0; row < header_lines; ++row) {
    const std::string text = upper_case(lines[row].text);
    for (const char* quantity : {"VELOCITY TIME", "DISPLACEMENT TIME"}) {
      if (text.find(quantity) != std::string::npos) {
        refuse(name, lines[row].number,
               "the header says " + shown(lines[row].text) + ", expected an acceleration record (.AT2)");
      }
    }
    constexpr std::string_view kUnits = "UNITS OF ";
    const std::size_t found = text.find(kUnits);
    if (found == std::string::npos || options.unit) continue;
    const auto unit_words = motion_text::split_words(std::string_view{text}.substr(found + kUnits.size()), true);
    const std::string unit{unit_words.empty() ? std::string_view{} : unit_words.front()};
    if (unit != "G" && unit != "G." && unit != "(G)") {
      refuse(name, lines[row].number,
             "the header gives the unit as " + shown(unit) + ", expected G; name the unit of the file explicitly");
    }
  }
  return options.unit.value_or(AccelerationUnit::g);
}

}  // namespace

bool is_at2(const std::vector<Line>& lines, const std::string& name) {
  if (upper_case(name).ends_with(".AT2")) return true;
  const std::size_t header = std::min(lines.size(), kHeaderLines);
  return std::any_of(lines.begin(), lines.begin() + static_cast<std::ptrdiff_t>(header),
                     [](const Line& line) { return upper_case(line.text).find("NPTS") != std::string::npos; });
}

GroundMotion parse_at2(const std::vector<Line>& lines, const std::string& name, const GroundMotionOptions& options) {
  const Sampling sampling = read_sampling(lines, name);
  require_same_step(name, sampling.line, sampling.dt_s, options);
  const std::size_t begin = first_row(lines, sampling);
  const double factor = metres_per_second_squared(header_unit(lines, begin, name, options)) * options.scale;
  const std::string announced =
      std::to_string(sampling.points) + " values, as given in line " + std::to_string(sampling.line);

  GroundMotion motion{.dt_s = sampling.dt_s, .start_s = 0.0, .acceleration_m_per_s2 = {}};
  for (std::size_t row = begin; row < lines.size(); ++row) {
    for (const auto word : motion_text::split_words(lines[row].text, false)) {
      const auto value = number(word);
      if (!value) refuse(name, lines[row].number, "found " + shown(word) + ", expected an acceleration value");
      if (motion.acceleration_m_per_s2.size() == sampling.points) {
        refuse(name, lines[row].number, "more values follow, expected " + announced);
      }
      motion.acceleration_m_per_s2.push_back(*value * factor);
    }
  }
  if (motion.acceleration_m_per_s2.size() != sampling.points) {
    refuse(name, lines.back().number,
           "the file ends after " + std::to_string(motion.acceleration_m_per_s2.size()) + " values, expected " +
               announced);
  }
  return motion;
}

}  // namespace hybridtest
