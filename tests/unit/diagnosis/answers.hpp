#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "diagnosis/diagnose.hpp"

namespace hybridtest {

/// Of one recording that is fitted, on two threads.
inline Diagnosis diagnosis_of(const SiteModel& model, const Recording& recording) {
  DiagnoseSettings settings;
  settings.threads = 2;
  return diagnose(model, {&recording, 1}, settings);
}

/// null: the cause has none of that name.
inline const report::ReportedParameter* find_parameter(const report::RankedCause& cause, std::string_view name) {
  const auto found = std::ranges::find(cause.parameters, name, &report::ReportedParameter::name);
  return found == cause.parameters.end() ? nullptr : &*found;
}

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
