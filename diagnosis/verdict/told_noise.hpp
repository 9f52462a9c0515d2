#pragma once

#include <span>
#include <vector>

#include "diagnosis/identification/effect_fit.hpp"
#include "diagnosis/identification/problem.hpp"

namespace hybridtest {

/// What an actuator leaves of a measured displacement, where that is no more than noise, is the noise of the readings
/// that the specimen's prediction starts from: coloured noise and hum with it. Less what the force answers, which is
/// motion. Nothing is told by the problem of another channel.
/// @param problem     with the measured displacement to explain, its noise settled beside `chosen`.
/// @param completed   the model with what was chosen.
/// @param segments    of them those of the specimen get Segment::told_noise.
/// @return whether any segment was told.
bool tell_noise(const IdentificationProblem& problem, const FitOutcome& chosen, const SiteModel& completed,
                std::vector<Segment>& segments);

/// The same of recordings that were not fitted, as large as the fitted ones say: `problem` and `chosen` as above.
/// @param completed   the model with all causes.
void tell_held_out_noise(const IdentificationProblem& problem, const FitOutcome& chosen, const SiteModel& completed,
                         std::span<Segment> held_out);

}  // namespace hybridtest
