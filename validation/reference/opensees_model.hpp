#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "scenario/scenario.hpp"
#include "validation/reference/monolithic_response.hpp"

namespace hybridtest {

/// Laws with a material of OpenSees, as the writer knows them.
[[nodiscard]] const std::vector<std::string_view>& laws_with_counterpart();

/// The whole test as one model of OpenSees, in Tcl: mass, damping and stiffness of the structure as springs between its
/// degrees of freedom, materials in place of substructures and specimens, all loads. Newmark's average acceleration,
/// each step iterated to equilibrium. SI units.
/// @param results   file of the displacements of all degrees of freedom, a row per step after the initial state.
/// @throws ConfigError listing each law, load and part without a counterpart.
[[nodiscard]] std::string opensees_model(const Scenario& scenario, const std::filesystem::path& results);

/// What such a model wrote.
/// @throws ConfigError when rows are missing.
[[nodiscard]] ReferenceResponse read_opensees_response(const Scenario& scenario, const std::filesystem::path& results);

/// Runs a script in its folder; its output goes to `SCRIPT.log`.
/// @param program   see find_opensees(). @param waiting   called now and then; may be empty.
/// @throws ConfigError where there is no OpenSees, and with the end of its output where it fails.
void run_opensees(const std::filesystem::path& script, const std::string& program,
                  const std::function<void()>& waiting = {});

}  // namespace hybridtest
