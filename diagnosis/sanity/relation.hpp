#pragma once

#include <optional>
#include <span>

namespace hybridtest {

/// How far an output follows an input, in any way that a specimen or an actuator could make it: displacement, velocity,
/// acceleration, a stiffening spring, one-sided contact, play and friction of three sizes, and the input some
/// hundredths of a second earlier or later. Constants and slow drifts do not count: means of blocks are left out.
struct Relation {
  double fitted = 0.0;    // share of the output's variance that a fit to the whole recording explains
  double held_out = 0.0;  // the same predicted in blocks that were not fitted; negative: worse than nothing

  /// A few effects fit any two signals a little; what is predicted where it was not fitted is no chance.
  [[nodiscard]] bool is_none() const noexcept;
};

/// @param input_m, output   of one length, at one rate. @param shift   of the delayed inputs, in samples; at least 1.
[[nodiscard]] Relation relation_between(std::span<const double> input_m, std::span<const double> output,
                                        std::size_t shift);

/// By how many samples the output is behind the input (negative: ahead) where a straight line through both explains
/// most of the output's variance, up to a quarter of the recording either way; the best such lag. Nothing if
/// there is none.
[[nodiscard]] std::optional<std::ptrdiff_t> far_lag(std::span<const double> input_m, std::span<const double> output);

/// Slope of an output over what a model predicts for it, means left out, beside the velocity of the prediction; and how
/// much of the output each of two explanations leaves.
struct Sense {
  double slope = 0.0;        // 1 for a right model, negative where the output runs against it
  double correlation = 0.0;  // of output and prediction, -1 to 1
  double shift = 0.0;        // samples by which the output is behind, by the share of the prediction's change in it
  double leaves = 1.0;       // share of variance that the slope leaves
  double mass_leaves = 1.0;  // share that a force of inertia leaves instead
};
[[nodiscard]] Sense sense_of(std::span<const double> predicted, std::span<const double> output,
                             std::span<const double> acceleration);

/// Work of a force along a path over the largest that its magnitude could do, -1 to 1: 0 for a spring over closed
/// cycles, near 1 for friction, negative where it drives the motion.
[[nodiscard]] double work_share(std::span<const double> displacement_m, std::span<const double> force_n);

}  // namespace hybridtest
