#include "diagnosis/verdict/next_experiment.hpp"

#include <algorithm>

namespace hybridtest {
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
  if (any_of(EffectFamily::mass)) {
    return "Air run: the same motion without the specimen. Forces of mass and load cell stay; those of the specimen "
           "vanish.";
  }
  if (any_at(force_sensor) && any_at(specimen)) {
    return any_of(EffectFamily::rate) ? "Repeat the test at half the rate: a sensor's lag shrinks with the rate; what "
                                        "the specimen does does not."
                                      : "Put a dead weight of known size on the load cell and compare its reading.";
  }
  if (any_at(displacement_sensor)) {
    return "Put a second displacement transducer beside the first, or step the actuator through gauge blocks.";
  }
  if (std::ranges::all_of(effects, is_of(EffectFamily::arrival))) {
    return "Compare the clocks of coordinator and site before and after a longer test: an offset stays the same, a "
           "drift grows with time, and a latency changes neither.";
  }
  if (any_of(EffectFamily::rate) || any_of(EffectFamily::arrival)) {
    return "Repeat the test at half the rate: a delay stays the same time, a lag changes its phase with frequency, "
           "a damping force halves, and a force of displacement does not change.";
  }
  if (any_of(EffectFamily::offset)) {
    return "Record a stretch of rest before and after the test, and tare at zero force.";
  }
  if (any_of(EffectFamily::degradation)) {
    return "Repeat the same cycle many times at constant amplitude: degradation changes the force from cycle to cycle.";
  }
  if (any_of(EffectFamily::load)) {
    return "Air run: the same motion without the specimen. The error of a compliance vanishes with the force; that of "
           "a gain, a play or a dead band stays.";
  }
  if (any_of(EffectFamily::position)) {
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
