#include "coordinator/excitation/force_history.hpp"

#include <cmath>
#include <optional>
#include <utility>

#include "coordinator/excitation/motion_text.hpp"
#include "coordinator/excitation/read_ground_motion.hpp"
#include "coordinator/excitation/text_rows.hpp"
#include "core/input_file.hpp"

namespace hybridtest {
namespace {

/// The name without its unit, and newtons in that unit.
std::optional<std::pair<std::string, double>> named_force(const std::string& column) {
  const std::string text = motion_text::upper_case(column);
  if (text.size() > 3 && text.ends_with("_KN")) return std::pair{column.substr(0, column.size() - 3), 1e3};
  if (text.size() > 2 && text.ends_with("_N")) return std::pair{column.substr(0, column.size() - 2), 1.0};
  return std::nullopt;
}

}  // namespace

ForceHistory parse_force_history(std::string_view text, const std::string& name) {
  constexpr const char* kExpected = "time_s and one or more forces such as roof.x_n";
  text = motion_text::without_byte_order_mark(text);
  const auto lines = motion_text::split_lines(text);
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) {
    motion_text::refuse(name, 1, std::string{"the file is empty, expected columns with the names "} + kExpected);
  }
  const motion_text::Rows rows = motion_text::read_rows(lines, name, kForceColumnsMax + 1, kExpected);
  if (rows.names.empty()) {
    motion_text::refuse(name, rows.lines.front(),
                        std::string{"no line of names before the values, expected the names of the columns with their "
                                    "units: "} +
                            kExpected);
  }
  motion_text::check_time_name(rows, name);
  if (rows.columns < 2) {
    motion_text::refuse(name, rows.names_line, std::string{"one column, expected "} + kExpected);
  }
  const double dt_s = motion_text::even_spacing(rows, name);
  const double start_s = motion_text::start_of(rows, dt_s, name);
  ForceHistory history;
  for (std::size_t column = 1; column < rows.columns; ++column) {
    const auto force = named_force(rows.names[column]);
    if (!force) {
      motion_text::refuse(name, rows.names_line,
                          "the column " + motion_text::shown(rows.names[column]) +
                              " has no unit, expected a name that ends with _n (newtons) or _kn");
    }
    TimeHistory values{.dt_s = dt_s, .start_s = start_s, .values = {}};
    values.values.reserve(rows.lines.size());
    for (std::size_t row = 0; row < rows.lines.size(); ++row) {
      values.values.push_back(rows.value(row, column) * force->second);
      if (std::abs(values.values.back()) <= kForce_n_max) continue;
      motion_text::refuse(name, rows.lines[row], "the force is above 1e15 N; check the unit");
    }
    history.columns.push_back(force->first);
    history.histories.push_back(std::move(values));
  }
  return history;
}

ForceHistory read_force_history(const std::filesystem::path& file) {
  return parse_force_history(read_input_file(file, kGroundMotionBytesMax, "a force history"), file.string());
}

}  // namespace hybridtest
