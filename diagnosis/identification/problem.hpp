#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "diagnosis/identification/remembered_law.hpp"
#include "diagnosis/identification/search_table.hpp"
#include "diagnosis/identification/segment.hpp"

namespace hybridtest {

/// Peaks of a recording, which make the search ranges of the effect library fit any specimen.
struct SignalScales {
  double displacement_m = 0.0;
  double velocity_m_per_s = 0.0;
  double acceleration_m_per_s2 = 0.0;
  double force_n = 0.0;  // 0 where no force was measured
  double duration_s = 0.0;

  /// What one unit of a parameter of that scale is, in its own unit; 1 where the recording has no such signal.
  [[nodiscard]] double of(ParameterScale scale) const noexcept;
};

[[nodiscard]] SignalScales scales_of(std::span<const Segment> segments);

/// A segment as fits see it: averaged over `averaged` neighbouring samples, which keeps what a
/// hybrid test excites and leaves out noise above.
struct FitSegment {
  Segment segment;
  std::size_t averaged = 1;
  Eigen::VectorXd measured;                       // averaged
  Eigen::VectorXd baseline;                       // likewise, of the model as the user gave it
  Eigen::MatrixXd nuisance;                       // changes that a slightly wrong model makes; see nuisance_types
  std::vector<const EffectType*> nuisance_types;  // one per column
  double weight = 1.0;                            // one over what counts as a standard deviation here
  double floor = 0.0;         // what noise leaves of a right model [standard deviation], after averaging
  double sample_floor = 0.0;  // the same per sample
  // What it leaves unexplained counts as part of the gap: a residual well above the floor, or all where none is.
  bool is_suspect = true;
  std::shared_ptr<const LawMemory> law;    // of the specimen, along the recorded motion; null where there is none
  std::vector<Eigen::Index> block_begins;  // held-out blocks, one more than there are

  [[nodiscard]] Eigen::VectorXd average(std::span<const double> values) const;
};

/// What every candidate is fitted to.
struct IdentificationProblem {
  SiteModel model;
  std::vector<FitSegment> segments;
  SignalScales scales;
  bool law_is_spring = false;  // linear, as far as the recordings move it, or none
};

/// @param segments   of recordings of the role fit.
[[nodiscard]] IdentificationProblem make_problem(const SiteModel& model, std::vector<Segment> segments);

/// A number of the user's model that is a little off, as every model's are.
[[nodiscard]] bool is_model_number(const IdentificationProblem& problem, const EffectType& type) noexcept;

/// Averaged prediction with effects added; the baseline where none touches the segment.
[[nodiscard]] Eigen::VectorXd predict(const IdentificationProblem& problem, const FitSegment& segment,
                                      std::span<const EffectSetting> added);

}  // namespace hybridtest
