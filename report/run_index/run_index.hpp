#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "recording/summary/run_summary.hpp"

/// The runs below a folder: a list for the terminal, for programs, and as a page that links what was written about
/// them.
namespace hybridtest {

/// One run directory. Where it cannot be read, `fault` says why and only the directory is known.
struct RunEntry {
  std::filesystem::path directory;
  std::string fault{};           // one sentence; empty for a run that was read
  std::string start_time_utc{};  // ISO 8601; of a run that was not read, when its directory last changed
  std::string test_name{};       // of the scenario
  std::string verdict{};         // as verdict(RunSummary)
  bool has_summary = false;      // without summary.json: the test still runs, or was killed
  int exit_code = kExitInternal;
  bool data_valid = false;
  std::vector<Peak> peak_displacement_m{};        // [m] per degree of freedom of the structure
  std::vector<std::string> diagnoses{};           // one per site: verdict and causes
  std::optional<std::filesystem::path> report{};  // report.html
  std::vector<std::filesystem::path> diagnosis_pages{};

  [[nodiscard]] bool failed() const noexcept { return !fault.empty() || exit_code != kExitCompleted; }
  /// The degree of freedom that moved most; none where no motion was recorded.
  [[nodiscard]] const Peak* largest_peak() const noexcept;
};

struct RunFilter {
  std::string test_name{};   // only runs of this scenario; empty: all
  bool only_failed = false;  // only runs that did not complete with valid data
};

/// The runs in `folder` and below, newest first. What summary.json says is taken; a run without one is summarised from
/// its recordings, which are not changed. A run that cannot be read is an entry with its fault.
/// @throws RecordingError when the folder cannot be read.
[[nodiscard]] std::vector<RunEntry> find_runs(const std::filesystem::path& folder, const RunFilter& filter = {});

/// For people: two lines each, in millimetres.
[[nodiscard]] std::string runs_text(const std::vector<RunEntry>& runs);
/// For programs: SI; values that are not known are null. Schema `hybridtest/runs/1`.
[[nodiscard]] std::string runs_json(const std::vector<RunEntry>& runs);
/// @param folder   where the page will stand; its links are relative to it.
[[nodiscard]] std::string runs_page(const std::vector<RunEntry>& runs, const std::filesystem::path& folder);

}  // namespace hybridtest
