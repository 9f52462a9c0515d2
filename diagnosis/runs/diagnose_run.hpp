#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>

#include "diagnosis/progress.hpp"
#include "scenario/scenario.hpp"

namespace hybridtest {

/// For `--diagnose`, before the test starts: every site must have a model to compare with (`model:` beside its
/// rig) or a simulated rig.
/// @throws ConfigError that names the sites without a model.
void require_models(const Scenario& scenario);

/// Diagnoses every site of a finished run against its model, from the recording of the run itself. Writes
/// what `hybridtest diagnose` writes into `RUN/diagnosis`, one folder per site where there are several, and
/// prints the results at the end. A site whose recording is missing (it ran on another host) is skipped with a message.
/// @param made_at_utc   the time now, for the page.
void diagnose_run(const Scenario& scenario, const std::filesystem::path& run, const std::string& made_at_utc,
                  const PartProgress& progress, std::ostream& out);

}  // namespace hybridtest
