#pragma once

#include <Eigen/Core>
#include <array>

namespace hybridtest {

/// Linear model of a servo-hydraulic transfer system with its specimen, one degree of freedom
/// (Maghareh, Silva and Dyke, 2018; numbers of the virtual RTHS benchmark, Silva et al., 2020;
/// another laboratory identifies its own):
///
///     z'' + beta1 z' + beta2 z = a1beta0 (gain u - x)     servo valve and its controller
///     F' + a3 F = z - a2 x'                               oil column: leakage and piston
///     m x'' + c x' + k x = F                              specimen
///
/// u command [m], x displacement [m], F force [N], z [N/s].
struct TransferSystemModel {
  double gain = 1.0261;                   // []
  double a1beta0_n_per_m_s3 = 2.1283e13;  // [N/(m s3)]
  double a2_n_per_m = 4.2297e6;           // [N/m]
  double a3_per_s = 3.3;                  // [1/s]
  double beta1_per_s = 425.0;             // [1/s]
  double beta2_per_s2 = 9.9976e4;         // [1/s2]
  double mass_kg = 29.13;                 // [kg]
  double damping_n_s_per_m = 114.22;      // [N s/m]
  double stiffness_n_per_m = 1.190e6;     // [N/m]

  static constexpr int kStates = 5;  // z, z', F, x, x'
  using State = Eigen::Matrix<double, kStates, 1>;
  using Matrix = Eigen::Matrix<double, kStates, kStates>;
  enum Index : Eigen::Index { kZ, kZRate, kForce, kDisplacement, kVelocity };

  /// s' = state_matrix() s + input_vector() u.
  [[nodiscard]] Matrix state_matrix() const noexcept;
  [[nodiscard]] State input_vector() const noexcept;

  /// The inverse of the transfer function u -> x, a polynomial because that has no zeros:
  /// u = sum over i of coefficient[i] d^i x / dt^i. [s^i]
  [[nodiscard]] std::array<double, 6> inverse_coefficients() const noexcept;
};

/// @return `model`.
/// @throws ConfigError unless gain, a1beta0, beta1, beta2, mass and stiffness are positive and the others not negative.
const TransferSystemModel& checked(const TransferSystemModel& model);

/// s(k+1) = transition s(k) + input u(k), u held over the period, in states divided by `scale`, which
/// makes all of them of the size of a displacement: Riccati equations want that.
struct DiscreteTransferSystem {
  TransferSystemModel::Matrix transition;
  TransferSystemModel::State input;
  TransferSystemModel::State scale;
};

[[nodiscard]] DiscreteTransferSystem discretised(const TransferSystemModel& model, double period_s) noexcept;

}  // namespace hybridtest
