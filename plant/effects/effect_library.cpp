#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <mutex>
#include <string>
#include <utility>

#include "core/assert.hpp"
#include "plant/effects/compensator/bias.hpp"
#include "plant/effects/compensator/setting_mismatch.hpp"
#include "plant/effects/effect_type.hpp"
#include "plant/effects/network/clock_drift.hpp"
#include "plant/effects/network/clock_offset.hpp"
#include "plant/effects/network/jitter.hpp"
#include "plant/effects/network/latency.hpp"
#include "plant/effects/network/loss.hpp"
#include "plant/effects/numerical_substructure/model_errors.hpp"
#include "plant/effects/sensor/bias.hpp"
#include "plant/effects/sensor/drift.hpp"
#include "plant/effects/sensor/gain.hpp"
#include "plant/effects/sensor/lag.hpp"
#include "plant/effects/sensor/quantization.hpp"
#include "plant/effects/sensor/saturation.hpp"
#include "plant/effects/sensor/time_skew.hpp"
#include "plant/effects/specimen/backlash.hpp"
#include "plant/effects/specimen/bouc_wen_hysteresis.hpp"
#include "plant/effects/specimen/contact.hpp"
#include "plant/effects/specimen/coulomb_friction.hpp"
#include "plant/effects/specimen/cubic_stiffness.hpp"
#include "plant/effects/specimen/damping_with_input.hpp"
#include "plant/effects/specimen/force_with_input.hpp"
#include "plant/effects/specimen/fractional_damping.hpp"
#include "plant/effects/specimen/fracture.hpp"
#include "plant/effects/specimen/friction_with_input.hpp"
#include "plant/effects/specimen/gap.hpp"
#include "plant/effects/specimen/geometric_stiffness.hpp"
#include "plant/effects/specimen/hardening_error.hpp"
#include "plant/effects/specimen/inertia.hpp"
#include "plant/effects/specimen/nonlinear_viscous_damping.hpp"
#include "plant/effects/specimen/pinching.hpp"
#include "plant/effects/specimen/quadratic_damping.hpp"
#include "plant/effects/specimen/relaxation.hpp"
#include "plant/effects/specimen/stiffness_degradation.hpp"
#include "plant/effects/specimen/stiffness_error.hpp"
#include "plant/effects/specimen/strength_asymmetry.hpp"
#include "plant/effects/specimen/strength_degradation.hpp"
#include "plant/effects/specimen/strength_error.hpp"
#include "plant/effects/specimen/stribeck_friction.hpp"
#include "plant/effects/specimen/velocity_strengthening_friction.hpp"
#include "plant/effects/specimen/viscous_damping.hpp"
#include "plant/effects/specimen/yielding.hpp"
#include "plant/effects/transfer_system/backlash.hpp"
#include "plant/effects/transfer_system/bandwidth.hpp"
#include "plant/effects/transfer_system/bandwidth_error.hpp"
#include "plant/effects/transfer_system/compliance.hpp"
#include "plant/effects/transfer_system/deadband.hpp"
#include "plant/effects/transfer_system/delay.hpp"
#include "plant/effects/transfer_system/gain.hpp"
#include "plant/effects/transfer_system/stiction.hpp"
#include "plant/effects/transfer_system/stroke_limit.hpp"
#include "plant/effects/transfer_system/velocity_limit.hpp"

