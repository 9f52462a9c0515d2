#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "diagnosis/recording.hpp"
#include "plant/effects/effect.hpp"
#include "plant/effects/effect_type.hpp"
#include "plant/site_model.hpp"

namespace hybridtest {

/// Inputs beside the motion (Recording::inputs), sample after sample.
struct InputTable {
  std::vector<std::string> names;
  std::vector<double> values;  // one row of them per sample
  // Of them, those that stay where the model is right: what follows them does not act here.
  std::vector<std::string> at_reference{};

  [[nodiscard]] bool has(std::string_view name) const noexcept;
  /// null without any.
  [[nodiscard]] const double* at(std::size_t sample) const noexcept {
    return names.empty() ? nullptr : values.data() + sample * names.size();
  }
};

/// Readings before any smoothing, and the standard deviation of their white noise.
struct AsRecorded {
  std::vector<double> values;
  double noise = 0.0;
};

/// The part of the chain between two consecutive recorded channels of one degree of freedom. Its input is the
/// measured one, so that an error does not propagate to the next segment.
struct Segment {
  Channel from = Channel::command_displacement;
  Channel to = Channel::measured_displacement;
  EffectInterface interface {};  // to which a gap here is attributed until an effect shows another one
  std::size_t recording = 0;     // position in the list that was given
  double period_s = 0.0;
  bool is_quasi_static = false;  // see Recording; the velocity of `input` is a sign, its acceleration zero
  std::vector<Motion> input;     // motion of `from` without its noise, one per sample
  std::vector<double> load_n;    // measured force without its noise, of the recorded sample before; empty: unknown
  InputTable inputs;             // beside the motion, of the specimen's segment; smoothed as `measured`
  std::vector<double> measured;  // `to` as recorded, or smoothed
  double input_noise = 0.0;      // white noise that was smoothed [m]
  double input_step = 0.0;       // of the converter of the sensor [m]; 0: none found
  // A draw of the noise that `input` still has, white or of coarse steps; empty: commands have none.
  std::vector<Motion> noise;
  // The noise that `input` still has as another channel tells it, coloured noise and hum with it; empty: none does.
  std::vector<Motion> told_noise;
  // What `input` turns by where the motion does not: the noise of a reading from peak to peak [m]. 0: none.
  double reversal_noise_m = 0.0;
  // How `input` was derived from readings: the window of the polynomial and the weights behind it, see
  // smoothed_alike(); 0: none.
  std::size_t half_width = 0;
  double smoothed_by = 0.0;
  // The same smoothed over half the window; empty where there is no narrower one.
  std::vector<Motion> narrow_input;
  std::vector<Motion> narrow_noise;
  AsRecorded recorded;  // what was smoothed, where `measured` is: beside a limit the smoothed goes beyond it
  // Samples at both ends where the motion is not known well enough to judge; their prediction is set to the measured
  // value.
  std::size_t unjudged = 0;
  // Standard deviation of the noise of `measured`, and number of neighbouring samples that share the same noise.
  double measured_noise = 0.0;
  double noise_span = 1.0;
  // By how much the model's force, smoothed, differs from its force for the smoothed motion, and the root mean square
  // of that: where the law is not linear they differ, and a correct model leaves that. Empty where nothing was
  // smoothed.
  std::vector<double> smoothing_errors;
  double smoothing_error = 0.0;
  // Standard deviation of the error of a coarse converter in `measured`, which may be correlated. 0: none found.
  double step_noise = 0.0;

  // The segment that this one goes on from, whose history the stages of a model have when it begins; may be null.
  std::shared_ptr<const Segment> history;

