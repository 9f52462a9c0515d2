#pragma once

#include <string>
#include <vector>

#include "coordinator/excitation/motion_text.hpp"
#include "coordinator/excitation/read_ground_motion.hpp"

namespace hybridtest {

/// One or two columns of text. @throws ConfigError as read_ground_motion().
[[nodiscard]] GroundMotion parse_columns(const std::vector<motion_text::Line>& lines, const std::string& name,
                                         const GroundMotionOptions& options);

}  // namespace hybridtest
