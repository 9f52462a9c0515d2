#pragma once

#include <span>
#include <vector>

#include "diagnosis/recording.hpp"
#include "diagnosis/result/diagnosis_report.hpp"
#include "plant/site_model.hpp"

namespace hybridtest {

/// What is wrong with a channel of a recording, found before any fit or by check_sampling().
struct ChannelFinding {
  report::Finding said;
  std::size_t recording = 0;  // position in the list that was given
  Channel channel{};
  bool is_unusable = false;  // nothing can be judged with this channel
};

/// Checks the measured channels of one degree of freedom of every recording:
///
/// - dead: the channel never changes, or stands still while the motion goes on, or is nothing but noise;
/// - cut off: it follows the motion in no way, and stands at one of two limits for the most part;
/// - unrelated: it follows the motion in no way that a specimen or actuator could make (relation_between()), or so much
///   later or earlier that the channels belong to other times;
/// - reversed: it runs against what the model predicts, and inertia does not explain that; or the force does work on
///   the actuator;
/// - wild: a few single readings hold most of the energy;
/// - sampled too slowly: a tenth of its energy has fewer than four samples per cycle, or fewer than ten where the
///   model's force follows velocity or acceleration;
/// - force and displacement are apart by less than a sample.
///
/// The first five make a channel unusable.
[[nodiscard]] std::vector<ChannelFinding> check_channels(const SiteModel& model, std::span<const Recording> recordings,
                                                         std::size_t dof);

/// What is to be said of the sampling once the causes are known: a recording whose force has fewer than ten samples
/// per cycle in a tenth of its energy, where a cause follows velocity or acceleration and nothing in the model does
/// (check_channels() says it of such a model).
[[nodiscard]] std::vector<ChannelFinding> check_sampling(const SiteModel& model, std::span<const EffectSetting> causes,
                                                         std::span<const Recording> recordings, std::size_t dof);

/// The recordings without their unusable channels; `recordings` itself where there are none.
/// @param copy   holds them.
[[nodiscard]] std::span<const Recording> usable_part(std::span<const Recording> recordings, std::size_t dof,
                                                     std::span<const ChannelFinding> findings,
                                                     std::vector<Recording>& copy);

/// Adds the findings to the report, and to each interface that is not judged for one of them the reason.
void add_findings(std::span<const ChannelFinding> findings, report::DiagnosisReport& report);

}  // namespace hybridtest
