#include "diagnosis/identification/segment.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <ranges>

#include "core/random.hpp"
#include "diagnosis/identification/quasi_static.hpp"
#include "diagnosis/identification/search_table.hpp"
#include "diagnosis/signals/between_steps.hpp"
#include "diagnosis/signals/signals.hpp"
#include "diagnosis/traces/traces.hpp"
#include "diagnosis/tuning.hpp"

namespace hybridtest {

namespace {

using enum EffectInterface;

constexpr std::array kDisplacementChain{Channel::sent_displacement, Channel::target_displacement,
                                        Channel::command_displacement, Channel::measured_displacement};

EffectInterface interface_ending_in(Channel channel) noexcept {
  switch (channel) {
    case Channel::target_displacement: return network;
    case Channel::command_displacement: return compensator;
    case Channel::measured_force: return specimen;
    default: return transfer_system;
  }
}

/// One random error of readings: white noise of this level or, for a coarse converter, what is wrong between its steps
/// for a motion that is shifted by half a step.
std::vector<double> drawn_error(std::span<const Motion> motion, double level, double step) {
  Random random{tuning::kNoiseSeed};
  std::vector<double> error(motion.size());
  if (!(step > 0.0)) {
    std::ranges::generate(error, [&] { return level * random.normal(); });
    return error;
  }
  const auto place = [&](std::size_t i) { return motion[i].displacement_m + 0.5 * step; };
  for (std::size_t i = 0; i < error.size(); ++i) error[i] = step * std::round(place(i) / step);
  error = between_steps(error, step);
  for (std::size_t i = 0; i < error.size(); ++i) error[i] -= place(i);
  return error;
}

/// What was read where a segment begins, between the steps of a coarse converter.
std::vector<double> input_of(const Segment& segment, const DofRecording& dof) {
  const std::vector<double>& readings = dof.of(segment.from);
  return segment.input_step > 0.0 ? between_steps(readings, segment.input_step) : readings;
}

/// See Segment::reversal_noise_m.
double reversal_noise_m(double deviation_m, std::size_t samples) { return 2.0 * peak_of_noise(deviation_m, samples); }

double reversal_noise_m(const std::vector<Motion>& noise) {
  return noise.empty() ? 0.0 : reversal_noise_m(std::sqrt(mean_square(displacements_of(noise))), noise.size());
}

/// Smooths the measured displacement, and also over half the window: the difference shows what smoothing removes.
void smooth_input(Segment& segment, std::span<const double> displacement_m, std::size_t half_width) {
  segment.half_width = half_width;
  const LocalPolynomial polynomial{half_width, segment.period_s};
  segment.input = polynomial.motion(displacement_m);
  const std::vector<double> error = drawn_error(segment.input, segment.input_noise, segment.input_step);
  segment.noise = polynomial.motion(error);
  segment.narrow_input.clear();
  segment.narrow_noise.clear();
  segment.reversal_noise_m = reversal_noise_m(segment.noise);
  if (half_width / 2 < LocalPolynomial::kHalfWidthMin) return;
  const LocalPolynomial narrow{half_width / 2, segment.period_s};
  segment.narrow_input = narrow.motion(displacement_m);
  segment.narrow_noise = narrow.motion(error);
}

/// Readings over the widest window that leaves nothing but noise.
std::vector<double> without_noise(std::span<const double> readings) {
  return displacements_of(LocalPolynomial{widest_faithful_half_width(readings), 1.0}.motion(readings));
}

std::vector<Motion> smooth_motion(const FlatSmoother& smoother, std::vector<Motion> motion) {
  for (double Motion::*channel : {&Motion::displacement_m, &Motion::velocity_m_per_s, &Motion::acceleration_m_per_s2}) {
    std::vector<double> values(motion.size());
    std::ranges::transform(motion, values.begin(), [channel](const Motion& at) { return at.*channel; });
    values = smoother.smooth(values);
    for (std::size_t i = 0; i < motion.size(); ++i) motion[i].*channel = values[i];
  }
  return motion;
}

Segment segment_between(const Recording& recording, std::size_t position, const DofRecording& dof, Channel from,
                        Channel to) {
  Segment segment;
  segment.from = from;
  segment.to = to;
  segment.interface = interface_ending_in(to);
  segment.recording = position;
  segment.period_s = recording.sample_period_s;
  segment.measured = dof.of(to);
  if (to != Channel::measured_force) {
    segment.input = LocalPolynomial{widest_faithful_half_width(dof.of(from)), segment.period_s}.motion(dof.of(from));
    // Commands are exact; smoothing is for their derivatives.
    for (std::size_t i = 0; i < segment.input.size(); ++i) segment.input[i].displacement_m = dof.of(from)[i];
    if (dof.has(Channel::measured_force)) {
      segment.load_n = without_noise(dof.of(Channel::measured_force));
      std::shift_right(segment.load_n.begin(), segment.load_n.end(), 1);  // the first one stands for that before it
    }
  } else {
    segment.input_step = steps_of_readings(dof.of(from)).step;
    const std::vector<double> input_m = input_of(segment, dof);
    segment.input_noise = white_noise_level(input_m);
    // Between the steps hardly any white noise is left, as which the steps of a fast motion appear: the wider window
    // leaves less of either.
    const std::size_t half_width =
        std::max(widest_faithful_half_width(input_m), widest_faithful_half_width(dof.of(from)));
    smooth_input(segment, input_m, half_width);
    segment.inputs = inputs_of(recording);
  }
  segment.measured_noise = white_noise_level(segment.measured);
  if (to >= Channel::measured_displacement) {
    // Of an error uniformly distributed over plus or minus half a step.
    segment.step_noise = steps_of_readings(segment.measured).step / std::sqrt(12.0);
  }
  return segment;
}

bool passes(const Segment& segment, EffectInterface stage) noexcept {
  const auto lies_between = [&](Channel in, Channel out) { return segment.from <= in && segment.to >= out; };
  switch (stage) {
    case network: return lies_between(Channel::sent_displacement, Channel::target_displacement);
    case compensator: return lies_between(Channel::target_displacement, Channel::command_displacement);
    case transfer_system: return segment.to == Channel::measured_displacement;
    case displacement_sensor:
      return segment.to == Channel::measured_displacement || segment.from == Channel::measured_displacement;
    case specimen:
    case force_sensor: return segment.to == Channel::measured_force;
    case numerical_substructure: return false;
  }
  return false;
}

InputTable smooth_inputs(const FlatSmoother& smoother, InputTable inputs) {
  const std::size_t columns = inputs.names.size();
  for (std::size_t column = 0; column < columns; ++column) {
    std::vector<double> values;
    for (std::size_t i = column; i < inputs.values.size(); i += columns) values.push_back(inputs.values[i]);
    values = smoother.smooth(values);
    for (std::size_t i = 0; i < values.size(); ++i) inputs.values[i * columns + column] = values[i];
  }
  return inputs;
}

}  // namespace

InputTable inputs_of(const Recording& recording) {
  InputTable table;
  for (const RecordedChannel& input : recording.inputs) table.names.push_back(input.name);
  for (std::size_t i = 0; i < recording.samples; ++i) {
    for (const RecordedChannel& input : recording.inputs) table.values.push_back(input.samples[i]);
  }
  return table;
}

namespace {

bool contains(const std::vector<std::string>& names, std::string_view name) noexcept {
  return std::ranges::find(names, name) != names.end();
}

/// Whatever its input does.
bool can_be_touched(const Segment& segment, const EffectType& effect) noexcept {
  if (!passes(segment, effect.interface) || (segment.is_quasi_static && effect.traits.needs_time)) return false;
  return effect.interface != displacement_sensor || segment.to == Channel::measured_displacement ||
         effect.make_inverse != nullptr;
}

}  // namespace

bool InputTable::has(std::string_view name) const noexcept { return contains(names, name); }

bool Segment::touched_by(const EffectType& effect) const noexcept {
  if (!can_be_touched(*this, effect)) return false;
  return effect.input.empty() || (inputs.has(effect.input) && !is_reference_of(effect));
}

bool Segment::touched_by(std::span<const EffectSetting> effects) const noexcept {
  return std::ranges::any_of(effects, [&](const EffectSetting& effect) { return touched_by(*effect.type); });
}

bool Segment::is_reference_of(const EffectType& effect) const noexcept {
  // A formula need not be absent at the reference of its input.
  return effect.formula == nullptr && can_be_touched(*this, effect) && contains(inputs.at_reference, effect.input);
}

std::vector<Motion> motion_of_readings(const Segment& segment, std::span<const double> readings) {
  return smooth_motion(FlatSmoother{segment.smoothed_by},
                       LocalPolynomial{segment.half_width, segment.period_s}.motion(readings));
}

Segment smoothed_alike(const Segment& segment, const DofRecording& dof, double deviation) {
  const FlatSmoother smoother{deviation};
  Segment result = segment;
  result.half_width = LocalPolynomial::kHalfWidthMin;
  result.smoothed_by = deviation;
  result.input = motion_of_readings(result, input_of(segment, dof));
  result.noise = motion_of_readings(result, drawn_error(result.input, segment.input_noise, segment.input_step));
  result.reversal_noise_m = reversal_noise_m(result.noise);
  result.narrow_input.clear();
  result.narrow_noise.clear();
  result.inputs = smooth_inputs(smoother, segment.inputs);
  result.measured = smoother.smooth(dof.of(segment.to));
  result.unjudged = std::min(smoother.reach() + LocalPolynomial::kHalfWidthMin, result.measured.size() / 2);
  result.recorded = deviation > 0.0 ? AsRecorded{dof.of(segment.to), segment.measured_noise} : AsRecorded{};
  result.noise_span = 1.0 / smoother.noise_share();
  result.measured_noise = segment.measured_noise * std::sqrt(smoother.noise_share());
  result.step_noise = segment.step_noise * std::sqrt(smoother.noise_share());
  return result;
}

Segment thinned(const Segment& segment, double rate_hz) {
  const auto stride = static_cast<std::size_t>(std::max(1.0, std::floor(1.0 / (rate_hz * segment.period_s))));
  if (stride == 1 || passes(segment, compensator)) return segment;
  const auto every = [stride](const auto& values) { return every_nth(values, stride); };
  Segment result = segment;
  result.period_s = segment.period_s * static_cast<double>(stride);
  result.smoothed_by = segment.smoothed_by / static_cast<double>(stride);
  result.unjudged = (segment.unjudged + stride - 1) / stride;
  result.noise_span = std::max(1.0, segment.noise_span / static_cast<double>(stride));
  result.input = every(segment.input);
  result.load_n = every(segment.load_n);
  result.noise = every(segment.noise);
  result.told_noise = every(segment.told_noise);
  result.narrow_input = every(segment.narrow_input);
  result.narrow_noise = every(segment.narrow_noise);
  result.inputs.values.clear();
  for (std::size_t i = 0; i < segment.input.size() && !segment.inputs.names.empty(); i += stride) {
    result.inputs.values.insert(result.inputs.values.end(), segment.inputs.at(i), segment.inputs.at(i + 1));
  }
  result.measured = every(segment.measured);
  result.recorded.values = every(segment.recorded.values);
  result.smoothing_errors = every(segment.smoothing_errors);
  if (segment.history) result.history = std::make_shared<const Segment>(thinned(*segment.history, rate_hz));
  return result;
}

std::vector<Segment> segments_of(const Recording& recording, std::size_t dof_index, std::size_t position) {
  const DofRecording& dof = recording.dofs[dof_index];
  if (recording.is_quasi_static) return quasi_static_segments(recording, dof, position);
  std::vector<Segment> segments;
  const Channel* previous = nullptr;
  for (const Channel& channel : kDisplacementChain) {
    if (!dof.has(channel)) continue;
    if (previous != nullptr) segments.push_back(segment_between(recording, position, dof, *previous, channel));
    previous = &channel;
  }
  if (dof.has(Channel::measured_displacement) && dof.has(Channel::measured_force)) {
    segments.push_back(
        segment_between(recording, position, dof, Channel::measured_displacement, Channel::measured_force));
  }
  return segments;
}

bool is_modelled(const SiteModel& model, const Segment& segment) {
  if (segment.to != Channel::measured_force || model.make_law) return true;
  return std::ranges::any_of(
      model.effects, [](const EffectSetting& effect) { return effect.type->interface == EffectInterface::specimen; });
}

namespace {

/// Whether the model has inertia or damping in addition to its law.
bool follows_derivatives(const SiteModel& model) {
  return std::ranges::any_of(model.effects, [](const EffectSetting& effect) {
    return effect.type->interface == EffectInterface::specimen && effect.type->traits.follows_derivatives;
  });
}

bool can_be_smoothed(const Segment& segment) {
  return segment.to == Channel::measured_force && !segment.is_quasi_static;
}

/// The corners of its force are predicted as they are, not smoothed with the measured ones.
Segment with_corners(Segment segment) {
  segment.smoothed_by = 0.0;
  return segment;
}

/// See Segment::smoothing_errors.
std::vector<double> smoothing_errors(const SiteModel& model, const Segment& smooth, const DofRecording& dof,
                                     double deviation) {
  Segment plain = with_corners(smooth);
  plain.input = LocalPolynomial{LocalPolynomial::kHalfWidthMin, smooth.period_s}.motion(input_of(smooth, dof));
  plain.reversal_noise_m =
      reversal_noise_m(std::hypot(smooth.input_noise, smooth.input_step / std::sqrt(12.0)), plain.input.size());
  plain.unjudged = 0;
  std::vector<double> errors = FlatSmoother{deviation}.smooth(predict(model, plain));
  const std::vector<double> first_motion = predict(model, smooth);
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const bool is_judged = i >= smooth.unjudged && i + smooth.unjudged < errors.size();
    errors[i] = is_judged ? errors[i] - first_motion[i] : 0.0;
  }
  return errors;
}

double squared_difference(const std::vector<double>& values, const std::vector<double>& others) {
  double squares = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) squares += std::pow(values[i] - others[i], 2);
  return squares;
}

