#include <algorithm>
#include <array>
#include <iterator>

#include "experimental_site/effects/effect_type.hpp"
#include "experimental_site/effects/sensor/bias.hpp"
#include "experimental_site/effects/sensor/gain.hpp"
#include "experimental_site/effects/specimen/coulomb_friction.hpp"
#include "experimental_site/effects/specimen/inertia.hpp"
#include "experimental_site/effects/specimen/stiffness_error.hpp"
#include "experimental_site/effects/specimen/viscous_damping.hpp"
#include "experimental_site/effects/transfer_system/bandwidth.hpp"
#include "experimental_site/effects/transfer_system/delay.hpp"
#include "experimental_site/effects/transfer_system/gain.hpp"

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
          .parameters = Part::kParameters,
          .make = make<Part>};
}

/// Of a displacement sensor that can be read backwards.
template <class Part, class Inverse>
EffectType entry(EffectInterface interface, std::string_view name) {
  EffectType type = entry<Part>(interface, name);
  type.make_inverse = make<Inverse>;
  return type;
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
      entry<TransferDelay>(At::transfer_system, "delay"),
      entry<Bandwidth>(At::transfer_system, "bandwidth"),
      entry<TransferGain>(At::transfer_system, "gain"),
      entry<SensorGain, InverseSensorGain>(At::displacement_sensor, "gain"),
      entry<DisplacementBias, InverseDisplacementBias>(At::displacement_sensor, "bias"),
      entry<StiffnessError>(At::specimen, "stiffness_error"),
      entry<ViscousDamping>(At::specimen, "viscous_damping"),
      entry<CoulombFriction>(At::specimen, "coulomb_friction"),
      entry<Inertia>(At::specimen, "inertia"),
      entry<SensorGain>(At::force_sensor, "gain"),
      entry<ForceBias>(At::force_sensor, "bias"),
  };
  return table;
}

const EffectType* find_effect(EffectInterface interface, std::string_view name) noexcept {
  const auto library = effect_library();
  const auto found = std::ranges::find_if(
      library, [&](const EffectType& type) { return type.interface == interface && type.name == name; });
  return found == library.end() ? nullptr : &*found;
}

}  // namespace hybridtest
