#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "diagnosis/localisation/gap_shares.hpp"
#include "diagnosis/localisation/localise.hpp"
#include "diagnosis/progress.hpp"
#include "diagnosis/recording.hpp"
#include "diagnosis/result/diagnosis_report.hpp"
#include "diagnosis/verdict/policy.hpp"
#include "plant/site_model.hpp"

namespace hybridtest {

struct DiagnoseSettings {
  std::uint64_t seed = 1;   // of the resampling for confidence intervals
  std::size_t threads = 1;  // does not change the result
  std::size_t dof = 0;      // of the recordings, 0-based
  std::string site;         // names for the report
  std::string model_file;
  std::string model_part;
  std::string made_at_utc;  // likewise; empty: the report has no date
  std::string made_by;
  VerdictPolicy policy;
  PartProgress progress;  // of the whole diagnosis of one degree of freedom
};

/// The times, frequencies and motions in which the gap of one interface is.
struct GapPlace {
  std::string interface;
  std::vector<TimeWindow> time_windows;
  std::vector<BandShare> bands;
  std::vector<GapRegion> regions;
};

struct Diagnosis {
  report::DiagnosisReport report;
  std::vector<GapPlace> places;
  std::vector<EffectSetting> causes;  // to be added to the model, in this order
  // Covariances of their parameters in the same order, one for each channel: see covariance_for_draws().
  std::vector<Eigen::MatrixXd> doubts;
};

/// Finds where a model and recordings of the real site differ, which effect of the library causes it, and how much
/// of the gap the effect removes. The same input gives the same output to the last bit.
///
/// Effects are searched and judged on the recordings of the role fit, on blocks left out of the fit;
/// those of the role held_out measure how much of the gap is removed; causes that do not reduce it are dropped.
/// @param recordings   at least one of the role fit; all have the requested degree of freedom.
[[nodiscard]] Diagnosis diagnose(const SiteModel& model, std::span<const Recording> recordings,
                                 const DiagnoseSettings& settings);

}  // namespace hybridtest
