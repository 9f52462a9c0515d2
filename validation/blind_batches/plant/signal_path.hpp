#pragma once

#include "validation/blind_batches/plant/history.hpp"
#include "validation/blind_batches/plant/site.hpp"

/// What happens to the displacement before it reaches the actuator; at the recording's rate.
namespace hybridtest::blind {

/// Sent by the coordinator -> received at the site, which holds the newest that has arrived.
[[nodiscard]] History through_network(const Site& site, const PlantEffects& effects, const History& sent_m);

/// Target -> command: the polynomial extrapolation of Horiuchi et al. (1999) as in
/// docs/scenario.md, by Neville's scheme.
[[nodiscard]] History compensated(const Site& site, const PlantEffects& effects, const History& target_m);

}  // namespace hybridtest::blind
