#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "diagnosis/identification/segment.hpp"
#include "diagnosis/recording.hpp"
#include "plant/site_model.hpp"

namespace hybridtest {

/// Prediction of one recorded channel by a model whose input is the recorded channel before it.
struct ReplayedChannel {
  std::string_view interface;  // the last one that the prediction passes
  Channel from{};
  Channel to{};
  std::vector<double> predicted;  // one per sample of the recording, in the unit of `to`
  double nrmse = 0.0;             // root mean square of the gap over that of the recorded channel
  double floor_nrmse = 0.0;       // the same, from sensor noise of both channels alone
  double share = 0.0;             // of the energy of all gaps above their floors, each relative to its channel
};

/// Computes each stage of a model with its recorded input, for one degree of freedom, so that an error of one stage
/// does not reach the next. The specimen is omitted if the model has none.
/// @param dof   0-based; the recording has it.
/// @param before   the recording that this one continues, whose history the stages have; may be null.
/// @return in the order of the chain; empty if no two consecutive channels were recorded.
/// @throws ConfigError for parameters that a part of the model does not accept at this sample period.
[[nodiscard]] std::vector<ReplayedChannel> replay(const SiteModel& model, const Recording& recording, std::size_t dof,
                                                  const Recording* before = nullptr);

/// A recording with what was predicted of it, as CSV: `time_s` (`step` of a quasi-static one), the recorded channels,
/// the inputs beside the motion,
/// then `predicted_<channel>`; suffixes `_1`, `_2` … where there are several degrees of freedom. It is a recording
/// itself, which the intake takes.
/// @param replays   one list per degree of freedom.
[[nodiscard]] std::string replay_csv(const Recording& recording,
                                     const std::vector<std::vector<ReplayedChannel>>& replays);

}  // namespace hybridtest
