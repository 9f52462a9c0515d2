#include "diagnosis/verdict/experiments.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>

#include "diagnosis/page/wording.hpp"
#include "diagnosis/signals/signals.hpp"
#include "diagnosis/tuning.hpp"

namespace hybridtest {

namespace {

double deviation(std::span<const double> values) { return std::sqrt(variance(values)); }

std::string_view unit_of(Channel channel) { return channel == Channel::measured_force ? "N" : "m"; }

/// Ratio of a signal to its limit; the smaller of input and output.
double margin(const Excitation& excitation) {
  const auto over = [](double size, double noise) {
    return size <= 0.0 ? 0.0 : noise > 0.0 ? size / noise : std::numeric_limits<double>::max();
  };
  return std::min(over(excitation.motion_m, excitation.motion_noise_m),
                  over(excitation.output_size, excitation.output_floor));
}

}  // namespace

bool Excitation::moves() const noexcept {
  return motion_m > 0.0 && motion_m >= tuning::kExcitedOverNoise * motion_noise_m;
}

bool Excitation::shows() const noexcept {
  return output_size > 0.0 && output_size >= tuning::kExcitedOverNoise * output_floor;
}

bool Excitation::can_tell() const noexcept { return moves() && shows(); }

bool Excitation::is_measured() const noexcept {
  return output == Channel::measured_displacement || output == Channel::measured_force;
}

std::string Excitation::why_not() const {
  if (motion_m <= 0.0) return fmt::format("{} never changes", column_name(input));
  if (!moves()) {
    return fmt::format("{} moves by {}, within its noise ({})", column_name(input), report::quantity(motion_m, "m"),
                       report::quantity(motion_noise_m, "m"));
  }
  if (output_size <= 0.0) return fmt::format("{} never changes", column_name(output));
  if (!shows()) {
    return fmt::format("{} changes by {}, within its noise ({})", column_name(output),
                       report::quantity(output_size, unit_of(output)), report::quantity(output_floor, unit_of(output)));
  }
  return {};
}

std::vector<Excitation> excitations_of(const IdentificationProblem& problem) {
  std::vector<Excitation> excitations;
  for (const FitSegment& fit : problem.segments) {
    Excitation excitation;
    excitation.interface = name_of(fit.segment.interface);
    excitation.input = fit.segment.from;
    excitation.output = fit.segment.to;
    excitation.motion_m = deviation(displacements_of(fit.segment.input));
    excitation.motion_noise_m = deviation(displacements_of(fit.segment.noise));
    excitation.output_size = deviation({fit.measured.data(), static_cast<std::size_t>(fit.measured.size())});
    excitation.output_floor = fit.floor;
    excitations.push_back(std::move(excitation));
  }
  return excitations;
}

bool cannot_tell(const std::vector<Excitation>& excitations) {
  const bool measures = std::ranges::any_of(excitations, &Excitation::is_measured);
  return std::ranges::none_of(excitations, [&](const Excitation& excitation) {
    return excitation.can_tell() && (excitation.is_measured() || !measures);
  });
}

std::string experiment_that_excites(const std::vector<Excitation>& excitations) {
  if (excitations.empty() || !cannot_tell(excitations)) return {};
  const bool measures = std::ranges::any_of(excitations, &Excitation::is_measured);
  const Excitation* closest = nullptr;
  for (const Excitation& excitation : excitations) {
    if (measures && !excitation.is_measured()) continue;
    if (closest == nullptr || margin(excitation) > margin(*closest)) closest = &excitation;
  }
  const auto still =
      std::ranges::find_if(excitations, [](const Excitation& excitation) { return excitation.motion_m <= 0.0; });
  if (still != excitations.end()) return "Record a test with motion: " + still->why_not() + ".";
  if (closest->output_size <= 0.0) return "Check the sensor: " + closest->why_not() + ".";
  return fmt::format(
      "Repeat with at least {:.0f} times the motion, or with sensor noise smaller by this factor: {}. At thirty times "
      "the noise, an effect on a tenth of the signal can be found.",
      std::ceil(tuning::kWellExcitedOverNoise / margin(*closest)), closest->why_not());
}

void leave_out_unexcited(const std::vector<Excitation>& excitations, std::vector<report::InterfaceGap>& where) {
  for (report::InterfaceGap& gap : where) {
    if (gap.is_at_fault) continue;
    const auto is_here = [&](const Excitation& excitation) { return excitation.interface == gap.interface; };
    const auto first = std::ranges::find_if(excitations, is_here);
    const bool tells = std::ranges::any_of(
        excitations, [&](const Excitation& excitation) { return is_here(excitation) && excitation.can_tell(); });
    if (first == excitations.end() || tells) continue;
    gap.is_judged = false;
    gap.why_not = first->why_not();
  }
}

using enum EffectInterface;

std::string experiment_that_splits(const std::vector<const EffectType*>& effects) {
  if (effects.size() < 2) return {};
  const auto any_at = [&](EffectInterface interface) {
    return std::ranges::any_of(effects, [&](const EffectType* effect) { return effect->interface == interface; });
  };
  const auto is_of = [](EffectFamily family) {
    return [family](const EffectType* effect) { return effect->traits.family == family; };
  };
  const auto any_of = [&](EffectFamily family) { return std::ranges::any_of(effects, is_of(family)); };
  const auto follows_input = [](const EffectType* effect) { return !effect->input.empty(); };
  const auto of_input = std::ranges::find_if(effects, follows_input);
  if (of_input != effects.end() && !std::ranges::all_of(effects, follows_input)) {
    return "Repeat the test with " + std::string{(*of_input)->input} +
           " held constant, and once more at another value: only what follows it changes between the two.";
  }
  if (any_of(EffectFamily::mass)) {
    return "Air run: the same motion without the specimen. Inertia forces and load cell errors remain; the forces of "
           "the specimen are zero.";
  }
  if (any_at(force_sensor) && any_at(specimen)) {
    return any_of(EffectFamily::rate) ? "Repeat the test at half the rate: the effect of a sensor lag becomes smaller; "
                                        "that of the specimen does not change."
                                      : "Put a dead weight of known size on the load cell and compare its reading.";
  }
  if (any_at(displacement_sensor)) {
    return "Put a second displacement transducer beside the first, or step the actuator through gauge blocks.";
  }
  if (std::ranges::all_of(effects, is_of(EffectFamily::arrival))) {
    return "Compare the clocks of coordinator and site before and after a longer test: an offset stays the same, a "
           "drift grows with time, and a latency changes neither of them.";
  }
  if (any_of(EffectFamily::rate) || any_of(EffectFamily::arrival)) {
    return "Repeat the test at half the rate: a delay keeps its time, a lag changes its phase with frequency, a "
           "damping force halves, and a force that depends on displacement does not change.";
  }
  if (any_of(EffectFamily::offset)) {
    return "Record some seconds at rest before and after the test, and tare the load cell at zero force.";
  }
  if (any_of(EffectFamily::degradation)) {
    return "Repeat the same cycle many times at constant amplitude: degradation changes the force from cycle to cycle.";
  }
  if (any_of(EffectFamily::load)) {
    return "Air run: the same motion without the specimen. The error of a compliance disappears with the force; "
           "that of a gain, a backlash or a dead band remains.";
  }
  if (any_of(EffectFamily::position)) {
    return "Slow ramp through both stops from different starting positions: a fixed gap stays in place, a "
           "backlash moves with the last reversal.";
  }
  return "Amplitude sweep: slow cycles of growing and then of shrinking amplitude, with a reversal at every level.";
}

std::string experiment_within_range(const std::vector<const EffectType*>& causes) {
  if (std::ranges::find(causes, find_effect(force_sensor, "saturation")) == causes.end()) return {};
  return "Use a load cell with a wider range, or repeat with less motion: forces beyond the limit are not in these "
         "recordings.";
}

std::string experiment_for_unknown(EffectInterface interface, bool is_seen_to_repeat) {
  if (!is_seen_to_repeat)
    return "Repeat this test without any change: what comes back belongs to the site, what does not is a disturbance.";
  switch (interface) {
    case specimen:
    case force_sensor:
      return "Slow cycles of growing amplitude, then the same at twice and at half the rate, and some seconds at "
             "rest: they show whether the force depends on displacement, velocity or history.";
    default:
      return "A frequency sweep of small amplitude without the specimen, then at twice the amplitude: a linear gap "
             "doubles, a nonlinear gap changes its shape.";
  }
}

}  // namespace hybridtest
