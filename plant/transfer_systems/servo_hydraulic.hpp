#pragma once

#include "core/parameters/parameter_archive.hpp"
#include "core/time.hpp"
#include "plant/transfer_systems/transfer_system.hpp"

namespace hybridtest {

/// Servo-hydraulic actuator under displacement control, with its limits (Merritt, Hydraulic Control Systems, 1967,
/// chapters 5 and 6; Zhao, French, Shield and Posbergh, Earthquake Eng. Struct. Dyn. 32, 2003). With the
/// spool opening y, the force of the oil F = A pL, and the load FL of the specimen:
///
///     y'' + 2 zeta w y' + w^2 y = w^2 clamp(Kp e + Ki int(e) + Kd e', -1, 1),  e = g u - x     valve and controller
///     F' = 4 B A / V (Q - A x' - C F / A),   Q = Qr y sqrt(1 - sign(y) F / (A ps))          oil column
///     m x'' + c x' + FL = F,   |x| <= stroke                                              piston
///
/// so that the velocity of the piston drives its own pressure (natural velocity feedback: Dyke, Spencer, Quast and
/// Sain, J. Eng. Mech. 121, 1995), a loaded piston is slower, none is faster than flow over area, and at supply
/// pressure times area it stalls. The integral stops while the valve is fully open and would open more.
/// In the small it is TransferSystemModel of compensation/.
///
/// The command runs straight from sample to sample. The load is that of the sample before and grows from there
/// with the load stiffness times the travel, exact for an elastic specimen of that stiffness; otherwise late by a
/// sample. Classical Runge-Kutta in equal substeps of at most a tenth of a radian of the fastest mode.
class ServoHydraulic final : public TransferSystem {
 public:
  struct Parameters {
    double piston_area_m2 = 0.0;       // A
    double supply_pressure_pa = 0.0;   // ps
    double rated_flow_m3_per_s = 0.0;  // Qr
    double stroke_m = 0.0;
    double oil_volume_m3 = 0.0;            // V
    double bulk_modulus_pa = 1.0e9;        // B
    double leakage_m3_per_s_pa = 0.0;      // C
    double moving_mass_kg = 0.0;           // m
    double damping_n_s_per_m = 0.0;        // c
    double valve_frequency_hz = 0.0;       // w / (2 pi)
    double valve_damping_ratio = 0.7;      // zeta
    double proportional_gain_per_m = 0.0;  // Kp
    double integral_gain_per_m_s = 0.0;    // Ki
    double derivative_gain_s_per_m = 0.0;  // Kd
    double command_gain = 1.0;             // g
    double load_stiffness_n_per_m = 0.0;

    void serialize(ParameterArchive& archive) {
      archive.required("piston_area_m2", piston_area_m2, {kPositive});
      archive.required("supply_pressure_pa", supply_pressure_pa, {kPositive});
      archive.required("rated_flow_m3_per_s", rated_flow_m3_per_s,
                       {kPositive, "of the fully open valve, without load"});
      archive.required("stroke_m", stroke_m, {kPositive, "to either side"});
      archive.required("oil_volume_m3", oil_volume_m3, {kPositive, "in both chambers"});
      archive.required("moving_mass_kg", moving_mass_kg, {kPositive, "of piston and fixture"});
      archive.required("valve_frequency_hz", valve_frequency_hz, {kPositive, "of the spool"});
      archive.required("proportional_gain_per_m", proportional_gain_per_m,
                       {kPositive, "opening per error; 1 is fully open"});
      archive.required("load_stiffness_n_per_m", load_stiffness_n_per_m,
                       {kNotNegative, "of the specimen, how its force grows between two samples"});
      archive.optional("bulk_modulus_pa", bulk_modulus_pa, {kPositive, "of the oil"});
      archive.optional("leakage_m3_per_s_pa", leakage_m3_per_s_pa, {kNotNegative, "past the piston"});
      archive.optional("damping_n_s_per_m", damping_n_s_per_m, {kNotNegative, "of the seals"});
      archive.optional("valve_damping_ratio", valve_damping_ratio, {kPositive, "of the spool"});
      archive.optional("integral_gain_per_m_s", integral_gain_per_m_s,
                       {kNotNegative, "held while the valve is fully open"});
      archive.optional("derivative_gain_s_per_m", derivative_gain_s_per_m, {kNotNegative});
      archive.optional("command_gain", command_gain, {kPositive, "of the commands"});
    }
  };

  /// @throws ConfigError for values outside their ranges, and when a control period would need more than 1000
  ///         substeps.
  ServoHydraulic(const Parameters& parameters, Duration control_period);

  /// Without a load but the load stiffness.
  [[nodiscard]] double step(double command_m) noexcept override { return step_loaded(command_m, 0.0); }
  [[nodiscard]] double step_loaded(double command_m, double load_force_n) noexcept override;
  void reset() noexcept override;

  /// Of the oil, at the last step [N].
  [[nodiscard]] double oil_force_n() const noexcept { return state_.oil_force_n; }

 private:
  struct State {
    double opening = 0.0;  // y
    double opening_rate_per_s = 0.0;
    double oil_force_n = 0.0;
    double displacement_m = 0.0;
    double velocity_m_per_s = 0.0;
    double error_integral_m_s = 0.0;

    [[nodiscard]] State plus(double factor, const State& rate) const noexcept;
  };

  /// What drives the actuator at one instant.
  struct Drive {
    double command_m = 0.0;
    double command_rate_m_per_s = 0.0;
    double load_force_n = 0.0;  // at `load_from_m`
    double load_from_m = 0.0;
  };

  [[nodiscard]] State rate(const State& state, const Drive& drive) const noexcept;
  [[nodiscard]] double flow_m3_per_s(const State& state) const noexcept;
  void advance(Drive drive) noexcept;
  void stop_at_stroke() noexcept;

  Parameters parameters_;
  double valve_rad_per_s_;
  double oil_stiffness_per_m3_;  // 4 B A / V [N/m3]
  double period_s_;
  int substeps_;
  double substep_s_;
  State state_;
  double previous_command_m_ = 0.0;
};

}  // namespace hybridtest
