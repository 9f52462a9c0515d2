#include "diagnosis/report/diagnosis_report.hpp"

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

}  // namespace hybridtest::report
