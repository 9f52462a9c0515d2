#pragma once

#include <functional>

#include "validation/blind_batches/plant/plant.hpp"
#include "validation/blind_batches/plant/specimen.hpp"

/// Effects outside the library: a diagnosis must answer `unknown`. Each with its own state, to be called once for
/// each fine step; empty for an effect of another stage or of the library.
namespace hybridtest::blind {

/// Displacement with the effect, of the displacement without.
[[nodiscard]] std::function<double(double)> foreign_motion(const PlantEffect& effect, double period_s);
/// Force beside the specimen's. Not `echo`, which needs that.
[[nodiscard]] ForceTerm foreign_force(const PlantEffect& effect, double period_s);
/// Reading of a true value at a place that moves.
[[nodiscard]] std::function<double(const MotionPoint&, double)> foreign_reading(const PlantEffect& effect,
                                                                                double period_s);

}  // namespace hybridtest::blind