  /// An effect at that interface changes what this segment predicts. One that needs time changes no quasi-static one,
  /// one that follows an input only one where that acts.
  [[nodiscard]] bool touched_by(const EffectType& effect) const noexcept;
  /// By one of them, at least.
  [[nodiscard]] bool touched_by(std::span<const EffectSetting> effects) const noexcept;
  /// Whether `measured` is, see smoothed_alike().
  [[nodiscard]] bool is_smoothed() const noexcept { return !recorded.values.empty(); }
  /// It would, but its input stays at its reference here: this segment shows the model without the effect.
  [[nodiscard]] bool is_reference_of(const EffectType& effect) const noexcept;
};

/// The inputs that were recorded beside the motion.
[[nodiscard]] InputTable inputs_of(const Recording& recording);

/// All segments of the chain that one degree of freedom of a recording contains; of a quasi-static one, that of the
/// specimen (quasi_static_segment()).
[[nodiscard]] std::vector<Segment> segments_of(const Recording& recording, std::size_t dof, std::size_t position);

/// The specimen's segment with force and motion smoothed by the same weights (FlatSmoother). The derivatives of the
/// motion are computed before, over the narrowest window. If the force is linear in the motion, smoothing changes force
/// and prediction equally.
/// @param deviation   of the weights, in samples.
[[nodiscard]] Segment smoothed_alike(const Segment& segment, const DofRecording& dof, double deviation);

/// A smoothed segment with its motion over the narrowest window and not smoothed behind it; all samples are judged.
[[nodiscard]] Segment with_plain_motion(const Segment& smooth, const DofRecording& dof);

/// A segment at a lower rate, for a first search: samples are skipped so that the rate is at most
/// `rate_hz`. A segment with a compensator between its channels, whose command depends on its own rate,
/// stays as it is.
[[nodiscard]] Segment thinned(const Segment& segment, double rate_hz);

/// One row per sample: displacement, velocity, 1, acceleration, of which a spring, a damper, a constant and a mass make
/// their forces.
[[nodiscard]] Eigen::MatrixX4d motion_columns(const std::vector<Motion>& motion);

/// Whether the force of a model's law is zero or proportional to the displacement, within rounding, in the whole range.
[[nodiscard]] bool is_spring(const SiteModel& model, double largest_m);

/// Whether the model predicts `to`; a force only with a law or an effect of the specimen.
[[nodiscard]] bool is_modelled(const SiteModel& model, const Segment& segment);

/// Prediction of `to`, in free simulation over the whole segment.
/// @param added   effects beyond the model's own, behind them.
/// @throws ConfigError for parameters that an effect does not accept.
[[nodiscard]] std::vector<double> predict(const SiteModel& model, const Segment& segment,
                                          std::span<const EffectSetting> added = {});

/// What a prediction has wrong because its input is not exactly known, by what the same again would change: the noise
/// that the input still has, and a window half as wide where it was smoothed. One value per sample; empty: none.
struct InputErrors {
  std::vector<double> of_noise;
  std::vector<double> of_window;
  std::vector<double> of_narrow_noise;  // of that in the narrower window
};
/// @param added   effects beyond the model's own, as of predict().
[[nodiscard]] InputErrors input_errors(const SiteModel& model, const Segment& segment,
                                       std::span<const EffectSetting> added = {});

/// Whether effects put something in the place of what the model has: another law or element, or another stiffness. What
/// the model makes of the noise of its input is then not what they leave.
[[nodiscard]] bool take_place_in(const SiteModel& model, std::span<const EffectSetting> effects) noexcept;

/// The segment with a noise of its motion added to its input.
/// @param times   as large.
[[nodiscard]] Segment with_noise(const Segment& segment, const std::vector<Motion>& noise, double times);

/// The motion that readings, or an error of them, give as an input of the segment: smoothed as its own is.
[[nodiscard]] std::vector<Motion> motion_of_readings(const Segment& segment, std::span<const double> readings);

/// Standard deviation of the error of the prediction due to noise of the input and due to smoothing; 0 if the input is
/// exact. The error due to smoothing is estimated from the change of the prediction with half the window, minus the
/// noise of that window.
/// @param root_mean_square   of a prediction: per sample, or after averaging.
[[nodiscard]] double input_floor(const InputErrors& errors,
                                 const std::function<double(std::span<const double>)>& root_mean_square);

/// Standard deviation per sample of the residual of a correct model, from noise in both channels.
[[nodiscard]] double noise_floor(const Segment& segment, const InputErrors& errors);
/// The same of means over samples, of which so many are independent. What a smooth curve leaves of a coarse converter's
/// readings are its steps, for the most part: they count once, and no mean makes them less.
/// @param of_input      what the errors of the input leave of these means.
/// @param independent   at least 1.
[[nodiscard]] double noise_floor_of_means(const Segment& segment, double of_input, double independent);

}  // namespace hybridtest
