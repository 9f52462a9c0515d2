#pragma once

#include "validation/blind_batches/plant/history.hpp"
#include "validation/blind_batches/plant/site.hpp"

namespace hybridtest::blind {

/// Restoring force of a law that a user can name in a model, over a whole displacement history.
/// Written from docs/scenario.md and the literature: elastic; bilinear with kinematic hardening;
/// Giuffre-Menegotto-Pinto (Filippou, Popov and Bertero, EERC 83-19, 1983); Bouc-Wen with n = 1,
/// whose differential equation has a closed solution along a path that does not turn.
/// Zero for none.
/// @param yield_share   empty, or what is left of the yield force of a bilinear law at every step.
[[nodiscard]] History law_force(const LawModel& law, const History& displacement_m, const History& yield_share = {});

}  // namespace hybridtest::blind
