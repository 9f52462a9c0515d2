#pragma once

#include <vector>

#include "diagnosis/identification/problem.hpp"

namespace hybridtest {

/// A parameter that a search varies between 0 and 1, spread over its range; evenly in its logarithm
/// where the range spans more than a decade of positive values.
struct SearchedParameter {
  std::size_t effect = 0;
  std::size_t parameter = 0;
  double low = 0.0;
  double high = 0.0;
  bool logarithmic = false;
  // A time in the record: it is felt in one place only, which derivatives do not see from afar.
  bool is_instant = false;

  [[nodiscard]] double at(double place) const noexcept;
  [[nodiscard]] double place_of(double value) const noexcept;
};

/// A parameter that the prediction is linear in.
struct LinearParameter {
  std::size_t effect = 0;
  std::size_t parameter = 0;
  double unit = 1.0;  // a change that the recording would show
  double low = 0.0;
  double high = 0.0;
};

/// Which parameters of a list of effects are searched, which are linear and which stay as they are.
struct SearchPlan {
  std::vector<EffectSetting> neutral;  // linear parameters absent, searched ones anywhere, the others at their fallback
  std::vector<SearchedParameter> searched;
  std::vector<LinearParameter> linear;
  bool linear_ones_remove_all = false;  // without them every effect is absent
};

[[nodiscard]] SearchPlan plan_search(const IdentificationProblem& problem,
                                     const std::vector<const EffectType*>& effects);

/// Nothing to search for in a parameter: its fallback is used.
[[nodiscard]] bool is_fixed(const IdentificationProblem& problem, const EffectType& effect,
                            const EffectParameter& parameter);

}  // namespace hybridtest
