#pragma once

#include <optional>
#include <string>
#include <vector>

#include "validation/blind_batches/score/answer.hpp"
#include "validation/blind_batches/score/sealed_key.hpp"
#include "validation/blind_batches/score/statistics.hpp"

namespace hybridtest::blind {

struct ParameterError {
  std::string name;  // coulomb_friction.friction_force_n
  double relative = 0.0;
  std::optional<bool> is_in_interval;
};

/// An answer beside the truth. What a case says nothing about is left empty.
struct MarkedCase {
  KeyCase key;
  Answer answer;
  std::optional<bool> is_interface_right;      // named, pair, unknown
  std::optional<bool> is_effect_right;         // named, pair
  std::optional<bool> is_single_name_right;    // named, where no other cause is acceptable
  std::optional<bool> is_falsely_named;        // none, unknown
  std::optional<bool> is_true_one_covered;     // named and answered by a set
  std::optional<bool> are_both_found;          // pair
  std::optional<std::size_t> causes_answered;  // named and answered by a name or set; named: 1
  std::optional<Forecast> forecast;            // where a cause is named
  std::optional<double> variance_short;        // true model's variance removed less the answer's, effect right
  std::vector<ParameterError> parameter_errors;

  /// Twice the floor or more in the first fit recording and the held-out one; or nothing to be found.
  [[nodiscard]] bool is_clear() const;
  [[nodiscard]] bool is_wrong() const;
};

/// @param answer   nullopt: missing.
[[nodiscard]] MarkedCase mark(const KeyCase& key, const std::optional<Answer>& answer);

}  // namespace hybridtest::blind
