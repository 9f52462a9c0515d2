#pragma once

#include <functional>

#include "validation/blind_batches/plant/plant.hpp"

/// The stages of the displacement before the actuator; at the rate of the recording.
namespace hybridtest::blind {

/// Sent by the coordinator -> received at the site, which holds the newest that has arrived.
[[nodiscard]] History through_network(const Site& site, const PlantEffects& effects, const History& sent_m);

/// Target -> command: the polynomial extrapolation of Horiuchi et al. (1999) as in
/// docs/scenario.md, by Neville's scheme.
[[nodiscard]] History compensated(const Site& site, const PlantEffects& effects, const History& target_m);

/// Force of the specimen under a motion, both on the fine grid: what loads the actuator.
using LoadOf = std::function<History(const MotionHistory&)>;

/// Command at the recording's rate -> true motion of the actuator on the fine grid. The servo
/// loop is an ordinary differential equation under straight command lines, by the classical Runge-Kutta method.
[[nodiscard]] MotionHistory actuator_motion(const Site& site, const PlantEffects& effects, const History& command_m,
                                            const LoadOf& load);

/// True -> read values on the fine grid, without noise.
/// @param interface   "force_sensor" or "displacement_sensor".
/// @param motion      of the sensor's place: only effects outside the library use it.
[[nodiscard]] History reading(const char* interface, const PlantEffects& effects, const MotionHistory& motion,
                              const History& truth);

}  // namespace hybridtest::blind
