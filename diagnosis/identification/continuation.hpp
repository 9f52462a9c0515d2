#pragma once

#include <optional>
#include <span>
#include <vector>

#include "diagnosis/identification/segment.hpp"
#include "diagnosis/recording.hpp"
#include "plant/site_model.hpp"

namespace hybridtest {

/// Whether `later` goes on where `earlier` ends: its first time stamp or step follows the last one of `earlier` within
/// one and a half intervals, both have the same period, and the motion of the degree of freedom goes on too, without a
/// jump of more than the largest one before.
[[nodiscard]] bool continues(const Recording& earlier, const Recording& later, std::size_t dof);

/// Position of the recording that `recordings[position]` continues.
[[nodiscard]] std::optional<std::size_t> continued_by(std::span<const Recording> recordings, std::size_t position,
                                                      std::size_t dof);

/// Gives each segment of a recording that continues another one the segment before it (Segment::history), and that one
/// its own: a specimen that has yielded or degraded does not begin anew.
void carry_history(const SiteModel& model, std::span<const Recording> recordings, std::size_t dof,
                   std::vector<Segment>& segments);

/// The same for segments of one recording, after the one before it.
void carry_history(const SiteModel& model, const Recording& earlier, std::size_t dof, std::vector<Segment>& segments);

}  // namespace hybridtest
