#pragma once

#include "diagnosis/report/diagnosis_report.hpp"

namespace hybridtest {

/// What may be said of causes once recordings that were not fitted were looked at: a cause that acts there and surely
/// leaves most of the gap is none, however well it goes with the recordings that it was found in.
/// @param verdict    by the recordings of the fit.
/// @param held_out   of recordings that were not fitted.
[[nodiscard]] report::Verdict verdict_carried_over(report::Verdict verdict, const report::Shrink& held_out);

}  // namespace hybridtest
