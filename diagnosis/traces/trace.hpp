#pragma once

#include <span>
#include <vector>

#include "diagnosis/recording.hpp"
#include "plant/site_model.hpp"

namespace hybridtest {

/// An effect that shows in the digits of a recording: no fit can follow it, sample by sample, and none is needed.
struct Trace {
  EffectSetting effect;
  Channel in{};            // whose gap it makes
  double gap_share = 0.0;  // mean square of that gap over the channel's own, summed over recordings
};

/// Of a kind that find_traces() looks for: it draws its course from a seed, or coarsens readings.
[[nodiscard]] bool shows_in_digits(const EffectType& effect) noexcept;

/// What the recordings of the role fit show of lost and late packets and of coarse converters, beyond what the model
/// has already. An effect that several show is listed once, as the first one shows it.
[[nodiscard]] std::vector<Trace> find_traces(const SiteModel& model, std::span<const Recording> recordings,
                                             std::size_t dof);

}  // namespace hybridtest
