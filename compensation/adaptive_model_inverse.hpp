#pragma once

#include <Eigen/Core>

#include "compensation/compensator.hpp"
#include "compensation/transfer_system_model.hpp"
#include "core/parameters/parameter_archive.hpp"

namespace hybridtest {

/// Adaptive model inverse: our own compensator. Three parts, one model (transfer_system_model.hpp)
/// between them.
///
/// 1. Estimation. An extended Kalman filter carries the five states of the transfer system, four of its
///    parameters and an input disturbance d,
///
///        s = (z, z', F, x, x' | k, beta2, a3, beta1 | d),   p_i' = -(p_i - p_i,nominal) / memory + w_i,
///
///    from the commands that were sent and from both measurements. Displacement sensors are noisy and
///    load cells are not, so that x is in effect measured by F/k, while k itself is learnt from the slow
///    average of the displacement. The parameters are pulled back to their nominal values; their
///    variance therefore never exceeds the prior. What a parameter does to the states is reckoned along
///    the states that belong to the target, which carry no noise, not along the estimated ones: noise
///    that is in estimate and innovation both would pass for a parameter (at rest, for two prior
///    deviations of k). So a motion too small to tell moves nothing, and the freezing rule of other
///    adaptive methods is the Kalman gain itself.
///
/// 2. Inversion. With the estimated parameters the command that holds the target is, exactly,
///
///        F_r = m x'' + c x' + k x,   z_r = F_r' + a3 F_r + a2 x'
///        u_r = (x + (z_r'' + beta1 z_r' + beta2 z_r) / a1beta0) / gain - d
///
///    from the integrator's displacement, velocity and acceleration, and the jerk and snap of the
///    target out of a state-variable filter of second order on the acceleration. All are advanced by half
///    a period, because the command is held over one, and by `advance`.
///
/// 3. Regulation. command = u_r - K (s - s_r), s_r the states that belong to the target, K the
///    linear-quadratic gain of the nominal model. What the inverse leaves (transients, parameters not
///    yet learnt) is reduced by it.
///
/// Literature: inversion and regulator, Phillips and Spencer (2013); joint estimation of states and
/// parameters, Ljung (1979), for inverse compensation Ruiz and Song (2024); the model, Maghareh, Silva
/// and Dyke (2018). Ours: the load cell as the displacement sensor that is learnt, the prior as bound and
/// freezing rule, sensitivities along the target, and the treatment of hold and loop delay.
///
/// On the forces, the integrator sees a force that is one sample late and held over one. PolynomialForce
/// of order 2, delay 1.5 periods, spacing 4 ms makes up for it; where there is no compensator on forces,
/// `advance` does, at the price of a tracking error of (angular frequency) x `advance`.
///
/// The commands are taken to be sent as they are returned: while a limit cuts them, the disturbance d
/// takes the difference. With a non-finite target the estimate goes on with the last finite command.
class AdaptiveModelInverse final : public Compensator {
 public:
  struct Parameters {
    TransferSystemModel model;  // nominal
    double advance_s = 0.0;
    // Standard deviations from nominal; those of k, beta1 and beta2 times parameter_bound below the nominal value.
    double stiffness_deviation_n_per_m = 5e4;
    double beta2_deviation_per_s2 = 3.3e3;
    double a3_deviation_per_s = 1.3;
    double beta1_deviation_per_s = 3.3;
    double parameter_memory_s = 20.0;
    double displacement_noise_m = 1.6e-5;
    double force_noise_n = 2.18;
    double command_noise_m = 1.2e-6;
    double disturbance_walk_m = 1e-6;
    double regulator_weight = 10.0;
    double jerk_filter_hz = 60.0;
    double parameter_bound = 8.0;
    double innovation_bound = 10.0;
    bool adapts = true;