namespace hybridtest {
namespace {

using At = EffectInterface;

template <class Part>
std::unique_ptr<Effect> make(std::span<const double> values, double sample_period_s) {
  return std::make_unique<Part>(values, sample_period_s);
}

template <class Part>
EffectType entry(EffectInterface interface, std::string_view name) {
  return {.interface = interface,
          .name = name,
          .equation = Part::kEquation,
          .source = Part::kSource,
          .traits = Part::kTraits,
          .parameters = Part::kParameters,
          .make = make<Part>};
}

/// Of what the coordinator or the numerical substructures compute.
template <class Part>
EffectType described(std::string_view name) {
  return {.interface = At::numerical_substructure,
          .name = name,
          .equation = Part::kEquation,
          .source = Part::kSource,
          .traits = Part::kTraits,
          .parameters = Part::kParameters};
}

/// Of a displacement sensor that can be read backwards.
template <class Part, class Inverse>
EffectType entry(EffectInterface interface, std::string_view name) {
  EffectType type = entry<Part>(interface, name);
  type.make_inverse = make<Inverse>;
  return type;
}

template <class Property>
const EffectType* first_at(EffectInterface interface, Property&& has_it) noexcept {
  const auto library = effect_library();
  const auto found = std::ranges::find_if(
      library, [&](const EffectType& type) { return type.interface == interface && has_it(type); });
  return found == library.end() ? nullptr : &*found;
}

}  // namespace

std::string_view name_of(EffectInterface interface) noexcept {
  constexpr std::array<std::string_view, 7> kNames{
      "network",  "compensator",  "transfer_system",       "displacement_sensor",
      "specimen", "force_sensor", "numerical_substructure"};
  return kNames[static_cast<std::size_t>(interface)];
}

std::span<const EffectType> effect_library() noexcept {
  static const std::array table{
      entry<NetworkLatency>(At::network, "latency"),
      entry<NetworkJitter>(At::network, "jitter"),
      entry<NetworkLoss>(At::network, "loss"),
      entry<ClockOffset>(At::network, "clock_offset"),
      entry<ClockDrift>(At::network, "clock_drift"),
      entry<SettingMismatch>(At::compensator, "setting_mismatch"),
      entry<CompensatorBias>(At::compensator, "bias"),
      entry<TransferDelay>(At::transfer_system, "delay"),
      entry<Bandwidth>(At::transfer_system, "bandwidth"),
      entry<BandwidthError>(At::transfer_system, "bandwidth_error"),
      entry<TransferGain>(At::transfer_system, "gain"),
      entry<TransferBacklash>(At::transfer_system, "backlash"),
      entry<Deadband>(At::transfer_system, "deadband"),
      entry<VelocityLimit>(At::transfer_system, "velocity_limit"),
      entry<StrokeLimit>(At::transfer_system, "stroke_limit"),
      entry<Compliance>(At::transfer_system, "compliance"),
      entry<Stiction>(At::transfer_system, "stiction"),
      entry<SensorGain, InverseSensorGain>(At::displacement_sensor, "gain"),
      entry<DisplacementBias, InverseDisplacementBias>(At::displacement_sensor, "bias"),
      entry<DisplacementDrift, InverseDisplacementDrift>(At::displacement_sensor, "drift"),
      entry<SensorLag, InverseSensorLag>(At::displacement_sensor, "lag"),
      entry<DisplacementQuantization>(At::displacement_sensor, "quantization"),
      entry<StiffnessError>(At::specimen, "stiffness_error"),
      entry<StrengthError>(At::specimen, "strength_error"),
      entry<HardeningError>(At::specimen, "hardening_error"),
      entry<StrengthAsymmetry>(At::specimen, "strength_asymmetry"),
      entry<ViscousDamping>(At::specimen, "viscous_damping"),
      entry<QuadraticDamping>(At::specimen, "quadratic_damping"),
      entry<NonlinearViscousDamping>(At::specimen, "nonlinear_viscous_damping"),
      entry<CoulombFriction>(At::specimen, "coulomb_friction"),
      entry<StribeckFriction>(At::specimen, "stribeck_friction"),
      entry<VelocityStrengtheningFriction>(At::specimen, "velocity_strengthening_friction"),
      entry<CubicStiffness>(At::specimen, "cubic_stiffness"),
      entry<Yielding>(At::specimen, "yielding"),
      entry<BoucWenHysteresis>(At::specimen, "bouc_wen_hysteresis"),
      entry<Pinching>(At::specimen, "pinching"),
      entry<StiffnessDegradation<TravelledPath>>(At::specimen, "stiffness_degradation"),
      entry<StiffnessDegradation<LargestDisplacement>>(At::specimen, "stiffness_degradation_with_peak"),
      entry<StiffnessDegradation<DissipatedEnergy>>(At::specimen, "stiffness_degradation_with_energy"),
      entry<StiffnessDegradation<CountedCycles>>(At::specimen, "stiffness_degradation_with_cycles"),
      entry<StiffnessDegradation<ElapsedTime>>(At::specimen, "stiffness_degradation_with_time"),
      entry<StrengthDegradation<TravelledPath>>(At::specimen, "strength_degradation"),
      entry<StrengthDegradation<LargestDisplacement>>(At::specimen, "strength_degradation_with_peak"),
      entry<StrengthDegradation<DissipatedEnergy>>(At::specimen, "strength_degradation_with_energy"),
      entry<StrengthDegradation<CountedCycles>>(At::specimen, "strength_degradation_with_cycles"),
      entry<StrengthDegradation<ElapsedTime>>(At::specimen, "strength_degradation_with_time"),
      entry<Gap>(At::specimen, "gap"),
      entry<SpecimenBacklash>(At::specimen, "backlash"),
      entry<Contact>(At::specimen, "contact"),
      entry<Relaxation>(At::specimen, "relaxation"),
      entry<FractionalDamping>(At::specimen, "fractional_damping"),
      entry<Inertia>(At::specimen, "inertia"),
      entry<GeometricStiffness>(At::specimen, "geometric_stiffness"),
      entry<Fracture>(At::specimen, "fracture"),
      entry<ForceWithInput>(At::specimen, "force_with_input"),
      entry<FrictionWithInput>(At::specimen, "friction_with_input"),
      entry<DampingWithInput>(At::specimen, "damping_with_input"),
      entry<SensorGain>(At::force_sensor, "gain"),
      entry<ForceBias>(At::force_sensor, "bias"),
      entry<ForceDrift>(At::force_sensor, "drift"),
      entry<SensorLag>(At::force_sensor, "lag"),
      entry<ForceSaturation>(At::force_sensor, "saturation"),
      entry<ForceQuantization>(At::force_sensor, "quantization"),
      entry<TimeSkew>(At::force_sensor, "time_skew"),
      described<MassError>("mass_error"),
      described<NumericalStiffnessError>("stiffness_error"),
      described<DampingError>("damping_error"),
      described<StepMismatch>("step_mismatch"),
  };
  return table;
}

const EffectType* find_effect(EffectInterface interface, std::string_view name) noexcept {
  return first_at(interface, [name](const EffectType& type) { return type.name == name; });
}

const EffectType* find_effect(EffectInterface interface, ModelNumber number) noexcept {
  if (number == ModelNumber::none) return nullptr;
  return first_at(interface, [number](const EffectType& type) { return type.traits.number == number; });
}

const EffectType* find_effect(EffectInterface interface, DigitTrace digits) noexcept {
  if (digits == DigitTrace::none) return nullptr;
  return first_at(interface, [digits](const EffectType& type) { return type.traits.digits == digits; });
}

const EffectType& with_input(const EffectType& type, std::string_view input) {
  HYBRIDTEST_ASSERT(type.traits.takes_input);
  static std::mutex mutex;
  static std::map<std::pair<std::string_view, std::string>, EffectType>
      types;  // no two effects with an input share a name
  const std::scoped_lock lock{mutex};
  const auto [place, is_new] = types.try_emplace({type.name, std::string{input}}, type);
  if (is_new) place->second.input = place->first.second;
  return place->second;
}

bool is_input_name(std::string_view name) noexcept {
  const auto is_letter = [](char c) { return c >= 'a' && c <= 'z'; };
  return !name.empty() && is_letter(name.front()) &&
         std::ranges::all_of(name, [&](char c) { return is_letter(c) || c == '_' || (c >= '0' && c <= '9'); });
}

}  // namespace hybridtest
