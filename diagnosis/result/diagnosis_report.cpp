#include "diagnosis/result/diagnosis_report.hpp"

namespace hybridtest::report {

std::string_view name_of(Verdict verdict) noexcept {
  switch (verdict) {
    case Verdict::none: return "none";
    case Verdict::named: return "named";
    case Verdict::set: return "set";
    case Verdict::partial: return "partial";
    case Verdict::unknown: return "unknown";
    case Verdict::not_excited: return "not_excited";
  }
  return "";
}

bool names_a_cause(Verdict verdict) noexcept {
  return verdict == Verdict::named || verdict == Verdict::set || verdict == Verdict::partial;
}

}  // namespace hybridtest::report
