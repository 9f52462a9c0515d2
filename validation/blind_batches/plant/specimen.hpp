#pragma once

#include "validation/blind_batches/plant/history.hpp"
#include "validation/blind_batches/plant/site.hpp"

namespace hybridtest::blind {

/// True force of the specimen under a motion, fine grid, positive when it resists a positive
/// displacement: the user's law with what the real specimen has besides.
[[nodiscard]] History specimen_force(const Site& site, const PlantEffects& effects, const MotionHistory& motion);

}  // namespace hybridtest::blind
