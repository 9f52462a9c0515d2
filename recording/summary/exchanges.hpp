#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "recording/summary/run_summary.hpp"

namespace hybridtest {

class RunFileReader;

/// Reads the coordinator's tables `exchanges` and, of a test in real time, `bridges`.
/// @param substructures   how many there are.
/// @param last_step       the last one that was completed.
/// @return one per substructure; nothing for one without a row.
[[nodiscard]] std::vector<std::optional<ExchangeSummary>> exchanges_of(const RunFileReader& file,
                                                                       std::size_t substructures, double last_step);

}  // namespace hybridtest
