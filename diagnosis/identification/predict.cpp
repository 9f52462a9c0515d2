#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "diagnosis/identification/segment.hpp"
#include "diagnosis/signals/signals.hpp"
#include "diagnosis/tuning.hpp"
#include "plant/site_stages.hpp"

namespace hybridtest {

namespace {

/// The displacement stages between the channels of a segment, in order.
class DisplacementChain {
 public:
  DisplacementChain(const SiteModel& model, const Segment& segment) {
    if (segment.from == Channel::sent_displacement) network_.emplace(model, segment.period_s);
    if (segment.from <= Channel::target_displacement && segment.to >= Channel::command_displacement) {
      compensator_.emplace(model, segment.period_s);
    }
    if (segment.to == Channel::measured_displacement) transfer_.emplace(model, segment.period_s);
  }

  [[nodiscard]] double step(StageSample sample, double measured_m) noexcept {
    double displacement_m = sample.motion.displacement_m;
    if (network_) sample.motion.displacement_m = displacement_m = network_->step(sample);
    if (compensator_) sample.motion.displacement_m = displacement_m = compensator_->step(sample, measured_m);
    if (transfer_) displacement_m = transfer_->step(sample);
    return displacement_m;
  }

 private:
  std::optional<NetworkStage> network_;
  std::optional<CompensatorStage> compensator_;
  std::optional<TransferStage> transfer_;
};

/// What was recorded beside the motion of a part, in the order of the last one's inputs; null, which stands for nominal
/// values, where an earlier part has other ones.
const double* inputs_at(const Segment& part, const Segment& last, std::size_t sample) noexcept {
  return part.inputs.names == last.inputs.names ? part.inputs.at(sample) : nullptr;
}

/// Calls `step(sample, part, i)` for each sample of a segment and of the parts before it, after the rest before the
/// first one.
/// @return the time at its end.
template <class Step>
double drive(const Segment& segment, Step&& step) {
  StageSample sample;
  double begin_s = 0.0;
  if (segment.history) {
    begin_s = drive(*segment.history, step);
  } else {
    sample.motion.displacement_m = segment.input.front().displacement_m;
    if (!segment.load_n.empty()) sample.force_n = segment.load_n.front();
    const auto rest = static_cast<std::size_t>(std::ceil(tuning::kRestBefore_s / segment.period_s));
    for (std::size_t i = 0; i < rest; ++i) step(sample, segment, 0);
  }
  for (std::size_t i = 0; i < segment.input.size(); ++i) {
    sample.time_s = begin_s + static_cast<double>(i) * segment.period_s;
    sample.motion = segment.input[i];
    if (!segment.load_n.empty()) sample.force_n = segment.load_n[i];
    step(sample, segment, i);
  }
  return begin_s + static_cast<double>(segment.input.size()) * segment.period_s;
}

std::vector<double> predict_displacement(const SiteModel& model, const Segment& segment) {
  DisplacementChain chain{model, segment};
  std::vector<double> predicted(segment.input.size());
  const bool measures = segment.to == Channel::measured_displacement;
  drive(segment, [&](const StageSample& sample, const Segment& part, std::size_t i) {
    const double measured_m = measures ? part.measured[i == 0 ? 0 : i - 1] : sample.motion.displacement_m;
    const double displacement_m = chain.step(sample, measured_m);
    if (&part == &segment) predicted[i] = displacement_m;
  });
  return predicted;
}

std::vector<double> predict_force(const SiteModel& model, const Segment& segment) {
  SensorInverse inverse{model, segment.period_s};
  SpecimenStage specimen{model, segment.period_s};
  std::vector<double> predicted(segment.input.size());
  double force_n = 0.0;
  drive(segment, [&](StageSample sample, const Segment& part, std::size_t i) {
    sample.motion = inverse.step(sample);
    sample.force_n = force_n;
    sample.inputs = inputs_at(part, segment, i);
    const double read_n = specimen.step(sample);
    if (&part == &segment) predicted[i] = read_n;
    force_n = specimen.force_n();
  });
  return predicted;
}

/// Whether a force has corners that do not follow from corners of the motion: of a law, a friction, a play, a stop or a
/// sensor at its limit. What a lag, a delay or a relaxation makes of a smoothed motion is smoothed with it.
bool has_corners(const SiteModel& model, const std::vector<Motion>& motion) {
  const auto makes_corners = [](const EffectSetting& effect) {
    const EffectTraits& traits = effect.type->traits;
    const bool is_at_force =
        effect.type->interface == EffectInterface::specimen || effect.type->interface == EffectInterface::force_sensor;
    const bool follows_place = traits.family == EffectFamily::amplitude || traits.family == EffectFamily::position;
    return is_at_force && (follows_place || traits.takes_place);
  };
  if (std::ranges::any_of(model.effects, makes_corners)) return true;
  double largest_m = 0.0;
  for (const Motion& at : motion) largest_m = std::max(largest_m, std::abs(at.displacement_m));
  return !is_spring(model, largest_m);
}

/// What of a force no spring, damper, mass and constant make of the motion.
Eigen::VectorXd not_linear_in(const std::vector<Motion>& motion, const std::vector<double>& force_n) {
  Eigen::MatrixX4d columns = motion_columns(motion);
  for (auto column : columns.colwise()) {
    const double largest = column.cwiseAbs().maxCoeff();
    if (largest > 0.0) column /= largest;
  }
  const Eigen::Map<const Eigen::VectorXd> force{force_n.data(), columns.rows()};
  const Eigen::Vector4d sizes = (columns.transpose() * columns).ldlt().solve(columns.transpose() * force);
  return force - columns * sizes;
}

/// The force of a smoothed motion, smoothed as the measured one is: a corner of the force is round there. What is
/// linear in the motion has been smoothed with it.
void smooth_corners(const Segment& segment, std::vector<double>& force_n) {
  const Eigen::VectorXd corners = not_linear_in(segment.input, force_n);
  const Eigen::Map<const Eigen::VectorXd> force{force_n.data(), corners.size()};
  if (!(corners.norm() > tuning::kRounding * force.norm())) return;
  const std::vector<double> smooth = FlatSmoother{segment.smoothed_by}.smooth({corners.data(), force_n.size()});
  for (std::size_t i = 0; i < force_n.size(); ++i) force_n[i] += smooth[i] - corners[static_cast<Eigen::Index>(i)];
}

/// At an end that is not judged, the prediction is set to the measured value.
void leave_out_ends(const Segment& segment, std::vector<double>& predicted) {
  const auto end = static_cast<std::ptrdiff_t>(segment.unjudged);
  std::copy_n(segment.measured.begin(), end, predicted.begin());
  std::copy_n(segment.measured.rbegin(), end, predicted.rbegin());
}

std::vector<Motion> sum(std::vector<Motion> motions, const std::vector<Motion>& others, double times = 1.0) {
  for (std::size_t i = 0; i < motions.size(); ++i) {
    motions[i].displacement_m += times * others[i].displacement_m;
    motions[i].velocity_m_per_s += times * others[i].velocity_m_per_s;
    motions[i].acceleration_m_per_s2 += times * others[i].acceleration_m_per_s2;
  }
  return motions;
}

}  // namespace

Eigen::MatrixX4d motion_columns(const std::vector<Motion>& motion) {
  Eigen::MatrixX4d columns(static_cast<Eigen::Index>(motion.size()), 4);
  for (Eigen::Index row = 0; row < columns.rows(); ++row) {
    const Motion& at = motion[static_cast<std::size_t>(row)];
    columns.row(row) << at.displacement_m, at.velocity_m_per_s, 1.0, at.acceleration_m_per_s2;
  }
  return columns;
}

bool is_spring(const SiteModel& model, double largest_m) {
  if (!model.make_law) return true;
  const auto force_n = [&](double displacement_m) { return model.make_law()->trial(displacement_m, 0.0); };
  const double whole_n = force_n(largest_m);
  return std::ranges::all_of(tuning::kSpringProbes, [&](double share) {
    return std::abs(force_n(share * largest_m) - share * whole_n) <= tuning::kRounding * std::abs(whole_n);
  });
}

std::vector<double> predict(const SiteModel& model, const Segment& segment, std::span<const EffectSetting> added) {
  SiteModel extended = model;
  extended.inputs = segment.inputs.names;
  extended.reversal_noise_m = segment.reversal_noise_m;
  if (segment.is_quasi_static) {
    std::erase_if(extended.effects, [](const EffectSetting& effect) { return effect.type->traits.needs_time; });
  }
  for (const EffectSetting& effect : added) {
    if (segment.touched_by(*effect.type)) add_effect(extended, effect);
  }
  if (segment.is_smoothed()) {
    // Smoothing removes the steps of the converter too.
    const EffectType* const steps = find_effect(EffectInterface::force_sensor, DigitTrace::rounding);
    std::erase_if(extended.effects, [steps](const EffectSetting& effect) { return effect.type == steps; });
  }
  std::vector<double> predicted = segment.to == Channel::measured_force ? predict_force(extended, segment)
                                                                        : predict_displacement(extended, segment);
  if (segment.smoothed_by > 0.0 && has_corners(extended, segment.input)) smooth_corners(segment, predicted);
  leave_out_ends(segment, predicted);
  return predicted;
}

Segment with_noise(const Segment& segment, const std::vector<Motion>& noise, double times) {
  Segment noisy = segment;
  noisy.input = sum(segment.input, noise, times);
  // What a prediction does not read.
  for (std::vector<Motion>* unread : {&noisy.noise, &noisy.told_noise, &noisy.narrow_input, &noisy.narrow_noise}) {
    *unread = {};
  }
  noisy.smoothing_errors = {};
  return noisy;
}

InputErrors input_errors(const SiteModel& model, const Segment& segment, std::span<const EffectSetting> added) {
  if (segment.noise.empty()) return {};
  const auto predicted = [&](const std::vector<Motion>& input) {
    Segment other = segment;
    other.input = input;
    return predict(model, other, added);
  };
  const auto change = [](std::vector<double> values, const std::vector<double>& from) {
    for (std::size_t i = 0; i < values.size(); ++i) values[i] -= from[i];
    return values;
  };
  const std::vector<double> wide = predict(model, segment, added);
  InputErrors errors;
  // What is told is the noise itself, and another one than a draw with that of the readings: slow noise with it.
  errors.of_noise = segment.told_noise.empty()
                        ? change(predict(model, with_noise(segment, segment.noise, 1.0), added), wide)
                        : change(wide, predict(model, with_noise(segment, segment.told_noise, -1.0), added));
  if (segment.narrow_input.empty()) return errors;
  const std::vector<double> narrow = predicted(segment.narrow_input);
  errors.of_window = change(narrow, wide);
  errors.of_narrow_noise = change(predicted(sum(segment.narrow_input, segment.narrow_noise)), narrow);
  return errors;
}

bool take_place_in(const SiteModel& model, std::span<const EffectSetting> effects) noexcept {
  return std::ranges::any_of(effects, [&](const EffectSetting& effect) {
    return replaces_law(effect) || place_of(model, *effect.type) != nullptr ||
           effect.type->traits.number == ModelNumber::stiffness;
  });
}

double input_floor(const InputErrors& errors, const std::function<double(std::span<const double>)>& root_mean_square) {
  const auto squared = [&](const std::vector<double>& values) {
    return values.empty() ? 0.0 : std::pow(root_mean_square(values), 2);
  };
  const double taken_off = std::max(0.0, squared(errors.of_window) - squared(errors.of_narrow_noise));
  return std::sqrt(squared(errors.of_noise) + taken_off);
}

double noise_floor(const Segment& segment, const InputErrors& errors) {
  const double of_input = input_floor(errors, [](std::span<const double> values) {
    double squares = 0.0;
    for (const double value : values) squares += value * value;
    return std::sqrt(squares / static_cast<double>(values.size()));
  });
  return noise_floor_of_means(segment, of_input, 1.0);
}

double noise_floor_of_means(const Segment& segment, double of_input, double independent) {
  const double of_readings = std::max(segment.measured_noise / std::sqrt(independent), segment.step_noise);
  return std::hypot(of_readings, of_input, segment.smoothing_error);
}

}  // namespace hybridtest
