#pragma once

#include <string>

#include "diagnosis/result/diagnosis_report.hpp"

namespace hybridtest {

/// The name of the file in the folder of a diagnosis.
inline constexpr const char* kPredictionFile = "prediction.csv";

/// What the model predicts beside what was measured, for other programs and for `hybridtest report --compare`: a row
/// per sample, `interface,dof,unit,time_s,measured,modelled,completed,recording`. Time counts from the first sample;
/// `completed`, with the causes added, is empty where there are none.
[[nodiscard]] std::string prediction_csv(const report::DiagnosisReport& report);

}  // namespace hybridtest
