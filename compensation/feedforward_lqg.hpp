#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "compensation/compensator.hpp"
#include "compensation/sample_history.hpp"
#include "compensation/transfer_system_model.hpp"
#include "core/parameters/parameter_archive.hpp"

namespace hybridtest {

/// Feedforward by the inverse of an identified transfer function, with a linear-quadratic-Gaussian
/// regulator behind it (Carrion and Spencer, NSEL report 006, 2007; Phillips and Spencer, J. Struct.
/// Eng. 139, 2013).
///
///     command = a0 x + a1 x' + a2 x'' + a3 x''' + u_fb
///
///     deviation     s(k+1) = A s(k) + B (u_fb + w),   e = x_m - x of the same instant = C s + v
///     estimate      s^ <- s^ + L (e - C s^),          s^(k+1) = A s^ + B u_fb
///     regulator     u_fb = -K s^
///
/// a_i are those of the model's inverse (transfer_system_model.hpp); x, x' and x'' are the integrator's
/// own, x''' a difference of x'' over some milliseconds; K and L are the steady gains of the model
/// discretised with a hold, for weights [0 … regulator_weight … 0] on the displacement error against
/// 1 on u_fb, and for an input noise w and a sensor noise v.
///
/// Exact for constant jerk where the model is right (the fourth and fifth derivative are left out).
/// Interpretation: the papers shape w by filters of the laboratory's own; here it is white.
class FeedforwardLqg final : public Compensator {
 public:
  struct Parameters {
    TransferSystemModel model;
    bool has_feedback = true;
    double regulator_weight = 30.0;
    double input_noise_m = 2e-4;           // standard deviation of w
    double displacement_noise_m = 1.6e-5;  // standard deviation of v
    double jerk_difference_s = 0.004;

    void serialize(ParameterArchive& archive) {
      constexpr Range kNoise{.low = 0.0, .high = 1.0, .low_open = true};
      archive.section("plant", model, "the transfer system, below");
      archive.optional("has_feedback", has_feedback, {.what = "`false`: the feedforward alone"});
      archive.optional("regulator_weight", regulator_weight,
                       {{.low = 0.0, .high = 1e9, .low_open = true},
                        "of the displacement error against the command",
                        "without a weight on the error nothing is regulated"});
      archive.optional("input_noise_m", input_noise_m,
                       {kNoise, "of the plant's input, standard deviation per sample",
                        "without noise of the input no measurement would be believed"});
      archive.optional(
          "displacement_noise_m", displacement_noise_m,
          {kNoise, "of the sensor, standard deviation", "every sensor has noise, and the estimator divides by it"});
      archive.optional("jerk_difference_s", jerk_difference_s,
                       {{.low = 0.0, .high = 0.1, .low_open = true},
                        "span of the difference that gives the jerk",
                        "the jerk of the structure changes within it",
                        "1 control period to 0.1"});
    }
  };

  /// @throws ConfigError for values outside their ranges and where no regulator exists.
  FeedforwardLqg(const Parameters& parameters, double control_period_s);

  [[nodiscard]] double command(const CompensatorInput& input) noexcept override;
  void reset() noexcept override;

 private:
  [[nodiscard]] double feedforward(const CompensatorInput& input) noexcept;
  void regulate(const CompensatorInput& input) noexcept;

  static constexpr int kStates = TransferSystemModel::kStates;
  using State = TransferSystemModel::State;

  bool has_feedback_;
  std::array<double, 6> inverse_;
  std::size_t jerk_samples_;
  double jerk_difference_s_;
  DiscreteTransferSystem system_;
  Eigen::Matrix<double, 1, kStates> regulator_gain_;
  State estimator_gain_;
  State deviation_ = State::Zero();
  SampleHistory accelerations_m_per_s2_;
  double previous_target_m_ = 0.0;
  bool has_target_ = false;
  double feedback_m_ = 0.0;
};

}  // namespace hybridtest
