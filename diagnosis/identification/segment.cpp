#include "diagnosis/identification/segment.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

#include "core/random.hpp"
#include "diagnosis/signals/local_polynomial.hpp"
#include "diagnosis/traces/reading_steps.hpp"

namespace hybridtest {
namespace {

using enum EffectInterface;

/// Of the one draw of noise that floors are taken from.
constexpr std::uint64_t kNoiseSeed = 1;

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

/// What smoothing leaves wrong in a motion: one draw of white noise of that level, smoothed as the signal is, and what
/// smoothing has taken off the signal, which is about what smoothing once more takes off.
std::vector<Motion> left_wrong(const LocalPolynomial& polynomial, double level, const std::vector<Motion>& smoothed) {
  Random random{kNoiseSeed};
  std::vector<double> noise(smoothed.size());
  std::vector<double> displacement_m(smoothed.size());
  for (double& value : noise) value = level * random.normal();
  std::ranges::transform(smoothed, displacement_m.begin(), &Motion::displacement_m);
  std::vector<Motion> wrong = polynomial.motion(noise);
  const std::vector<Motion> twice = polynomial.motion(displacement_m);
  for (std::size_t i = 0; i < wrong.size(); ++i) {
    wrong[i].displacement_m += twice[i].displacement_m - smoothed[i].displacement_m;
    wrong[i].velocity_m_per_s += twice[i].velocity_m_per_s - smoothed[i].velocity_m_per_s;
    wrong[i].acceleration_m_per_s2 += twice[i].acceleration_m_per_s2 - smoothed[i].acceleration_m_per_s2;
  }
  return wrong;
}

/// Standard deviation of an even error between half a step each way.
double step_noise(std::span<const double> values) { return steps_of_readings(values).step / std::sqrt(12.0); }

/// Of a signal that is to be smoothed: what is white in it, or what a coarse converter adds, whichever is more.
double input_noise(std::span<const double> values) { return std::max(white_noise_level(values), step_noise(values)); }

Segment segment_between(const Recording& recording, std::size_t position, const DofRecording& dof, Channel from,
                        Channel to) {
  Segment segment;
  segment.from = from;
  segment.to = to;
  segment.interface = interface_ending_in(to);
  segment.recording = position;
  segment.period_s = recording.sample_period_s;
  const LocalPolynomial polynomial{widest_faithful_half_width(dof.of(from)), recording.sample_period_s};
  segment.input = polynomial.motion(dof.of(from));
  segment.measured = dof.of(to);
  if (to != Channel::measured_force) {
    // Commands are exact; smoothing is for their derivatives.
    for (std::size_t i = 0; i < segment.input.size(); ++i) segment.input[i].displacement_m = dof.of(from)[i];
    if (dof.has(Channel::measured_force)) segment.load_n = dof.of(Channel::measured_force);
  } else {
    segment.input_noise = input_noise(dof.of(from));
    segment.noise = left_wrong(polynomial, segment.input_noise, segment.input);
  }
  segment.measured_noise = white_noise_level(segment.measured);
  if (to >= Channel::measured_displacement) segment.step_noise = step_noise(segment.measured);
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

}  // namespace

bool Segment::touched_by(const EffectType& effect) const noexcept {
  if (!passes(*this, effect.interface)) return false;
  return effect.interface != displacement_sensor || to == Channel::measured_displacement ||
         effect.make_inverse != nullptr;
}

Segment with_half_width(const Segment& segment, const DofRecording& dof, std::size_t half_width) {
  const std::vector<double>& displacement_m = dof.of(Channel::measured_displacement);
  const LocalPolynomial polynomial{half_width, segment.period_s};
  Segment result = segment;
  result.input = polynomial.motion(displacement_m);
  result.noise = left_wrong(polynomial, result.input_noise, result.input);
  return result;
}

Segment thinned(const Segment& segment, double rate_hz) {
  const auto stride = static_cast<std::size_t>(std::max(1.0, std::floor(1.0 / (rate_hz * segment.period_s))));
  if (stride == 1 || passes(segment, compensator)) return segment;
  const auto every = [stride](const auto& values) {
    std::remove_cvref_t<decltype(values)> kept;
    for (std::size_t i = 0; i < values.size(); i += stride) kept.push_back(values[i]);
    return kept;
  };
  Segment result = segment;
  result.period_s = segment.period_s * static_cast<double>(stride);
  result.input = every(segment.input);
  result.load_n = every(segment.load_n);
  result.noise = every(segment.noise);
  result.measured = every(segment.measured);
  return result;
}

std::vector<Segment> segments_of(const Recording& recording, std::size_t dof_index, std::size_t position) {
  const DofRecording& dof = recording.dofs[dof_index];
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
