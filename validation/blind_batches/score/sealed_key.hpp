#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "validation/blind_batches/plant/blind_case.hpp"

namespace hybridtest::blind {

/// A case of the key, as it was written by truth_json().
struct KeyCase {
  std::string name;
  TruthClass truth = TruthClass::none;
  PlantEffects effects;
  std::vector<Cause> acceptable;
  std::string gap_at;
  double gap_to_floor = 0.0;
  double held_out_gap_to_floor = 0.0;
  double variance_removed = 0.0;
};

/// @throws std::runtime_error for what is no key.
[[nodiscard]] std::vector<KeyCase> read_key(std::string_view json);

}  // namespace hybridtest::blind
