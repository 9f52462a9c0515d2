#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "validation/blind_batches/plant/case_setting.hpp"
#include "validation/blind_batches/plant/plant.hpp"

namespace hybridtest::blind {

enum class TruthClass { none, named, unknown, pair };

struct Cause {
  std::string interface;
  std::string effect;

  friend bool operator==(const Cause&, const Cause&) = default;
};

/// What is sealed in the key.
struct Truth {
  TruthClass kind = TruthClass::none;
  PlantEffects effects;
  /// Every cause that counts as right: the true ones, and those whose signature explains the gap
  /// of this recording as well as the truth does. Empty for none and unknown.
  std::vector<Cause> acceptable;
  Residual residual = Residual::specimen;  // where the gap is measured
  double gap_to_floor = 0.0;               // rms of the true gap over that of what noise leaves; first fit recording
  double held_out_gap_to_floor = 0.0;
  double variance_removed = 0.0;  // by the true model, of the user model's residual, held out
};

/// One case: what the diagnosis is given, and the truth.
struct BlindCase {
  CaseSetting setting;
  std::vector<PlantRecording> fit;
  PlantRecording held_out;
  Truth truth;
};

/// A given site with given effects.
[[nodiscard]] BlindCase make_case(CaseSetting setting, TruthClass kind, PlantEffects effects, std::uint64_t seed,
                                  std::uint64_t index);

/// Draws all of it; the same for the same seed and index anywhere.
[[nodiscard]] BlindCase draw_case(std::uint64_t seed, std::uint64_t index);

}  // namespace hybridtest::blind
