#include "coordinator/excitation/column_format.hpp"

#include <cstddef>
#include <optional>

#include "coordinator/excitation/text_rows.hpp"

namespace hybridtest {
namespace {

using motion_text::refuse;
using motion_text::Rows;
using motion_text::shown;
using motion_text::upper_case;

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

}  // namespace

GroundMotion parse_columns(const std::vector<motion_text::Line>& lines, const std::string& name,
                           const GroundMotionOptions& options) {
  const Rows rows = motion_text::read_rows(lines, name, 2, "one (acceleration) or two (time, acceleration)");
  if (rows.columns == 2) motion_text::check_time_name(rows, name);
  const double factor = metres_per_second_squared(unit_of(rows, name, options)) * options.scale;
  GroundMotion motion;
  if (rows.columns == 2) {
    motion.dt_s = motion_text::even_spacing(rows, name);
    require_same_step(name, rows.lines.front(), motion.dt_s, options);
    motion.start_s = motion_text::start_of(rows, motion.dt_s, name);
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
