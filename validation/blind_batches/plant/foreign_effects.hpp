#pragma once

#include "validation/blind_batches/plant/plant.hpp"

/// Effects outside the library: a diagnosis must answer `unknown`. On the fine grid;
/// an effect of another stage is ignored.
namespace hybridtest::blind {

void apply_foreign_to_actuator(const PlantEffect& effect, double period_s, History& displacement_m);
void add_foreign_force(const PlantEffect& effect, const Site& site, const MotionHistory& motion, History& force_n);
void read_with_foreign(const PlantEffect& effect, const MotionHistory& motion, History& read);

}  // namespace hybridtest::blind
