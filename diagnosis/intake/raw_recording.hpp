#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "diagnosis/intake/finding.hpp"
#include "diagnosis/recording.hpp"

namespace hybridtest {

/// A channel as it was found, before anything is checked.
struct RawColumn {
  std::string name;  // as headed
  Channel channel{};
  std::size_t dof = 0;  // 0-based
  std::vector<double> values;
};

/// A recording as it was found: all columns of one length.
struct RawRecording {
  std::string file;           // as the user named it
  std::size_t first_row = 1;  // how the first sample is counted in findings
  std::vector<double> time_s;
  double time_resolution_s = 0.0;  // of the last digit of the time stamps; 0 when they are not rounded
  std::vector<RawColumn> columns;
};

/// A column's place in a recording.
struct ChannelColumn {
  Channel channel{};
  std::size_t dof = 0;  // 0-based
};

}  // namespace hybridtest
