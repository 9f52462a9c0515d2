#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "diagnosis/response/test_response.hpp"
#include "scenario/scenario.hpp"

namespace hybridtest {

/// The response that the coordinator of a run recorded, one column per completed step.
/// @throws RecordingError when there is no such record, or of other degrees of freedom.
[[nodiscard]] TestResponse recorded_response(const std::filesystem::path& run, const Scenario& scenario);

/// Likewise from the columns of its table `steps`, wherever they are.
/// @param column   all values under a column's name.
[[nodiscard]] TestResponse response_of_steps(const Scenario& scenario,
                                             const std::function<std::vector<double>(const std::string&)>& column);

}  // namespace hybridtest
