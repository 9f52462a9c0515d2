#pragma once

#include <Eigen/Core>
#include <compare>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "diagnosis/diagnose.hpp"
#include "diagnosis/intake/intake.hpp"
#include "scenario/site_model_file.hpp"

namespace hybridtest {

/// The diagnosis of a site, and the degree of freedom that it is about.
struct SiteDiagnosis {
  Diagnosis diagnosis;
  std::size_t dof = 0;                          // 0-based
  std::vector<EffectSetting> structure_causes;  // effects of the scenario, not of the site's model
  std::vector<ListedEffect> other_causes;       // of the site's other degrees of freedom
  std::vector<Eigen::MatrixXd> other_doubts;    // of these, as Diagnosis::doubts

  /// The causes as the model's file lists them.
  [[nodiscard]] std::vector<ListedEffect> listed_causes(const SiteModelFile& model) const;
  /// Of listed_causes(), as Diagnosis::doubts.
  [[nodiscard]] std::vector<Eigen::MatrixXd> doubts() const;
};

/// How the time stamps of recordings are read beside this model.
[[nodiscard]] TimeBase time_base_of(const SiteModelFile& model) noexcept;

/// @throws ConfigError for each recording whose number of degrees of freedom differs from the model or that lacks an
///         input of an effect in the model, and for each column whose unit seems wrong compared with the prediction of
///         the model.
void require_match(const SiteModelFile& model, std::span<const Recording> recordings);

/// Of one degree of freedom: whether there is more to tell than numbers slightly off, whether a channel shows a gap
/// clear of its floor, and the largest gap above a floor [variance over variance]. A channel with much noise has no
/// large gap, and half of a gap may be in its floor. In this order the larger one comes first.
struct GapOfDof {
  bool has_verdict = false;  // other than `none` and `not_excited`
  bool is_clear = false;
  double above_floor = 0.0;

  auto operator<=>(const GapOfDof&) const = default;
};
[[nodiscard]] GapOfDof gap_of(const report::DiagnosisReport& report);

/// Diagnoses every degree of freedom; returns the diagnosis with the largest gap_of(). A note tells of each other
/// degree of freedom that has one, with its causes.
/// @param settings   what it says of model and version is filled in here.
/// @throws ConfigError as require_match().
[[nodiscard]] SiteDiagnosis diagnose_site(const SiteModelFile& model, std::span<const Recording> recordings,
                                          DiagnoseSettings settings);

/// Adds the result for the interface `numerical_substructure`: whether the structure of a scenario computes the
/// recorded commands from the recorded forces. If the run did not record them, a note says so.
/// @param scenario   of the same test: the scenario of the run, or one with the values that the user expects.
/// @throws ConfigError for a scenario of another test.
void diagnose_structure_of(SiteDiagnosis& diagnosis, const std::filesystem::path& run,
                           const std::filesystem::path& scenario, const PartProgress& progress = {});

/// Writes diagnosis.json, diagnosis.html, prediction.csv and augmented_model.yaml: the model with the causes, if there
/// are any.
/// @throws ConfigError when the directory cannot be written to.
void write_diagnosis(const SiteDiagnosis& diagnosis, const SiteModelFile& model, const std::filesystem::path& directory,
                     const PartProgress& progress = {});

/// The result as text for the terminal.
[[nodiscard]] std::string summary_of(const SiteDiagnosis& diagnosis);

}  // namespace hybridtest
