#pragma once

#include <Eigen/Core>
#include <array>

#include "core/parameters/parameter_archive.hpp"

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
  double gain = 1.0261;
  double a1beta0_n_per_m_s3 = 2.1283e13;
  double a2_n_per_m = 4.2297e6;
  double a3_per_s = 3.3;
  double beta1_per_s = 425.0;
  double beta2_per_s2 = 9.9976e4;
  double mass_kg = 29.13;
  double damping_n_s_per_m = 114.22;
  double stiffness_n_per_m = 1.190e6;

  void serialize(ParameterArchive& archive) {
    constexpr const char* kInverse = "the model is inverted";
    constexpr const char* kDissipation = "a transfer system does not feed energy in";
    archive.optional("gain", gain, {kPositive, "g", kInverse});
    archive.optional("a1beta0_n_per_m_s3", a1beta0_n_per_m_s3, {kPositive, "a₁β₀", kInverse});
    archive.optional("a2_n_per_m", a2_n_per_m, {kNotNegative, "a₂", kDissipation});
    archive.optional("a3_per_s", a3_per_s, {kNotNegative, "a₃", kDissipation});
    archive.optional("beta1_per_s", beta1_per_s, {kPositive, "β₁", kInverse});
    archive.optional("beta2_per_s2", beta2_per_s2, {kPositive, "β₂", kInverse});
    archive.optional("mass_kg", mass_kg, {kPositive, "m", kInverse});
    archive.optional("damping_n_s_per_m", damping_n_s_per_m, {kNotNegative, "c", kDissipation});
    archive.optional("stiffness_n_per_m", stiffness_n_per_m, {kPositive, "k", kInverse});
  }

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

  /// How late the displacement is for slow motion [s]: the slope of its phase at zero frequency.
  [[nodiscard]] double low_frequency_delay_s() const noexcept;
};

/// s(k+1) = transition s(k) + input u(k), u held over the period, in states divided by `scale`, which
/// makes all of them of the size of a displacement: Riccati equations want that.
struct DiscreteTransferSystem {
  TransferSystemModel::Matrix transition;
  TransferSystemModel::State input;
  TransferSystemModel::State scale;
};

[[nodiscard]] DiscreteTransferSystem discretised(const TransferSystemModel& model, double period_s) noexcept;

}  // namespace hybridtest
