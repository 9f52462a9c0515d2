#pragma once

#include <functional>

#include "validation/blind_batches/plant/history.hpp"
#include "validation/blind_batches/plant/site.hpp"

namespace hybridtest::blind {

/// Force of the specimen under a motion, both on the fine grid: what loads the actuator.
using LoadOf = std::function<History(const MotionHistory&)>;

/// Command at the recording's rate -> true motion of the actuator on the fine grid. The servo
/// loop is an ordinary differential equation under straight command lines, by the classical Runge-Kutta method.
[[nodiscard]] MotionHistory actuator_motion(const Site& site, const PlantEffects& effects, const History& command_m,
                                            const LoadOf& load);

}  // namespace hybridtest::blind
