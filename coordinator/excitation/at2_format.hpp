#pragma once

#include <string>
#include <vector>

#include "coordinator/excitation/motion_text.hpp"
#include "coordinator/excitation/read_ground_motion.hpp"

namespace hybridtest {

/// Whether a file is PEER AT2: its name ends in .AT2, or one of its first lines contains NPTS.
[[nodiscard]] bool is_at2(const std::vector<motion_text::Line>& lines, const std::string& name);

/// @throws ConfigError as read_ground_motion().
[[nodiscard]] GroundMotion parse_at2(const std::vector<motion_text::Line>& lines, const std::string& name,
                                     const GroundMotionOptions& options);

}  // namespace hybridtest
