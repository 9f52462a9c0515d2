#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "diagnosis/identification/segment.hpp"
#include "diagnosis/recording.hpp"
#include "plant/site_model.hpp"

namespace hybridtest {

/// What a model predicts for one recorded channel, driven with what was recorded in front of it.
struct ReplayedChannel {
  std::string_view interface;  // that the prediction passes, the last of them
  Channel from{};
  Channel to{};
  std::vector<double> predicted;  // one per sample of the recording, in the unit of `to`
  double nrmse = 0.0;             // root mean square of the gap over that of the recorded channel
  double floor_nrmse = 0.0;       // what noise in both channels makes of it
  double share = 0.0;             // of what all channels have above their floors, energies relative to their own
};

/// Drives a model stage by stage with one degree of freedom of a recording, so that an error of one stage
/// does not reach the next. A specimen is left out where the model says nothing of its force.
/// @param dof   0-based; the recording has it.
/// @return in the order of the chain; empty where no two neighbouring channels were recorded.
/// @throws ConfigError for parameters that the model's parts refuse at this sample period.
[[nodiscard]] std::vector<ReplayedChannel> replay(const SiteModel& model, const Recording& recording, std::size_t dof);

/// A recording with what was predicted of it, as CSV: `time_s`, the recorded channels, then
/// `predicted_<channel>`; suffixes `_1`, `_2` … where there are several degrees of freedom. It is a
/// recording itself, which the intake takes.
/// @param replays   one list per degree of freedom.
[[nodiscard]] std::string replay_csv(const Recording& recording,
                                     const std::vector<std::vector<ReplayedChannel>>& replays);

}  // namespace hybridtest