    void serialize(ParameterArchive& archive) {
      constexpr Range kSensor{.low = 0.0, .high = 1.0, .low_open = true};
      constexpr Range kForceSensor{.low = 0.0, .high = 1e9, .low_open = true};
      constexpr const char* kNoise = "every sensor has noise, and the estimator divides by it";
      constexpr const char* kDeviation = "it is a standard deviation";
      constexpr const char* kNotLess = "a deviation is not negative";
      constexpr const char* kBounded = "at least 0, times `parameter_bound` below the nominal value";
      archive.section("plant", model, "the nominal transfer system, below");
      archive.optional(
          "advance_s", advance_s,
          {.range = kNotNegative, .what = "lead of the specimen over its target", .values = "0 to 5 control periods"});
      archive.optional("stiffness_deviation_n_per_m", stiffness_deviation_n_per_m,
                       {kNotNegative, "of `stiffness_n_per_m` from nominal, standard deviation", kNotLess, kBounded});
      archive.optional("beta2_deviation_per_s2", beta2_deviation_per_s2,
                       {kNotNegative, "likewise of `beta2_per_s2`", kNotLess, kBounded});
      archive.optional("a3_deviation_per_s", a3_deviation_per_s,
                       {{.low = 0.0, .high = 1e6}, "likewise of `a3_per_s`", kNotLess});
      archive.optional("beta1_deviation_per_s", beta1_deviation_per_s,
                       {kNotNegative, "likewise of `beta1_per_s`", kNotLess, kBounded});
      archive.optional("parameter_memory_s", parameter_memory_s,
                       {{.low = 0.1, .high = 1e6},
                        "time constant of the return to nominal",
                        "it holds some cycles of the structure"});
      archive.optional("displacement_noise_m", displacement_noise_m,
                       {kSensor, "of the sensor, standard deviation", kNoise});
      archive.optional("force_noise_n", force_noise_n, {kForceSensor, "of the load cell, standard deviation", kNoise});
      archive.optional("command_noise_m", command_noise_m,
                       {kZeroToOne, "of the command, standard deviation per sample", kDeviation});
      archive.optional("disturbance_walk_m", disturbance_walk_m,
                       {kZeroToOne, "of the input disturbance, per square root of a second", kDeviation});
      archive.optional("regulator_weight", regulator_weight,
                       {kForceSensor, "of the displacement error against the command",
                        "without a weight on the error nothing is regulated"});
      archive.optional("jerk_filter_hz", jerk_filter_hz,
                       {.range = kPositive,
                        .what = "corner of the filter that gives jerk and snap",
                        .values = "more than 0, at most a tenth of the control rate"});
      archive.optional("parameter_bound", parameter_bound,
                       {{.low = 0.0, .high = 100.0, .low_open = true},
                        "deviations that a parameter may be off",
                        "it is a multiple of the prior deviation"});
      archive.optional("innovation_bound", innovation_bound,
                       {{.low = 1.0, .high = 1e6},
                        "own deviations that a measurement counts for",
                        "below one deviation honest measurements would be cut"});
      archive.optional("adapts", adapts, {.what = "`false`: the nominal parameters for good"});
    }
  };

  /// @throws ConfigError for values outside their ranges and where no regulator exists.
  AdaptiveModelInverse(const Parameters& parameters, double control_period_s);

  [[nodiscard]] double command(const CompensatorInput& input) noexcept override;
  void reset() noexcept override;

  /// Estimated k [N/m], beta2 [1/s2], a3 [1/s], beta1 [1/s].
  [[nodiscard]] Eigen::Vector4d parameters() const noexcept { return nominal_ + state_.segment<4>(kPlant); }

 private:
  static constexpr int kPlant = TransferSystemModel::kStates;
  static constexpr int kAll = kPlant + 5;
  using PlantState = TransferSystemModel::State;
  using PlantMatrix = TransferSystemModel::Matrix;
  using AllState = Eigen::Matrix<double, kAll, 1>;
  using AllMatrix = Eigen::Matrix<double, kAll, kAll>;
  using Coupling = Eigen::Matrix<double, kPlant, 5>;

  struct Target {
    double displacement_m;
    double velocity_m_per_s;
    double acceleration_m_per_s2;
    double jerk_m_per_s3;
    double snap_m_per_s4;
    [[nodiscard]] Target advanced(double by_s) const noexcept;
  };

  [[nodiscard]] TransferSystemModel estimated_model() const noexcept;
  [[nodiscard]] Target filtered_target(const CompensatorInput& input) noexcept;
  [[nodiscard]] PlantState reference_state(const Target& target) const noexcept;
  [[nodiscard]] double inverse(const Target& target) const noexcept;
  void correct(Eigen::Index index, double measured, double deviation) noexcept;
  void predict(double sent_m) noexcept;
  void spread(const PlantMatrix& transition, const Coupling& coupling) noexcept;

  Parameters settings_;
  double control_period_s_;
  Eigen::Vector4d nominal_;
  Eigen::Vector4d deviations_;
  double keep_;  // of a parameter's deviation from nominal, over a period
  PlantState input_vector_;
  Eigen::Matrix<double, 1, kPlant> gain_;
  AllState state_ = AllState::Zero();
  AllMatrix covariance_ = AllMatrix::Zero();
  PlantState course_ = PlantState::Zero();  // that belongs to the target, in the middle of the coming period
  Eigen::Vector2d jerk_filter_ = Eigen::Vector2d::Zero();  // filtered acceleration and its rate
  double sent_m_ = 0.0;
  bool has_target_ = false;
};

}  // namespace hybridtest
