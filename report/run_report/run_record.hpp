#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "recording/run_file.hpp"
#include "recording/summary/run_summary.hpp"
#include "report/run_report/signal_curve.hpp"
#include "report/run_report/time_histogram.hpp"
#include "report/run_report/transfer_estimate.hpp"
#include "scenario/scenario.hpp"

namespace hybridtest::run_report {

/// An interface degree of freedom of a site.
struct SiteDof {
  std::string name;
  plot::Points loop;      // measured force [N] over measured displacement [m]
  plot::Points subspace;  // measured over target displacement [m]
  std::vector<TransferPoint> transfer;
};

/// What a report shows of one substructure. Parts whose records are missing are empty.
struct SubstructureRecord {
  std::string id;
  bool is_site = false;
  bool has_file = false;
  std::vector<SignalCurve> signals;
  std::vector<SignalCurve> interlocks;  // what they compare with their limits
  std::vector<SiteDof> dofs;
  TimeHistogram round_trip;
  TimeHistogram lateness;  // of control periods
  // Of a test in real time, from the first bridge on: sums over model time [s].
  plot::Points bridges;           // bridged steps
  plot::Points bridged_energy_j;  // that the bridges added to the structure, where it is known
};

/// A run directory, read in pieces and thinned: the memory does not grow with the length of the test.
struct RunRecord {
  std::filesystem::path directory;
  std::optional<Scenario> scenario;
  std::string why_no_scenario;
  double end_s = 0.0;  // model time reached
  std::vector<SignalCurve> structure;
  std::vector<SubstructureRecord> substructures;
  std::vector<RecordedEvent> events;  // of all participants, in the order of model time
  std::vector<std::string> unread;    // files that could not be read, one sentence each
};

/// What the files of a run directory hold. Unknown and absent tables and columns are left out; a file that cannot be
/// read is named in `unread`.
[[nodiscard]] RunRecord read_run_record(const std::filesystem::path& directory);

/// Whether a directory holds run files.
[[nodiscard]] bool is_run_directory(const std::filesystem::path& directory);

}  // namespace hybridtest::run_report