/// The deviation with the least squares of all that are tried, and these.
struct Deviation {
  double value = 0.0;
  double squares = std::numeric_limits<double>::infinity();
};

/// @param squares   that one deviation of the motion leaves of the recorded force.
template <class Squares>
Deviation best_deviation(const Segment& segment, const DofRecording& dof, const PartProgress& progress,
                         Squares&& squares) {
  Deviation best;
  for (const double deviation : tuning::kSmoothingDeviations) {
    progress.alive();
    const double here = squares(with_corners(smoothed_alike(segment, dof, deviation)));
    if (here < best.squares) best = {deviation, here};
  }
  return best;
}

Segment smoothed_by(const SiteModel& model, const Segment& segment, const DofRecording& dof, double best) {
  const double deviation = tuning::kSmoothingNextStep * best;
  Segment smooth = smoothed_alike(segment, dof, deviation);
  smooth.smoothing_errors = smoothing_errors(model, smooth, dof, deviation);
  smooth.smoothing_error = std::sqrt(mean_square(smooth.smoothing_errors));
  return smooth;
}

Segment best_smoothed(const SiteModel& model, const Segment& segment, const DofRecording& dof,
                      const PartProgress& progress) {
  const Deviation best = best_deviation(segment, dof, progress, [&](const Segment& tried) {
    return squared_difference(segment.measured, predict(model, tried));
  });
  return smoothed_by(model, segment, dof, best.value);
}

