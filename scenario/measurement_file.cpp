#include "scenario/measurement_file.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "core/config_error.hpp"
#include "core/input_file.hpp"

namespace hybridtest {
namespace {

/// Largest recording that is replayed.
constexpr std::size_t kBytesMax = std::size_t{1} << 30U;

std::vector<std::string_view> split(std::string_view line) {
  if (line.ends_with('\r')) line.remove_suffix(1);
  std::vector<std::string_view> fields;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    fields.push_back(line.substr(begin, end - begin));
    begin = end + 1;
  }
  return fields;
}

/// The file as a table, read line by line.
class Lines {
 public:
  explicit Lines(const std::filesystem::path& file)
      : file_{file}, stream_{read_input_file(file, kBytesMax, "a recorded measurement (CSV)")} {
    if (!std::getline(stream_, line_)) refuse("is empty; expected a recorded measurement (CSV)");
    names_ = line_;
    header_ = split(names_);
  }

  /// Where the column stands.
  [[nodiscard]] std::size_t column(const std::string& name) const {
    const auto found = std::ranges::find(header_, name);
    if (found == header_.end()) refuse("has no column '" + name + "'");
    if (std::ranges::count(header_, name) > 1) refuse("has the column '" + name + "' twice");
    return static_cast<std::size_t>(found - header_.begin());
  }

  /// @return false behind the last line.
  [[nodiscard]] bool next() {
    if (!std::getline(stream_, line_)) return false;
    ++number_;
    fields_ = split(line_);
    if (fields_.size() != header_.size()) {
      refuse("has " + std::to_string(fields_.size()) + " values for " + std::to_string(header_.size()) + " columns");
    }
    return true;
  }

  [[nodiscard]] double value(std::size_t column) const {
    const std::string_view text = fields_[column];
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) {
      refuse("column '" + std::string{header_[column]} + "': expected a finite number, found '" +
             std::string{text.substr(0, 40)} + "'");
    }
    return value;
  }

  [[noreturn]] void refuse(const std::string& what) const {
    throw ConfigError{file_.string() + (number_ > 1 ? ":" + std::to_string(number_) : "") + ": " + what};
  }

 private:
  std::filesystem::path file_;
  std::istringstream stream_;
  std::string names_;
  std::string line_;
  int number_ = 1;
  std::vector<std::string_view> header_;
  std::vector<std::string_view> fields_;
};

}  // namespace

RecordedMeasurement read_measurement(const std::filesystem::path& file, int actuators) {
  Lines lines{file};
  const std::size_t time = lines.column("time_s");
  std::vector<std::size_t> displacements;
  std::vector<std::size_t> forces;
  for (int i = 1; i <= actuators; ++i) {
    const std::string suffix = actuators == 1 ? "" : "_" + std::to_string(i);
    displacements.push_back(lines.column("measured_displacement_m" + suffix));
    forces.push_back(lines.column("measured_force_n" + suffix));
  }
  const auto values_of = [&](const std::vector<std::size_t>& columns) {
    SiteVector values{actuators};
    for (Eigen::Index i = 0; i < actuators; ++i) values[i] = lines.value(columns[static_cast<std::size_t>(i)]);
    return values;
  };
  RecordedMeasurement record;
  while (lines.next()) {
    const double time_s = lines.value(time);
    if (!record.time_s.empty() && !(time_s > record.time_s.back())) {
      lines.refuse("its time is not later than that of the line before");
    }
    record.time_s.push_back(time_s);
    record.displacement_m.push_back(values_of(displacements));
    record.force_n.push_back(values_of(forces));
  }
  if (record.time_s.empty()) lines.refuse("has no rows");
  return record;
}

}  // namespace hybridtest
