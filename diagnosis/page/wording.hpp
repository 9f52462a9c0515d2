#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "diagnosis/result/diagnosis_report.hpp"

/// The texts of the diagnosis page: names, quantities and the sentence of the verdict.
namespace hybridtest::report {

/// `transfer_system` as `transfer system`.
[[nodiscard]] std::string plain(std::string_view name);
/// A parameter without the unit that its name ends with: `friction_force_n` as `friction force`.
[[nodiscard]] std::string plain_parameter(std::string_view name, std::string_view unit);
/// Input and output of an interface, in a few words: `command to displacement`.
[[nodiscard]] std::string sees(std::string_view interface);
/// Three digits with a suitable unit prefix, kept on one line: `16.6 ms`, `512 N`, `4.00 MN/m`.
[[nodiscard]] std::string quantity(double value, std::string_view unit);
/// `12 %`; more digits near 0 % and near 100 %.
[[nodiscard]] std::string percent(double share);
/// `498 N to 527 N`
[[nodiscard]] std::string between(const Interval& interval, std::string_view unit);
[[nodiscard]] std::string between_percent(const Interval& interval);
/// `a`, `a and b`, `a, b and c`.
[[nodiscard]] std::string joined(const std::vector<std::string>& words);

/// The interface at fault whose share is largest; nullptr when there is none.
[[nodiscard]] const InterfaceGap* main_fault(const DiagnosisReport& report);
/// The members of a set; without one the causes, and what cannot be distinguished from them.
[[nodiscard]] std::vector<const RankedCause*> indistinguishable(const DiagnosisReport& report);
/// Their names after "cannot distinguish", with the interface of each where they are not all at one: `a, b and c`, or
/// `a and b together from c` where two were found together.
[[nodiscard]] std::string alternatives_in_words(const DiagnosisReport& report);
/// ` (takeda: the specimen …)` for a law in place of the specimen's own; empty for an effect.
[[nodiscard]] std::string law_in_words(const RankedCause& cause);
/// ` (the friction force grows by 500 N per unit of current_a)` for an effect that follows a recorded input; empty for
/// one that follows none.
[[nodiscard]] std::string input_in_words(const RankedCause& cause);
/// The model's own value of a parameter lies outside of its interval.
[[nodiscard]] bool is_corrected(const ReportedParameter& parameter);
/// ` (friction force 0 N instead of 2.00 kN)` for an effect that the model has; empty for one that it lacks.
[[nodiscard]] std::string corrected_in_words(const RankedCause& cause);
/// The numbers of the model that are slightly off, with their values; empty when there are none.
[[nodiscard]] std::string corrections_sentence(const DiagnosisReport& report);
/// The verdict in one to three sentences.
[[nodiscard]] std::string verdict_sentence(const DiagnosisReport& report);

}  // namespace hybridtest::report
