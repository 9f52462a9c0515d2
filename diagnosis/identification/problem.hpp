#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "diagnosis/identification/remembered_law.hpp"
#include "diagnosis/identification/search_table.hpp"
#include "diagnosis/identification/segment.hpp"
#include "diagnosis/progress.hpp"
#include "diagnosis/workers.hpp"

namespace hybridtest {

class Discrepancy;
struct FitOutcome;

/// Peaks of a recording, which make the search ranges of the effect library fit any specimen.
struct SignalScales {
  double displacement_m = 0.0;
  double velocity_m_per_s = 0.0;
  double acceleration_m_per_s2 = 0.0;
  double force_n = 0.0;  // 0 where no force was measured
  double duration_s = 0.0;

  /// The size of one unit of this scale, in SI; 1 if the recording has no such signal.
  [[nodiscard]] double of(ParameterScale scale) const noexcept;
};

[[nodiscard]] SignalScales scales_of(std::span<const Segment> segments);

/// What the recordings show of one input beside the motion.
struct InputRange {
  std::string name;
  // Where the model is taken to be right: what an effect of it that follows the same input says, else where the first
  // recording begins.
  double reference = 0.0;
  double mean = 0.0;
  double span = 0.0;  // how far it goes from there
  // Its size differs while the specimen is loaded; else what grows with it cannot be told from what is always there.
  bool varies = false;
};

[[nodiscard]] std::vector<InputRange> input_ranges_of(const SiteModel& model, std::span<const Segment> segments);

/// Numbers of the model that are free in a segment, along orthogonal directions of the output; see judged_at().
struct FreeNumbers {
  Eigen::MatrixXd directions;  // orthonormal columns; none: the numbers are as the model has them
  Eigen::VectorXd off;         // by how much they are off without any effect, along each direction
  double slight = 0.0;         // by how much a model may be off there [standard deviation]
  double resolved = 1.0;       // over that, what noise leaves of doubt in it
};

/// A segment whose inputs differ by the noise of the recorded one.
struct NoisySegments {
  Segment with;
  Segment without;
};

/// What the channels show of the noise that a correct model leaves [standard deviation]: white noise, steps of
/// converters, and smoothing.
struct ChannelFloor {
  double of_means = 0.0;  // after averaging
  double per_sample = 0.0;
  double of_smoothing = 0.0;  // of both, that alone
};

/// A segment for fits: averaged over `averaged` neighbouring samples, which keeps the frequencies that a
/// hybrid test excites and removes noise above them.
struct FitSegment {
  Segment segment;
  std::size_t averaged = 1;
  Eigen::VectorXd measured;                       // averaged
  Eigen::VectorXd baseline;                       // likewise, of the model as the user gave it
  Eigen::MatrixXd nuisance;                       // changes that a slightly wrong model makes; see nuisance_types
  std::vector<const EffectType*> nuisance_types;  // one per column
  // Changes per unit of every number of the model that may be slightly wrong: the nuisances, damping and bandwidth.
  Eigen::MatrixXd number_slopes;
  std::vector<const EffectType*> number_types;  // one per column
  // Changes by one standard deviation of what was found at a channel before, one column per direction of its doubt.
  Eigen::MatrixXd found_changes;
  double weight = 1.0;  // inverse of the standard deviation used here
  // Residual that a correct model leaves [standard deviation], after averaging and per sample: what the channels show
  // of their noise, at least; with nothing repeatable in the residual at hand, or after settle_noise(), also coloured
  // noise and hum, which only a residual shows.
  double floor = 0.0;
  double sample_floor = 0.0;
  // As sample_floor, with coloured noise and hum only if they are seen where the motion hardly moves: what the causes
  // have wrong in their form is no part of them.
  double still_floor = 0.0;
  ChannelFloor channels;  // beside the user's model
  // What the prediction has wrong by noise of its input and by smoothing, each in its averaged samples.
  std::vector<Eigen::VectorXd> input_errors;
  std::shared_ptr<const NoisySegments> noisy;  // null where the input is exact, or read in coarse steps
  double noise_of_input = 0.0;                 // in the baseline [mean square]; see noise_of_input()
  // Of a measured displacement: what of the force that answers it no function of the command explains. Empty without.
  Eigen::VectorXd answering_force;
  // Of a measured force: the displacement that was commanded, which rests without noise. Empty without.
  Eigen::VectorXd command_m;
  // Samples over the autocorrelation time of the noise (independent_samples()): the same for all candidates.
  double independent = 1.0;
  // What of a residual here follows from the motion at all.
  std::shared_ptr<const Discrepancy> discrepancy;
  // Whether its residual counts as part of the gap: it is well above the floor, or no residual is.
  bool is_suspect = true;
  // Whether it was judged before: what is left of its gap earns nothing any more.
  bool is_settled = false;
  std::shared_ptr<const LawMemory> law;  // of the specimen, along the recorded motion; null where there is none
  FreeNumbers numbers;
  std::vector<Eigen::Index> block_begins;  // held-out blocks, one more than there are

