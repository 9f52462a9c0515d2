#include "compensation/transfer_system_model.hpp"

#include <cmath>

#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {

TransferSystemModel::Matrix TransferSystemModel::state_matrix() const noexcept {
  Matrix a = Matrix::Zero();
  a(kZ, kZRate) = 1.0;
  a(kZRate, kZ) = -beta2_per_s2;
  a(kZRate, kZRate) = -beta1_per_s;
  a(kZRate, kDisplacement) = -a1beta0_n_per_m_s3;
  a(kForce, kZ) = 1.0;
  a(kForce, kForce) = -a3_per_s;
  a(kForce, kVelocity) = -a2_n_per_m;
  a(kDisplacement, kVelocity) = 1.0;
  a(kVelocity, kForce) = 1.0 / mass_kg;
  a(kVelocity, kVelocity) = -damping_n_s_per_m / mass_kg;
  a(kVelocity, kDisplacement) = -stiffness_n_per_m / mass_kg;
  return a;
}

TransferSystemModel::State TransferSystemModel::input_vector() const noexcept {
  State b = State::Zero();
  b(kZRate) = a1beta0_n_per_m_s3 * gain;
  return b;
}

std::array<double, 6> TransferSystemModel::inverse_coefficients() const noexcept {
  // z = w0 x + w1 x' + w2 x'' + w3 x''' by eliminating F, then u by the valve's equation.
  const double w0 = a3_per_s * stiffness_n_per_m;
  const double w1 = stiffness_n_per_m + a3_per_s * damping_n_s_per_m + a2_n_per_m;
  const double w2 = damping_n_s_per_m + a3_per_s * mass_kg;
  const double w3 = mass_kg;
  const double scale = 1.0 / (a1beta0_n_per_m_s3 * gain);
  return {1.0 / gain + beta2_per_s2 * w0 * scale,
          (beta2_per_s2 * w1 + beta1_per_s * w0) * scale,
          (beta2_per_s2 * w2 + beta1_per_s * w1 + w0) * scale,
          (beta2_per_s2 * w3 + beta1_per_s * w2 + w1) * scale,
          (beta1_per_s * w3 + w2) * scale,
          w3 * scale};
}

double TransferSystemModel::low_frequency_delay_s() const noexcept {
  const double open = beta2_per_s2 * a3_per_s * stiffness_n_per_m;
  const double slope = beta1_per_s * a3_per_s * stiffness_n_per_m +
                       beta2_per_s2 * (stiffness_n_per_m + a2_n_per_m + a3_per_s * damping_n_s_per_m);
  return slope / (a1beta0_n_per_m_s3 + open);
}

DiscreteTransferSystem discretised(const TransferSystemModel& model, double period_s) noexcept {
  // A displacement stands for itself, the others for what it goes with at the specimen's frequency w.
  const double w = std::sqrt(model.stiffness_n_per_m / model.mass_kg);
  DiscreteTransferSystem discrete;
  const double force = model.stiffness_n_per_m;
  discrete.scale << force * w, force * w * w, force, 1.0, w;
  using Augmented = Eigen::Matrix<double, TransferSystemModel::kStates + 1, TransferSystemModel::kStates + 1>;
  constexpr int kStates = TransferSystemModel::kStates;
  Augmented exponent = Augmented::Zero();
  exponent.topLeftCorner<kStates, kStates>() =
      discrete.scale.cwiseInverse().asDiagonal() * model.state_matrix() * discrete.scale.asDiagonal();
  exponent.topRightCorner<kStates, 1>() = model.input_vector().cwiseQuotient(discrete.scale);
  exponent *= period_s;
  // exp by Taylor's series of a 2^-n-th part, squared n times.
  const double norm = exponent.cwiseAbs().rowwise().sum().maxCoeff();
  const int squarings = norm > 0.25 ? static_cast<int>(std::ceil(std::log2(norm / 0.25))) : 0;
  exponent /= std::ldexp(1.0, squarings);
  Augmented term = Augmented::Identity();
  Augmented sum = Augmented::Identity();
  for (int n = 1; n <= 14; ++n) {  // 0.25^15 / 15! is far below rounding
    term = term * exponent / n;
    sum += term;
  }
  for (int i = 0; i < squarings; ++i) sum = (sum * sum).eval();
  discrete.transition = sum.topLeftCorner<kStates, kStates>();
  discrete.input = sum.topRightCorner<kStates, 1>();
  return discrete;
}

}  // namespace hybridtest
