#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "diagnosis/runs/diagnose_site.hpp"
#include "scenario/site_model_file.hpp"

namespace hybridtest {

/// Adds the response of the whole test to a diagnosis: simulates the hybrid test of a run directory twice in this
/// process, first with the model of the site instead of its compensator and rig, then with the causes added to that
/// model. Compares both with the displacements that the coordinator recorded. All other settings are those of the
/// scenario of the run; another site in a laboratory is simulated by the model beside its rig.
///
/// If there is no cause, or the test cannot be simulated, the report says why.
/// @param run    recorded by `hybridtest run` or `simulate`.
/// @param site   id of the substructure; empty where the run has one site.
/// @param scenario   of the run, or one with other values; causes at the numerical substructure are added to it.
void add_response(SiteDiagnosis& diagnosis, const SiteModelFile& model, const std::filesystem::path& run,
                  std::string_view site, const std::filesystem::path& scenario, const PartProgress& progress);

}  // namespace hybridtest
