#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <iosfwd>

#include "diagnosis/runs/rerun.hpp"
#include "scenario/scenario.hpp"

namespace hybridtest {

/// Functions that a diagnosis calls to show its progress.
struct DiagnosisProgress {
  std::function<void(std::size_t done, std::size_t all)> fits = [](std::size_t, std::size_t) {};
  RerunProgress rerun = [](double) {};
};

/// For `--diagnose`, before the test starts: every site must have a model to compare with (`model:` beside its
/// rig) or a simulated rig.
/// @throws ConfigError that names the sites without a model.
void require_models(const Scenario& scenario);

/// Diagnoses every site of a finished run against its model, from the recording of the run itself. Writes
/// what `hybridtest diagnose` writes into `RUN/diagnosis`, one folder per site where there are several, and
/// prints the result. A site whose recording is missing (it ran on another host) is skipped with a message.
void diagnose_run(const Scenario& scenario, const std::filesystem::path& run, const DiagnosisProgress& progress,
                  std::ostream& out);

}  // namespace hybridtest
