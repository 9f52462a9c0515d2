#pragma once

#include "validation/blind_batches/plant/plant.hpp"

namespace hybridtest::blind {

/// An effect's parameters by the names and units of the effect library, if the plant's
/// form of it has them, so that an answer can be compared with them. The tables of docs/scenario.md
/// and docs/blind_batches.md combined; the plant itself does not use the library.
[[nodiscard]] Parameters in_library_terms(const Site& site, const PlantEffect& effect);

}  // namespace hybridtest::blind
