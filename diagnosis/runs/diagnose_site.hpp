#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "diagnosis/diagnose.hpp"
#include "scenario/site_model_file.hpp"

namespace hybridtest {

/// A diagnosis of a site, and the degree of freedom it speaks of.
struct SiteDiagnosis {
  Diagnosis diagnosis;
  std::size_t dof = 0;                          // 0-based
  std::vector<EffectSetting> structure_causes;  // effects of the scenario, not of the site's model

  /// The causes as the model's file lists them.
  [[nodiscard]] std::vector<ListedEffect> listed_causes(const SiteModelFile& model) const;
};

/// @throws ConfigError with every recording of another number of degrees of freedom than the model, and with every
///         column that is in another unit by what the model predicts of it.
void require_match(const SiteModelFile& model, std::span<const Recording> recordings);

/// Diagnoses every degree of freedom; the answer is that of the largest gap.
/// @param settings   its `dof`, `site` and `model_file` are filled in here.
/// @throws ConfigError as require_match().
[[nodiscard]] SiteDiagnosis diagnose_site(const SiteModelFile& model, std::span<const Recording> recordings,
                                          DiagnoseSettings settings);

/// Adds what the run's record tells of the interface `numerical_substructure`: whether the structure of a scenario
/// makes the recorded commands of the recorded forces. Where that is not recorded, a note says so.
/// @param scenario   of the same test; the run's own, or with numbers that the user takes for right.
/// @throws ConfigError for a scenario of another test.
void diagnose_structure_of(SiteDiagnosis& diagnosis, const std::filesystem::path& run,
                           const std::filesystem::path& scenario);

/// Writes diagnosis.json, diagnosis.html and augmented_model.yaml: the model with the causes, if there are any.
/// @throws ConfigError when the directory cannot be written to.
void write_diagnosis(const SiteDiagnosis& diagnosis, const SiteModelFile& model,
                     const std::filesystem::path& directory);

/// The answer in words, for a person.
[[nodiscard]] std::string summary_of(const SiteDiagnosis& diagnosis);

}  // namespace hybridtest
