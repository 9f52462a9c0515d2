#include "diagnosis/verdict/next_experiment.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace hybridtest {
namespace {

using enum EffectInterface;

/// What an effect follows, and with it which experiment moves it apart from others.
enum class Family { rate, amplitude, position, sensor_scale, sensor_offset, degradation, mass };

Family family_of(const EffectType& effect) {
  struct Member {
    std::string_view part;
    Family family;
  };
  constexpr std::array kMembers{Member{"degradation", Family::degradation},
                                Member{"fracture", Family::degradation},
                                Member{"drift", Family::degradation},
                                Member{"relaxation", Family::rate},
                                Member{"inertia", Family::mass},
                                Member{"damping", Family::rate},
                                Member{"delay", Family::rate},
                                Member{"lag", Family::rate},
                                Member{"latency", Family::rate},
                                Member{"bandwidth", Family::rate},
                                Member{"time_skew", Family::rate},
                                Member{"velocity", Family::rate},
                                Member{"setting", Family::rate},
                                Member{"bias", Family::sensor_offset},
                                Member{"gain", Family::sensor_scale},
                                Member{"stiffness_error", Family::sensor_scale},
                                Member{"gap", Family::position},
                                Member{"contact", Family::position},
                                Member{"deadband", Family::position},
                                Member{"saturation", Family::position},
                                Member{"limit", Family::position}};
  const auto found = std::ranges::find_if(
      kMembers, [&](const Member& member) { return effect.name.find(member.part) != std::string_view::npos; });
  return found == kMembers.end() ? Family::amplitude : found->family;
}

}  // namespace

std::string experiment_that_splits(const std::vector<const EffectType*>& effects) {
  if (effects.size() < 2) return {};
  const auto any_at = [&](EffectInterface interface) {
    return std::ranges::any_of(effects, [&](const EffectType* effect) { return effect->interface == interface; });
  };
  const auto any_of = [&](Family family) {
    return std::ranges::any_of(effects, [&](const EffectType* effect) { return family_of(*effect) == family; });
  };
  if (any_of(Family::mass)) {
    return "Air run: the same motion without the specimen; what stays is mass and load cell, what goes is the "
           "specimen.";
  }
  if (any_at(force_sensor) && any_at(specimen)) {
    return any_of(Family::rate)
               ? "Repeat the test at half the rate: what comes from a sensor's lag shrinks with the "
                 "rate, what the specimen does of itself stays."
               : "Put a dead weight of known size on the load cell: it reads wrong by itself or not at all.";
  }
  if (any_at(displacement_sensor)) {
    return "Put a second displacement transducer beside the first, or step the actuator through gauge blocks.";
  }
  if (any_of(Family::rate)) {
    return "Repeat the test at half the rate: a delay stays the same time, a lag changes its phase with frequency, "
           "a force of velocity halves, and one of displacement does not change.";
  }
  if (any_of(Family::sensor_offset))
    return "Record a stretch of rest before and after the test, and tare at zero force.";
  if (any_of(Family::degradation)) {
    return "Repeat the same cycle many times at constant amplitude: what wears changes from cycle to cycle.";
  }
  if (any_of(Family::position)) {
    return "Slow ramp through both stops from different starting positions: a fixed gap stays in place, play moves "
           "with the last reversal.";
  }
  return "Amplitude sweep: slow cycles of growing and then of shrinking amplitude, with a reversal at every level.";
}

std::string experiment_for_unknown(EffectInterface interface) {
  switch (interface) {
    case specimen:
    case force_sensor:
      return "Slow cycles of growing amplitude, then the same at twice and at half the rate, and a stretch of rest: "
             "they show whether the force follows position, rate or history.";
    default:
      return "A sweep of small amplitude without specimen, then at twice the amplitude: what is linear scales, "
             "what is not changes its shape.";
  }
}

}  // namespace hybridtest