/// What may stand beside the model and a spring and a damper.
struct MayStand {
  bool friction = false;  // dry friction and other hysteresis
  bool mass = false;
};

/// The way of sliders that are held by springs and slide after distances in the range of a friction's, beside each
/// other: what they carry is any hysteresis that does not depend on the rate (Iwan, 1966). One column for each slider.
Eigen::MatrixXd held_back(const std::vector<Motion>& motion) {
  const EffectType* const friction = find_effect(specimen, "coulomb_friction");
  const SearchRange& range = *search_range(
      *friction, *std::ranges::find(friction->parameters, "presliding_displacement_m", &EffectParameter::name));
  const std::array after{range.low, std::sqrt(range.low * range.high), range.high};
  const auto [low, high] = std::ranges::minmax_element(motion, {}, &Motion::displacement_m);
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(motion.size()), std::ssize(after));
  for (Eigen::Index column = 0; column < columns.cols(); ++column) {
    const double slides_m =
        after[static_cast<std::size_t>(column)] * 0.5 * (high->displacement_m - low->displacement_m);
    double held_m = 0.0;
    for (Eigen::Index row = 0; row < columns.rows(); ++row) {
      const auto i = static_cast<std::size_t>(row);
      const double moved_m = i == 0 ? 0.0 : motion[i].displacement_m - motion[i - 1].displacement_m;
      held_m = std::clamp(held_m + moved_m, -slides_m, slides_m);
      columns(row, column) = held_m;
    }
  }
  return columns;
}

