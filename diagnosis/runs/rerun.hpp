#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "diagnosis/runs/diagnose_site.hpp"
#include "scenario/site_model_file.hpp"

namespace hybridtest {

/// @param done   of all that is to be simulated, 0 to 1.
using RerunProgress = std::function<void(double done)>;

/// Completes a diagnosis by the response of the whole test: runs the hybrid test of a run directory again in this
/// process, once with the site's model in place of its rig and once with the causes added to it, and compares
/// both with the displacements that the coordinator recorded. Everything else is that of the run's scenario; another
/// site that stands in a laboratory is simulated by the model beside its rig.
///
/// Where there is no cause, or the test cannot be simulated, the report says why instead.
/// @param run    recorded by `hybridtest run` or `simulate`.
/// @param site   id of the substructure; empty where the run has one site.
/// @param scenario   the run's own, or one with other numbers; causes at the numerical substructure are added to it.
void add_response(SiteDiagnosis& diagnosis, const SiteModelFile& model, const std::filesystem::path& run,
                  std::string_view site, const std::filesystem::path& scenario, const RerunProgress& progress);

}  // namespace hybridtest
