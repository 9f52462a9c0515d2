#include "diagnosis/verdict/carrying_over.hpp"

#include "diagnosis/tuning.hpp"

namespace hybridtest {

using report::Verdict;

namespace {

/// Of the floor: a limit that is not reached changes nothing at all.
constexpr double kActs = 0.1;

}  // namespace

Verdict verdict_carried_over(Verdict verdict, const report::Shrink& held_out) {
  const bool acts = held_out.changed_nrmse > kActs * held_out.floor_nrmse;
  const bool surely_leaves_most = held_out.ci95 && held_out.ci95->high < tuning::kCarriesOver;
  if (!report::names_a_cause(verdict) || !acts || !surely_leaves_most) return verdict;
  return held_out.nrmse_before > tuning::kUnknownOverFloor * held_out.floor_nrmse ? Verdict::unknown : Verdict::none;
}

}  // namespace hybridtest