/// What least squares leave of a right side, the columns from `free` on with no size below zero [sum of squares].
double left_by(Eigen::MatrixXd columns, const Eigen::VectorXd& right, Eigen::Index free) {
  while (true) {
    const Eigen::VectorXd sizes = columns.colPivHouseholderQr().solve(right);
    Eigen::Index least = columns.cols();
    if (columns.cols() == free || sizes.tail(columns.cols() - free).minCoeff(&least) >= 0.0) {
      return (right - columns * sizes).squaredNorm();
    }
    columns.col(free + least) = columns.rightCols(1).eval();
    columns.conservativeResize(Eigen::NoChange, columns.cols() - 1);
  }
}

/// What the model and what may stand beside it leave of a force along the motion of a smoothed segment [mean square].
/// A friction and a mass are not negative: dry friction would be such a mass in part, and a force that comes late such
/// a friction.
double left_beside(const SiteModel& model, const std::vector<double>& force_n, const Segment& smooth, MayStand beside) {
  const auto first = static_cast<Eigen::Index>(smooth.unjudged);
  const auto judged = static_cast<Eigen::Index>(force_n.size()) - 2 * first;
  if (judged < static_cast<Eigen::Index>(tuning::kSamplesMin)) return std::numeric_limits<double>::infinity();
  const std::vector<double> predicted = predict(model, smooth);
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(force_n.size()), 5);
  columns << Eigen::Map<const Eigen::VectorXd>{predicted.data(), columns.rows()}, motion_columns(smooth.input);
  const Eigen::Index free = columns.cols() - 1;  // all but the mass
  if (!beside.mass) columns.conservativeResize(Eigen::NoChange, free);
  if (beside.friction) {
    const Eigen::MatrixXd sliders = held_back(smooth.input);
    columns.conservativeResize(Eigen::NoChange, columns.cols() + sliders.cols());
    columns.rightCols(sliders.cols()) = sliders;
  }
  const Eigen::VectorXd right =
      Eigen::Map<const Eigen::VectorXd>{force_n.data(), columns.rows()}.segment(first, judged);
  return left_by(columns.middleRows(first, judged), right, free) / static_cast<double>(judged);
}

