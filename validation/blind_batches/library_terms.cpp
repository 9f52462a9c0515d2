#include "validation/blind_batches/library_terms.hpp"

#include <string>

namespace hybridtest::blind {
namespace {

/// Those that differ in their name alone: of the plant -> of the library. A number that shapes another curve there
/// than here is left out: neither of the two would be the true one.
const std::map<std::string, std::map<std::string, std::string>>& renamed() {
  static const std::map<std::string, std::map<std::string, std::string>> names{
      {"network.latency", {{"delay_s", "latency_s"}}},
      {"network.loss", {{"loss_ratio", "loss_ratio"}}},
      {"network.clock_offset", {{"offset_s", "offset_s"}}},
      {"compensator.bias", {{"bias_m", "bias_m"}}},
      {"transfer_system.delay", {{"delay_s", "delay_s"}}},
      {"transfer_system.backlash", {{"width_m", "clearance_m"}}},
      {"transfer_system.stiction", {{"breakaway_m", "stick_displacement_m"}}},
      {"displacement_sensor.bias", {{"bias_m", "bias_m"}}},
      {"displacement_sensor.quantization", {{"step_m", "step_m"}}},
      {"specimen.viscous_damping", {{"damping_n_s_per_m", "damping_n_s_per_m"}}},
      {"specimen.backlash", {{"width_m", "clearance_m"}}},
      {"specimen.inertia", {{"mass_kg", "mass_kg"}}},
      {"specimen.fracture", {{"lost_ratio", "lost_ratio"}, {"time_s", "instant_s"}}},
      {"force_sensor.bias", {{"bias_n", "bias_n"}}},
      {"force_sensor.quantization", {{"step_n", "step_n"}}},
      {"force_sensor.time_skew", {{"skew_s", "skew_s"}}},
  };
  return names;
}

Parameters of_bandwidth(const PlantEffect& effect) {
  if (effect.parameters.contains("bandwidth_hz")) {
    // A second pole, eight times as fast.
    return {{"time_constant_s", 1.125 / (kTwoPi * effect.of("bandwidth_hz"))}, {"second_order_ratio", 8.0 / 81.0}};
  }
  const double damping = effect.of("damping_ratio");
  return {{"time_constant_s", 2.0 * damping / (kTwoPi * effect.of("natural_frequency_hz"))},
          {"second_order_ratio", 1.0 / (4.0 * damping * damping)}};
}

/// Of a number of the user's own model.
Parameters of_bandwidth_error(const TransferModel& users, const PlantEffect& effect) {
  const double ratio = effect.parameters.contains("true_bandwidth_hz")
                           ? effect.of("true_bandwidth_hz") / users.bandwidth_hz
                           : effect.of("true_natural_frequency_hz") / users.natural_frequency_hz;
  return {{"bandwidth_error_ratio", ratio - 1.0}};
}

Parameters of_friction(const PlantEffect& effect) {
  const double forward_n = effect.of("friction_force_n");
  Parameters terms{{"friction_force_n", forward_n}};
  if (effect.name == "stribeck_friction") {
    return terms;  // its curve near rest is that of bristles
  }
  if (effect.parameters.contains("friction_force_backward_n")) {
    const double backward_n = effect.of("friction_force_backward_n");
    terms["friction_force_n"] = 0.5 * (forward_n + backward_n);
    terms["asymmetry"] = (forward_n - backward_n) / (forward_n + backward_n);
  }
  return terms;
}

/// A diagnosis tells the whole specimen, in place of the user's spring, as the plant does.
Parameters of_yielding(const Site& site, const PlantEffect& effect) {
  return {{"yield_force_n", effect.of("yield_force_n")}, {"stiffness_n_per_m", site.specimen.stiffness_n_per_m}};
}

}  // namespace

Parameters in_library_terms(const Site& site, const PlantEffect& effect) {
  const std::string& name = effect.name;
  if (name == "gain") return {{"gain_error", effect.of("gain") - 1.0}};
  if (name == "bandwidth") return of_bandwidth(effect);
  if (name == "lag") return {{"time_constant_s", effect.of("time_constant_s")}, {"second_order_ratio", 0.25}};
  if (name == "bandwidth_error") return of_bandwidth_error(site.transfer_system, effect);
  if (name == "coulomb_friction" || name == "stribeck_friction") return of_friction(effect);
  if (name == "yielding") return of_yielding(site, effect);
  if (name == "setting_mismatch") return {{"delay_error_s", effect.of("delay_s") - site.compensator.delay_s}};
  if (name == "stiffness_error") {
    const double ratio = effect.of("stiffness_ratio") - 1.0;
    if (site.specimen.kind != LawKind::elastic) return {{"stiffness_error_ratio", ratio}};
    return {{"stiffness_n_per_m", ratio * site.specimen.stiffness_n_per_m}};
  }
  if (name == "strength_degradation") return {{"path_m", 1.0 / effect.of("degradation_per_m")}};
  Parameters terms;
  const auto names = renamed().find(effect.interface + "." + name);
  if (names == renamed().end()) return terms;
  for (const auto& [plants, librarys] : names->second) terms[librarys] = effect.of(plants.c_str());
  return terms;
}

}  // namespace hybridtest::blind
