#include "coordinator/excitation/read_ground_motion.hpp"

#include <cmath>

#include "coordinator/excitation/at2_format.hpp"
#include "coordinator/excitation/column_format.hpp"
#include "coordinator/excitation/motion_text.hpp"
#include "core/input_file.hpp"

namespace hybridtest {
namespace {

void check_options(const GroundMotionOptions& options, const std::string& name) {
  if (!std::isfinite(options.scale)) motion_text::refuse(name, 0, "the scale is not a finite number");
  if (options.dt_s && !(std::isfinite(*options.dt_s) && *options.dt_s > 0.0)) {
    motion_text::refuse(name, 0, "the step given for the file is not positive, expected seconds such as 0.005");
  }
}

}  // namespace

GroundMotion parse_ground_motion(std::string_view text, const std::string& name, const GroundMotionOptions& options) {
  check_options(options, name);
  text = motion_text::without_byte_order_mark(text);
  const auto lines = motion_text::split_lines(text);
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) {
    motion_text::refuse(name, 1,
                        "the file is empty, expected a ground motion: PEER AT2, two columns (time, acceleration) or "
                        "one (acceleration)");
  }
  GroundMotion motion = is_at2(lines, name) ? parse_at2(lines, name, options) : parse_columns(lines, name, options);
  if (motion.peak_m_per_s2() > kGroundAcceleration_m_per_s2_max) {
    motion_text::refuse(name, 0,
                        "the largest acceleration after scaling is above 1e6 m/s2; check the unit and the scale");
  }
  return motion;
}

GroundMotion read_ground_motion(const std::filesystem::path& file, const GroundMotionOptions& options) {
  return parse_ground_motion(read_input_file(file, kGroundMotionBytesMax, "a ground motion"), file.string(), options);
}

}  // namespace hybridtest
