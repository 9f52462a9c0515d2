#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/echo.hpp"

namespace hybridtest::benchmarks {

/// Where the time of coupled steps went, each along the path of the substructure that answered last: its
/// stages add up to the step.
struct StepTrace {
  std::vector<double> step_us;
  std::vector<std::pair<std::string, std::vector<double>>> stages_us;
  std::vector<double> recording_us;  // while the substructures work: not part of the step unless they are faster
};

/// Writes the scenario of a shear building of so many storeys, each of which is a numerical substructure.
void write_storeys(const std::filesystem::path& file, int storeys, int steps);

/// A coupled test of the nodes, transport and recorder of the product, one process for each participant. Their programs
/// do in addition what is not part of the test: progress, event log, live signals.
/// @param settings   those of `our transport`; as many substructures as peers.
[[nodiscard]] StepTrace traced_steps(const EchoSettings& settings);

/// A substructure of it. @return the exit code.
[[nodiscard]] int traced_peer(const EchoSettings& settings, int index, int run);

}  // namespace hybridtest::benchmarks