  [[nodiscard]] Eigen::VectorXd average(std::span<const double> values) const;
  /// Samples that a prediction of blocks left out counts for. However long the noise remembers, each block holds a
  /// cycle of its own and counts for one.
  [[nodiscard]] double predicted_samples() const noexcept {
    return std::max(independent, static_cast<double>(block_begins.size()) - 1.0);
  }
};

/// The data to which every candidate is fitted.
struct IdentificationProblem {
  SiteModel model;
  std::vector<FitSegment> segments;
  SignalScales scales;
  std::vector<InputRange> inputs;
  bool law_is_spring = false;     // linear in the range of the recordings, or there is no law
  bool law_has_strength = false;  // reached in the recordings, or only by a larger motion
  PartProgress progress;          // told of every prediction, so that no fit is silent, however long it takes
  Workers workers;                // compute the predictions of a fit
};

/// An effect of the model that was found at a channel before, and how well its parameters are known there.
struct FoundEffect {
  EffectSetting effect;
  Eigen::MatrixXd covariance;
};

/// @param segments   of recordings of the role fit.
/// @param found      of the model's effects, the last ones in their order.
/// @param workers    of the problem.
[[nodiscard]] IdentificationProblem make_problem(const SiteModel& model, std::vector<Segment> segments,
                                                 std::span<const FoundEffect> found = {}, const Workers& workers = {});

/// Whether all are numbers of the model: its form is right then. That of an effect or a law is never quite that of the
/// specimen.
[[nodiscard]] bool are_numbers(std::span<const EffectSetting> effects) noexcept;

/// Takes floors, weights and numbers of independent samples from the residuals of the best fit at hand: of what the
/// discrepancy term leaves of them on held-out cycles, which no function of the motion explains. Until then the noise
/// under a gap is not known. Beside an effect or a law, noise is at most twice what is there where the motion hardly
/// moves: what their form misses is not.
void settle_noise(IdentificationProblem& problem, const FitOutcome& best);

/// The same at the end of a search: what was found may take the place of something in the model that made more of the
/// noise of its input, or had corners that smoothing cuts off. Floors are no higher than beside what is there instead.
void settle_final_noise(IdentificationProblem& problem, const FitOutcome& found);

/// The same problem with the gap of one channel to explain. The other segments stay: an effect of a displacement sensor
/// shows in force and motion alike. So one interface never hides what is wrong at another. In the other segments the
/// numbers of the model are free; those of channels in front of this one were judged before.
[[nodiscard]] IdentificationProblem judged_at(const IdentificationProblem& problem, Channel output);

/// A slightly wrong number of the user's model.
[[nodiscard]] bool is_model_number(const IdentificationProblem& problem, const EffectType& type) noexcept;

/// What it costs to believe that the free numbers are off by what these effects need beside them [nats]: each is within
/// `slight` before the test, and within `resolved` of that after it (Laplace's approximation; MacKay, Neural
/// Computation 4, 1992). A number that noise explains costs nothing.
[[nodiscard]] double cost_of_numbers(const IdentificationProblem& problem, std::span<const EffectSetting> added);

/// Averaged prediction with effects added, beside the free numbers that suit it; the baseline where none touches the
/// segment.
[[nodiscard]] Eigen::VectorXd predict(const IdentificationProblem& problem, const FitSegment& segment,
                                      std::span<const EffectSetting> added);
/// Likewise, with what a replacement among them gave before. @param position   of the segment, in the memories.
[[nodiscard]] Eigen::VectorXd predict(const IdentificationProblem& problem, const FitSegment& segment,
                                      std::span<const EffectSetting> added, std::size_t position,
                                      LawMemories& memories);

/// What noise of the input does to that prediction [mean square]: that which another channel tells, or a draw of white
/// noise, to first order. A damping makes much of it, and a lag takes it away: neither says anything about them. What
/// drawn noise does alike whatever its sign is none: a loop that it narrows.
[[nodiscard]] double noise_of_input(const IdentificationProblem& problem, const FitSegment& segment,
                                    std::span<const EffectSetting> added);

}  // namespace hybridtest
