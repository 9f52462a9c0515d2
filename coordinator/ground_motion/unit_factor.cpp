#include "coordinator/ground_motion/unit_factor.hpp"

#include <cmath>
#include <cstdio>

#include "coordinator/ground_motion/motion_text.hpp"

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
                "the file's step is %.6g s, expected the %.6g s that were given with it; leave the step out", dt_s,
                *options.dt_s);
  motion_text::refuse(file, line, text);
}

}  // namespace hybridtest
