#pragma once

#include <filesystem>
#include <string>

namespace hybridtest {

/// The OpenSees that is started: the one that the scenario names, else the one that the environment variable
/// HYBRIDTEST_OPENSEES names, else `OpenSees` in PATH. OpenSees is not part of this software.
/// @param program   `program` of the scenario: a path, or a name that PATH has; empty: not given.
/// @return its absolute path.
/// @throws ConfigError where there is none.
[[nodiscard]] std::filesystem::path find_opensees(const std::string& program);

/// Sets OPENBLAS_NUM_THREADS to 1 for processes started from here on, unless it is set. The matrices of a step are
/// small: the threads of OpenBLAS gain nothing and, on a machine with other work, wait for each other a hundred times
/// as long as they compute. Call it before there are threads.
void limit_opensees_threads();

}  // namespace hybridtest
