#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace hybridtest::benchmarks {

/// Runs a test by the programs, each participant in its own process on this machine.
/// @param ids    of its substructures, which are numerical.
/// @param further   arguments for each of them.
/// @param credentials   folder with a folder for each of them; empty without security.
/// @return the times between the sending of commands of consecutive steps [us], as the coordinator records them,
/// without
///         the first `warm_up`.
/// @throws std::runtime_error when a participant fails.
[[nodiscard]] std::vector<double> coupled_step_us(const std::filesystem::path& scenario,
                                                  const std::vector<std::string>& ids, int warm_up, unsigned domain,
                                                  const std::vector<std::string>& further,
                                                  const std::filesystem::path& credentials = {});

}  // namespace hybridtest::benchmarks
