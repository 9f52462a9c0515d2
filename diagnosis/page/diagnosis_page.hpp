#pragma once

#include <string>

#include "diagnosis/result/diagnosis_report.hpp"

namespace hybridtest::report {

/// diagnosis.html: one page that opens without a network, figures inline, curves thinned to what a screen shows; light
/// or dark as the reader's system is set. The script inside it zooms and saves the figures; the page reads well
/// without.
[[nodiscard]] std::string diagnosis_page(const DiagnosisReport& report);

}  // namespace hybridtest::report