/// A specimen that is simulated turns at reversals that are as small as the noise, too, and a real one does not: they
/// are ignored unless the force is nearer to the model's with them.
void settle_reversals(const SiteModel& model, Segment& segment) {
  if (segment.to != Channel::measured_force || !(segment.reversal_noise_m > 0.0)) return;
  Segment with_all = segment;
  with_all.reversal_noise_m = 0.0;
  const bool are_nearer = left_beside(model, segment.measured, with_all, MayStand{}) <
                          left_beside(model, segment.measured, segment, MayStand{});
  if (are_nearer) segment.reversal_noise_m = 0.0;
}

/// The motion alone smoothed, the force as it is.
Segment with_smooth_motion(const Segment& segment, double deviation) {
  Segment result = segment;
  result.input = smooth_motion(FlatSmoother{deviation}, segment.input);
  return result;
}

/// Smoothed alike where there is a gap of which a mass that the model lacks explains more than half: the noise of an
/// acceleration that is not smoothed hides most of such a mass.
/// @param friction   beside dry friction.
std::optional<Segment> smoothed_for_mass(const SiteModel& model, const Segment& segment, const DofRecording& dof,
                                         bool friction, const PartProgress& progress) {
  const MayStand with_mass{.friction = friction, .mass = true};
  const Deviation best = best_deviation(segment, dof, progress, [&](const Segment& tried) {
    return left_beside(model, segment.measured, tried, with_mass);
  });
  if (!(best.value > 0.0)) return {};
  Segment smooth = smoothed_by(model, segment, dof, best.value);
  const double output = std::sqrt(mean_square(segment.measured));
  const double floor = std::hypot(smooth.measured_noise, tuning::kModelAllowance * output);
  // Force and motion are smoothed alike, so that what smoothing takes off the one does not look like a mass.
  const double without = left_beside(model, smooth.measured, smooth, {.friction = friction});
  const double with = left_beside(model, smooth.measured, smooth, with_mass);
  // Of a law with hysteresis, smoothing may take off as much as the gap.
  const double unseen = std::max(floor, smooth.smoothing_error);
  const bool explains_a_gap = without > std::pow(tuning::kNearFloor * unseen, 2) && with < tuning::kMainShare * without;
  return explains_a_gap ? std::optional{std::move(smooth)} : std::nullopt;
}

}  // namespace

