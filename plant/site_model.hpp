#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "compensation/compensator.hpp"
#include "compensation/delay_setting.hpp"
#include "mechanics/laws/law.hpp"
#include "plant/effects/effect_type.hpp"
#include "plant/effects/stage.hpp"
#include "plant/transfer_systems/transfer_system.hpp"

namespace hybridtest {

/// One effect of the library with its parameters.
struct EffectSetting {
  const EffectType* type = nullptr;
  std::vector<double> values;  // one per parameter, in their order
};

/// Whether it puts another law in the place of the specimen's own.
[[nodiscard]] inline bool replaces_law(const EffectSetting& effect) noexcept {
  return effect.type->replacement != nullptr;
}

struct SensorNoise {
  double displacement_noise_m = 0.0;  // [m] standard deviation, not negative
  double force_noise_n = 0.0;         // [N] standard deviation, not negative
  std::uint64_t seed = 0;
  std::uint64_t first_stream = 0;  // two streams per actuator from here on: displacement, force

  // Coloured noise beside the white one: over a time t its correlation is exp(-t / correlation time).
  double displacement_coloured_noise_m = 0.0;    // [m] standard deviation, not negative
  double displacement_correlation_time_s = 0.0;  // [s] positive where there is such noise
  double force_coloured_noise_n = 0.0;           // [N] standard deviation, not negative
  double force_correlation_time_s = 0.0;         // [s] positive where there is such noise

  /// Its streams are so many beyond those of the white noise: more than all sites together have.
  static constexpr std::uint64_t kToColouredStreams = std::uint64_t{1} << 32U;
};

/// What is known of one degree of freedom of a site: the value that a scenario's simulated rig and the
/// diagnosis of a recording share.
struct SiteModel {
  /// @param delay_change_s   added to the model's own delay, from -removable_delay_s to 0.
  std::function<std::unique_ptr<TransferSystem>(double sample_period_s, double delay_change_s)> make_transfer_system;
  double removable_delay_s = 0.0;                  // the transfer system's own pure delay
  bool has_bandwidth = false;                      // the transfer system has a bandwidth or natural frequency
  std::function<std::unique_ptr<Law>()> make_law;  // empty: the specimen has no force
  double reversal_noise_m = 0.0;                   // see Law::ignore_reversals_within()
  /// @param delay_change_s   added to its setting, which stays between 0 and the most it may be. Empty: none.
  std::function<std::unique_ptr<Compensator>(double sample_period_s, double delay_change_s)> make_compensator;
  DelaySetting compensator_delay = {};
  SensorNoise noise;
  std::vector<EffectSetting> effects;
  std::vector<const EffectType*> suspected;  // formulas that a diagnosis tries beside the library
  // Names of StageSample::inputs, in their order. Empty: nothing is recorded beside the motion, as in a simulated rig.
  std::vector<std::string> inputs;
};

/// The effect of `model` in whose place an added one of this type comes; null: an added one stands behind those there.
[[nodiscard]] const EffectSetting* place_of(const SiteModel& model, const EffectType& type) noexcept;

/// Adds an effect to the model. A force that cannot be negative would never shrink by another one beside it: of such a
/// type the numbers are those of the whole specimen, and it takes the place of the last one that the model has.
void add_effect(SiteModel& model, const EffectSetting& effect);

/// The effects of `model` at one interface, in their order.
/// @throws ConfigError as the effects.
[[nodiscard]] StageEffects effects_at(const SiteModel& model, EffectInterface interface, double sample_period_s);

/// The law of the specimen: the last replacement among the effects, else the model's own. null: no force.
/// @throws ConfigError as the law.
[[nodiscard]] std::unique_ptr<Law> law_of(const SiteModel& model);

/// The transfer system with the delay and the bandwidth that the effects give it.
/// @throws ConfigError as delay_change_s(), and for a `bandwidth_error` where there is no bandwidth.
[[nodiscard]] std::unique_ptr<TransferSystem> transfer_system_of(const SiteModel& model, double sample_period_s);

/// Sum of what the `delay` effects of the transfer system take off its own delay; zero or negative.
/// @throws ConfigError when that is more than there is.
[[nodiscard]] double delay_change_s(const SiteModel& model);

/// Sum of what the `setting_mismatch` effects change a compensator's setting by; 0 where it has none, and the effects
/// work on its command.
/// @throws ConfigError when that is more than the setting allows.
[[nodiscard]] double setting_change_s(const SiteModel& model);

}  // namespace hybridtest
