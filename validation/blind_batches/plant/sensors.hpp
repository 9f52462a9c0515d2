#pragma once

#include "validation/blind_batches/plant/history.hpp"
#include "validation/blind_batches/plant/site.hpp"

namespace hybridtest::blind {

/// True -> read values on the fine grid, without noise.
/// @param interface   "force_sensor" or "displacement_sensor".
/// @param motion      of the sensor's place: only effects that no library has look at it.
[[nodiscard]] History reading(const char* interface, const PlantEffects& effects, const MotionHistory& motion,
                              const History& truth);

}  // namespace hybridtest::blind
