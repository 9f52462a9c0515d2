#pragma once

#include <string>

#include "coordinator/ground_motion/read_ground_motion.hpp"

namespace hybridtest {

[[nodiscard]] double metres_per_second_squared(AccelerationUnit unit) noexcept;

/// @throws ConfigError when the options give another step than the file's, by more than one percent.
void require_same_step(const std::string& file, int line, double dt_s, const GroundMotionOptions& options);

}  // namespace hybridtest
