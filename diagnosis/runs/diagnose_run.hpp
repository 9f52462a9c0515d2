#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <iosfwd>

#include "diagnosis/runs/rerun.hpp"
#include "scenario/scenario.hpp"

namespace hybridtest {

/// Whom a diagnosis tells how far it is.
struct DiagnosisProgress {
  std::function<void(std::size_t done, std::size_t all)> fits = [](std::size_t, std::size_t) {};
  RerunProgress rerun = [](double) {};
};

/// For `--diagnose`, before anything moves: every site has a model to compare with, `model:` beside its rig, or
/// is simulated itself.
/// @throws ConfigError naming those that have none.
void require_models(const Scenario& scenario);

/// Diagnoses every site of a finished run against its model, from the recording of the run itself. Writes
/// what `hybridtest diagnose` writes into `RUN/diagnosis`, one folder per site where there are several, and
/// prints the answer. A site whose records are not here (it ran on another host) is said so and left out.
void diagnose_run(const Scenario& scenario, const std::filesystem::path& run, const DiagnosisProgress& progress,
                  std::ostream& out);

}  // namespace hybridtest
