#pragma once

#include <filesystem>
#include <vector>

#include "numerical_substructure/substructure_model.hpp"
#include "scenario/catalogue/part.hpp"
#include "scenario/named_file.hpp"

namespace hybridtest {

/// `model: {type: opensees}`: a substructure whose model is a Tcl script.
/// @param dofs     of the interface.
/// @param step_s   of the test.
/// @param files    the script is added, and the files that it sources or that `files` lists.
[[nodiscard]] Maker<SubstructureModel> read_opensees_model(config::Section& section, int dofs, double step_s,
                                                           const std::filesystem::path& directory,
                                                           std::vector<NamedFile>& files);

}  // namespace hybridtest
