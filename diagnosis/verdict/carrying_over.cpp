#include "diagnosis/verdict/carrying_over.hpp"

#include <algorithm>
#include <cmath>

#include "diagnosis/tuning.hpp"

namespace hybridtest {

using report::Shrink;
using report::Verdict;

namespace {

/// Of the floor: a limit that is not reached changes nothing at all.
constexpr double kActs = 0.1;

/// It acts, and surely leaves most of what there is, or more of what could be explained than a cause in part may.
bool contradicts(const Shrink& held_out) {
  if (!held_out.ci95 || !(held_out.changed_nrmse > kActs * held_out.floor_nrmse)) return false;
  const double explainable = 1.0 - std::pow(held_out.floor_nrmse / held_out.nrmse_before, 2);
  return held_out.ci95->high < std::max(tuning::kCarriesOver, (1.0 - tuning::kPartialLeaves) * explainable);
}

}  // namespace

Verdict verdict_carried_over(Verdict verdict, std::span<const Shrink> held_out) {
  if (!report::names_a_cause(verdict) || held_out.empty() || !std::ranges::all_of(held_out, contradicts)) {
    return verdict;
  }
  const bool is_clear = std::ranges::any_of(
      held_out, [](const Shrink& one) { return one.nrmse_before > tuning::kUnknownOverFloor * one.floor_nrmse; });
  return is_clear ? Verdict::unknown : Verdict::none;
}

}  // namespace hybridtest
