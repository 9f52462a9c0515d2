#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "compensation/compensator.hpp"
#include "compensation/sample_history.hpp"
#include "compensation/transfer_system_model.hpp"

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
    bool has_feedback = true;              // off: the feedforward alone
    double regulator_weight = 30.0;        // [] above 0, at most 1e9
    double input_noise_m = 2e-4;           // [m] standard deviation of w, per sample; above 0, at most 1
    double displacement_noise_m = 1.6e-5;  // [m] standard deviation of v; above 0, at most 1
    double jerk_difference_s = 0.004;      // [s] span of the difference for x'''; 1 period to 0.1
  };

  /// @throws ConfigError for values outside these ranges and where no regulator exists.
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
