#pragma once

#include <array>

#include "plant/effects/effect_type.hpp"

/// Errors of the part that is computed. They change the coordinator's structure and integrator and the numerical
/// substructures (launch/numerical_effects); there is no Effect to make of them.
namespace hybridtest {

struct MassError {
  static constexpr std::string_view kEquation = "M = (1 + e) M0, load of the ground motion included";
  static constexpr std::string_view kSource = "a wrong number of the user's model";
  static constexpr EffectTraits kTraits{.family = EffectFamily::scale, .number = ModelNumber::mass};
  static constexpr std::array kParameters{EffectParameter{.name = "mass_error_ratio",
                                                          .unit = "",
                                                          .what = "e, real over model mass less 1",
                                                          .low = -0.9,
                                                          .high = 10.0,
                                                          .is_linear = true}};
};

struct NumericalStiffnessError {
  static constexpr std::string_view kEquation =
      "r(u) = (1 + e) r0(u) of every numerical substructure and of the elastic part";
  static constexpr std::string_view kSource = "a wrong number of the user's model";
  static constexpr EffectTraits kTraits{.family = EffectFamily::scale, .number = ModelNumber::stiffness};
  static constexpr std::array kParameters{EffectParameter{.name = "stiffness_error_ratio",
                                                          .unit = "",
                                                          .what = "e, real over model stiffness less 1",
                                                          .low = -0.9,
                                                          .high = 10.0,
                                                          .is_linear = true}};
};

struct DampingError {
  static constexpr std::string_view kEquation = "C = (1 + e) C0";
  static constexpr std::string_view kSource = "a wrong number of the user's model";
  static constexpr EffectTraits kTraits{.family = EffectFamily::scale, .number = ModelNumber::damping};
  static constexpr std::array kParameters{EffectParameter{.name = "damping_error_ratio",
                                                          .unit = "",
                                                          .what = "e, real over model damping less 1",
                                                          .low = -1.0,
                                                          .high = 100.0,
                                                          .is_linear = true}};
};

struct StepMismatch {
  static constexpr std::string_view kEquation = "the integrator advances by (1 + e) h where the test advances by h";
  static constexpr std::string_view kSource = "a wrong number of the user's model";
  static constexpr EffectTraits kTraits{.family = EffectFamily::scale, .number = ModelNumber::step};
  static constexpr std::array kParameters{
      EffectParameter{.name = "step_error_ratio",
                      .unit = "",
                      .what = "e, step of the integrator over that of the test less 1",
                      .low = -0.9,
                      .high = 10.0}};
};

}  // namespace hybridtest