std::vector<double> change_by_smoothing(const SiteModel& model, const Segment& segment) {
  if (!can_be_smoothed(segment) || segment.noise.empty() || segment.is_smoothed()) return {};
  std::vector<Deviation> tried;
  for (const double deviation : tuning::kSmoothingDeviations) {
    tried.push_back(
        {deviation, left_beside(model, segment.measured, with_smooth_motion(segment, deviation), MayStand{})});
  }
  const double least = std::ranges::min(tried, {}, &Deviation::squares).squares;
  // Wider ones cut the corners of the law off.
  const auto enough = std::ranges::find_if(
      tried, [&](const Deviation& one) { return one.squares <= tuning::kSmoothingLeaves * least; });
  if (!(enough->value > 0.0)) return {};
  std::vector<double> change = predict(model, with_smooth_motion(segment, enough->value));
  const std::vector<double> as_it_is = predict(model, segment);
  for (std::size_t i = 0; i < change.size(); ++i) change[i] -= as_it_is[i];
  return change;
}

std::vector<Segment> modelled_segments(const SiteModel& model, const Recording& recording, std::size_t dof,
                                       std::size_t position) {
  return modelled_segments(model, recording, dof, position, model);
}

std::vector<Segment> modelled_segments(const SiteModel& model, const Recording& recording, std::size_t dof,
                                       std::size_t position, const SiteModel& completed, const PartProgress& progress) {
  std::vector<Segment> segments;
  for (Segment& segment : segments_of(recording, dof, position)) {
    if (!is_modelled(model, segment)) continue;
    const bool is_smoothed = can_be_smoothed(segment) && follows_derivatives(completed);
    segments.push_back(is_smoothed ? best_smoothed(completed, segment, recording.dofs[dof], progress)
                                   : std::move(segment));
    settle_reversals(completed, segments.back());
  }
  return segments;
}

std::vector<Segment> segments_to_search(const SiteModel& model, const Recording& recording, std::size_t dof,
                                        std::size_t position, const PartProgress& progress) {
  std::vector<Segment> segments = modelled_segments(model, recording, dof, position, model, progress);
  for (Segment& segment : segments) {
    if (!can_be_smoothed(segment) || follows_derivatives(model)) continue;
    for (const bool friction : {false, true}) {
      auto smooth = smoothed_for_mass(model, segment, recording.dofs[dof], friction, progress);
      if (!smooth) continue;
      segment = *std::move(smooth);
      break;
    }
  }
  return segments;
}

}  // namespace hybridtest
