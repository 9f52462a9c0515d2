#pragma once

#include <functional>
#include <string>

#include "validation/blind_batches/plant/blind_case.hpp"
#include "validation/blind_batches/plant/plant.hpp"

/// Specimens whose law has another form than the user's: truth of the effect `hysteresis_law`. None of them is
/// written as the law that a diagnosis would name for it.
namespace hybridtest::blind {

/// Force over displacement, one fine step after the other.
using Spring = std::function<double(const MotionPoint&)>;

/// Parameters common to all: `stiffness_n_per_m`, `yield_force_n`, `hardening_ratio`; the others in
/// docs/blind_batches.md.
/// @param effect   `hysteresis_law`; its `law` is one of foreign_laws().
[[nodiscard]] Spring foreign_law(const PlantEffect& effect);

/// The names of the laws.
[[nodiscard]] const std::vector<std::string>& foreign_laws();

/// A law of another form beside a user's model with a spring; its stiffness and strength are the user's
/// where that has them.
[[nodiscard]] PlantEffect draw_foreign_law(const CaseSetting& setting, RandomStream& random);

/// Every answer that is right about it beside the given user's law.
[[nodiscard]] std::vector<Cause> names_of_law(const std::string& law, LawKind users);
/// And those that are right only as a part of it, in an answer `partial`.
[[nodiscard]] std::vector<Cause> parts_of_law(LawKind users);

}  // namespace hybridtest::blind
