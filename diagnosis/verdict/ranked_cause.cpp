#include "diagnosis/verdict/ranked_cause.hpp"

#include <algorithm>

namespace hybridtest {

report::RankedCause ranked(const EffectSetting& effect, const std::vector<ParameterEstimate>& estimates) {
  constexpr double kTwoSided95 = 1.96;
  report::RankedCause cause;
  cause.interface = name_of(effect.type->interface);
  cause.effect = effect.type->name;
  cause.equation = effect.type->equation;
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    const EffectParameter& parameter = effect.type->parameters[i];
    report::ReportedParameter reported;
    reported.name = parameter.name;
    reported.unit = parameter.unit;
    reported.value = estimates[i].value;
    reported.is_at_bound = estimates[i].at_bound;
    const double half = kTwoSided95 * estimates[i].standard_error;
    if (half > 0.0) reported.ci95 = report::Interval{reported.value - half, reported.value + half};
    cause.parameters.push_back(std::move(reported));
  }
  return cause;
}

void put_causes_first(std::vector<report::RankedCause>& ranking) {
  std::ranges::stable_sort(ranking, [](const report::RankedCause& a, const report::RankedCause& b) {
    return a.is_cause && (!b.is_cause || a.share > b.share);
  });
}

void scale_shares(std::vector<report::InterfaceGap>& where, double kept) {
  for (report::InterfaceGap& gap : where) {
    gap.share *= kept;
    gap.share_ci95 = {gap.share_ci95.low * kept, gap.share_ci95.high * kept};
  }
}

}  // namespace hybridtest
