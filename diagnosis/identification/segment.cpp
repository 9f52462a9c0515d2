#include "diagnosis/identification/segment.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/random.hpp"
#include "diagnosis/identification/quasi_static.hpp"
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
  return FlatSmoother{segment.smoothed_by}.smooth(
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

Segment with_plain_motion(const Segment& smooth, const DofRecording& dof) {
  Segment plain = smooth;
  plain.smoothed_by = 0.0;
  plain.input = LocalPolynomial{LocalPolynomial::kHalfWidthMin, smooth.period_s}.motion(input_of(smooth, dof));
  plain.reversal_noise_m =
      reversal_noise_m(std::hypot(smooth.input_noise, smooth.input_step / std::sqrt(12.0)), plain.input.size());
  plain.unjudged = 0;
  return plain;
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

}  // namespace hybridtest
