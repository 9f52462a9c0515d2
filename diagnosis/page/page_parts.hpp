#pragma once

#include <string>

#include "diagnosis/result/diagnosis_report.hpp"

/// The parts of diagnosis.html, each a piece of HTML; empty where the report has nothing for it.
namespace hybridtest::report {

/// Width of a figure that leaves room for a second one beside it.
inline constexpr double kHalfWidth = 560.0;  // [px]

/// The interfaces from the coordinator to the force sensor with their shares; what is at fault is marked.
[[nodiscard]] std::string chain_part(const DiagnosisReport& report);
/// Gap before and after, floor and unknown share, at the interface and in the whole test.
[[nodiscard]] std::string shrink_part(const DiagnosisReport& report);
/// Causes and alternatives with probabilities and parameters, what could not be told apart, what to do next.
[[nodiscard]] std::string causes_part(const DiagnosisReport& report);
/// Measured against model before and after, residuals, loops or synchronisation subspace.
[[nodiscard]] std::string curves_part(const DiagnosisReport& report);
/// Where inside the interface: time, frequency, motion, distance since reversal, drifting parameters.
[[nodiscard]] std::string location_part(const DiagnosisReport& report);
/// Steps, clipping, rest readings and lag of the measured channels.
[[nodiscard]] std::string sensors_part(const DiagnosisReport& report);
/// Recordings with hashes, every interface in figures, notes.
[[nodiscard]] std::string facts_part(const DiagnosisReport& report);

}  // namespace hybridtest::report
