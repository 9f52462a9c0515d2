#pragma once

#include <span>
#include <string>
#include <vector>

#include "recording/summary/run_summary.hpp"
#include "report/run_report/comparison.hpp"
#include "report/run_report/run_record.hpp"

namespace hybridtest::run_report {

/// What the parts of a report are made of.
struct ReportFacts {
  const RunSummary& summary;
  const RunRecord& run;
  std::span<const Compared> others;
  std::string shipped_scenario;  // effective text of the shipped one of this name; empty without one
};

/// The parts of report.html, each a piece of HTML; empty where the run has nothing for it.

/// Verdict, what to do, peaks.
[[nodiscard]] std::string verdict_part(const ReportFacts& facts);
/// What the run is compared with, and the differences.
[[nodiscard]] std::string comparison_part(const ReportFacts& facts);
/// Displacements, drifts, base shear and energy of the structure.
[[nodiscard]] std::string structure_part(const ReportFacts& facts);
/// Response spectra of what was applied.
[[nodiscard]] std::string spectra_part(const ReportFacts& facts);
/// Histories, loop, tracking and interlocks of a site; displacement and force of a numerical substructure.
[[nodiscard]] std::string substructure_part(const ReportFacts& facts, const SubstructureRecord& substructure);
/// Latency of the exchanges, lateness of the control loops.
[[nodiscard]] std::string timing_part(const ReportFacts& facts);
[[nodiscard]] std::string events_part(const ReportFacts& facts);
/// The scenario with what differs from the one that ships.
[[nodiscard]] std::string scenario_part(const ReportFacts& facts);
/// Versions, digests, files and their state.
[[nodiscard]] std::string files_part(const ReportFacts& facts);

}  // namespace hybridtest::run_report
