#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "diagnosis/diagnose.hpp"

namespace hybridtest {

/// `coulomb_friction`; of one that follows a recorded input `force_with_input:current_a`.
inline std::vector<std::string> effects_of(const std::vector<report::RankedCause>& entries) {
  std::vector<std::string> effects;
  for (const report::RankedCause& entry : entries) {
    effects.push_back(entry.effect + (entry.input.empty() ? "" : ":" + entry.input));
  }
  return effects;
}

/// Likewise, of the causes, by name.
inline std::vector<std::string> causes_of(const Diagnosis& diagnosis) {
  std::vector<report::RankedCause> causes;
  for (const report::RankedCause& entry : diagnosis.report.ranking) {
    if (entry.is_cause) causes.push_back(entry);
  }
  std::vector<std::string> effects = effects_of(causes);
  std::ranges::sort(effects);
  return effects;
}

}  // namespace hybridtest
