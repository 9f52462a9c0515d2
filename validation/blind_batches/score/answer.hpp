#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hybridtest::blind {

struct AnsweredParameter {
  double value = 0.0;
  std::optional<std::pair<double, double>> ci95;
};

struct AnsweredCause {
  std::string interface;
  std::string effect;
  double probability = 0.0;
  std::map<std::string, AnsweredParameter> parameters;
};

/// What a scoring looks at in a diagnosis.json (hybridtest/diagnosis/1).
struct Answer {
  std::string verdict;
  std::vector<AnsweredCause> causes;       // most probable first
  std::string faulty_interface;            // of the largest share; empty when none is named
  std::optional<double> variance_removed;  // at the interface, held out

  [[nodiscard]] bool names_a_cause() const { return verdict == "named" || verdict == "set" || verdict == "partial"; }
  [[nodiscard]] bool is_set() const { return verdict == "set"; }
};

/// @throws std::runtime_error that names what is missing or wrong.
[[nodiscard]] Answer read_answer(std::string_view json);

/// Everything that a diagnosis can say, in the order of the confusion matrix; then `missing`, for
/// a case without an answer.
[[nodiscard]] const std::vector<std::string>& known_verdicts();

}  // namespace hybridtest::blind
