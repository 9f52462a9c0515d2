#include "compensation/adaptive_model_inverse.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "compensation/discrete_regulator.hpp"
#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {
namespace {

// Beyond the states of the transfer system.
enum : Eigen::Index { kStiffness = TransferSystemModel::kStates, kBeta2, kA3, kBeta1, kDisturbance };
using Model = TransferSystemModel;

void expect_positive_within_bound(const char* name, double deviation, double bound, double nominal) {
  expect_in_range(name, deviation, {.low = 0.0, .high = std::nextafter(nominal / bound, 0.0)},
                  "parameter_bound deviations below its nominal value the parameter must still be positive");
}

const AdaptiveModelInverse::Parameters& checked_all(const AdaptiveModelInverse::Parameters& parameters,
                                                    double control_period_s) {
  const double bound = checked(parameters).parameter_bound;
  checked_control_period(control_period_s);
  expect_in_range("advance_s", parameters.advance_s, {.low = 0.0, .high = 5.0 * control_period_s},
                  "the target is a polynomial of order 4 for no longer");
  expect_positive_within_bound("stiffness_deviation_n_per_m", parameters.stiffness_deviation_n_per_m, bound,
                               parameters.model.stiffness_n_per_m);
  expect_positive_within_bound("beta2_deviation_per_s2", parameters.beta2_deviation_per_s2, bound,
                               parameters.model.beta2_per_s2);
  expect_positive_within_bound("beta1_deviation_per_s", parameters.beta1_deviation_per_s, bound,
                               parameters.model.beta1_per_s);
  expect_in_range("jerk_filter_hz", parameters.jerk_filter_hz,
                  {.low = 0.0, .high = 0.1 / control_period_s, .low_open = true},
                  "the filter runs at the control rate");
  return parameters;
}

Eigen::Matrix<double, 1, Model::kStates> nominal_gain(const AdaptiveModelInverse::Parameters& parameters,
                                                      double control_period_s) {
  const DiscreteTransferSystem system = discretised(parameters.model, control_period_s);
  Model::Matrix weight = Model::Matrix::Zero();
  weight(Model::kDisplacement, Model::kDisplacement) = parameters.regulator_weight;
  const Eigen::RowVectorXd scaled = regulator_gain(system.transition, system.input, weight, 1.0);
  return scaled.cwiseQuotient(system.scale.transpose());
}

}  // namespace

AdaptiveModelInverse::AdaptiveModelInverse(const Parameters& parameters, double control_period_s)
    : settings_{checked_all(parameters, control_period_s)},
      control_period_s_{control_period_s},
      nominal_{parameters.model.stiffness_n_per_m, parameters.model.beta2_per_s2, parameters.model.a3_per_s,
               parameters.model.beta1_per_s},
      deviations_{parameters.stiffness_deviation_n_per_m, parameters.beta2_deviation_per_s2,
                  parameters.a3_deviation_per_s, parameters.beta1_deviation_per_s},
      keep_{1.0 - control_period_s / parameters.parameter_memory_s},
      input_vector_{parameters.model.input_vector()},
      gain_{nominal_gain(parameters, control_period_s)} {
  reset();
}

void AdaptiveModelInverse::reset() noexcept {
  state_.setZero();
  covariance_.setZero();
  if (settings_.adapts) covariance_.diagonal().segment<4>(kStiffness) = deviations_.cwiseAbs2();
  course_.setZero();
  jerk_filter_.setZero();
  sent_m_ = 0.0;
  has_target_ = false;
}

double AdaptiveModelInverse::command(const CompensatorInput& input) noexcept {
  // The estimate stands at the instant of the measurements: correct it there, then bring it to now.
  correct(Model::kDisplacement, input.measured_displacement_m, settings_.displacement_noise_m);
  correct(Model::kForce, input.measured_force_n, settings_.force_noise_n);
  predict(sent_m_);
  if (!std::isfinite(input.target_m) || !std::isfinite(input.target_velocity_m_per_s) ||
      !std::isfinite(input.target_acceleration_m_per_s2)) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const Target target = filtered_target(input);
  const PlantState error = state_.head<kPlant>() - reference_state(target.advanced(settings_.advance_s));
  const Target middle = target.advanced(settings_.advance_s + 0.5 * control_period_s_);
  course_ = reference_state(middle);
  sent_m_ = inverse(middle) - (gain_ * error).value();
  return sent_m_;
}

TransferSystemModel AdaptiveModelInverse::estimated_model() const noexcept {
  TransferSystemModel model = settings_.model;
  const Eigen::Vector4d p = parameters();
  model.stiffness_n_per_m = p(0);
  model.beta2_per_s2 = p(1);
  model.a3_per_s = p(2);
  model.beta1_per_s = p(3);
  return model;
}

AdaptiveModelInverse::Target AdaptiveModelInverse::Target::advanced(double h) const noexcept {
  return {displacement_m + h * (velocity_m_per_s + h * (acceleration_m_per_s2 / 2.0 + h * jerk_m_per_s3 / 6.0)),
          velocity_m_per_s + h * (acceleration_m_per_s2 + h * (jerk_m_per_s3 / 2.0 + h * snap_m_per_s4 / 6.0)),
          acceleration_m_per_s2 + h * (jerk_m_per_s3 + h * snap_m_per_s4 / 2.0), jerk_m_per_s3 + h * snap_m_per_s4,
          snap_m_per_s4};
}

// y'' + 2 w y' + w^2 y = w^2 a, discretised semi-implicitly; y' + (2/w) y'' is the jerk without the
// filter's lag of first order.
AdaptiveModelInverse::Target AdaptiveModelInverse::filtered_target(const CompensatorInput& input) noexcept {
  const double w = 2.0 * std::numbers::pi * settings_.jerk_filter_hz;
  const double h = control_period_s_;
  const double acceleration = input.target_acceleration_m_per_s2;
  if (!has_target_) {
    jerk_filter_ << acceleration, 0.0;
    has_target_ = true;
  }
  const double rate_before = jerk_filter_(1);
  jerk_filter_(1) = (rate_before + h * w * w * (acceleration - jerk_filter_(0))) / (1.0 + 2.0 * w * h + w * w * h * h);
  jerk_filter_(0) += h * jerk_filter_(1);
  const double snap = (jerk_filter_(1) - rate_before) / h;
  return {input.target_m, input.target_velocity_m_per_s, acceleration, jerk_filter_(1) + 2.0 / w * snap, snap};
}

AdaptiveModelInverse::PlantState AdaptiveModelInverse::reference_state(const Target& t) const noexcept {
  const TransferSystemModel p = estimated_model();
  const auto force = [&p](double displacement, double velocity, double acceleration) {
    return p.mass_kg * acceleration + p.damping_n_s_per_m * velocity + p.stiffness_n_per_m * displacement;
  };
  const double f0 = force(t.displacement_m, t.velocity_m_per_s, t.acceleration_m_per_s2);
  const double f1 = force(t.velocity_m_per_s, t.acceleration_m_per_s2, t.jerk_m_per_s3);
  const double f2 = force(t.acceleration_m_per_s2, t.jerk_m_per_s3, t.snap_m_per_s4);
  PlantState reference;
  reference << f1 + p.a3_per_s * f0 + p.a2_n_per_m * t.velocity_m_per_s,
      f2 + p.a3_per_s * f1 + p.a2_n_per_m * t.acceleration_m_per_s2, f0, t.displacement_m, t.velocity_m_per_s;
  return reference;
}

double AdaptiveModelInverse::inverse(const Target& t) const noexcept {
  const TransferSystemModel p = estimated_model();
  const PlantState reference = reference_state(t);
  // The derivatives of the target beyond snap are left out.
  const double f2 = p.mass_kg * t.snap_m_per_s4 + p.damping_n_s_per_m * t.jerk_m_per_s3 +
                    p.stiffness_n_per_m * t.acceleration_m_per_s2;
  const double f3 = p.damping_n_s_per_m * t.snap_m_per_s4 + p.stiffness_n_per_m * t.jerk_m_per_s3;
  const double z2 = f3 + p.a3_per_s * f2 + p.a2_n_per_m * t.jerk_m_per_s3;
  const double valve = z2 + p.beta1_per_s * reference(Model::kZRate) + p.beta2_per_s2 * reference(Model::kZ);
  return (t.displacement_m + valve / p.a1beta0_n_per_m_s3) / p.gain - state_(kDisturbance);
}

void AdaptiveModelInverse::correct(Eigen::Index index, double measured, double deviation) noexcept {
  if (!std::isfinite(measured)) return;
  const AllState column = covariance_.col(index);
  const double variance = column(index) + deviation * deviation;
  // A spike is not a motion.
  const double innovation_max = settings_.innovation_bound * std::sqrt(variance);
  const double innovation = std::clamp(measured - state_(index), -innovation_max, innovation_max);
  const AllState gain = column / variance;
  state_ += gain * innovation;
  covariance_.noalias() -= gain * column.transpose();
}

void AdaptiveModelInverse::predict(double sent_m) noexcept {
  const double h = control_period_s_;
  const PlantMatrix a = estimated_model().state_matrix();
  const PlantState before = state_.head<kPlant>();
  // Taylor series of the exact transition to fifth order: the way from u to x has five integrations.
  PlantState term = a * before + input_vector_ * (sent_m + state_(kDisturbance));
  PlantState after = before + h * term;
  double factor = h;
  for (int n = 2; n <= 5; ++n) {
    factor *= h / n;
    term = (a * term).eval();
    after += factor * term;
  }
  const PlantMatrix ah = a * h;
  const PlantMatrix ah2 = ah * ah;
  const PlantMatrix integral = (PlantMatrix::Identity() + ah / 2.0 + ah2 / 6.0 + ah2 * ah / 24.0) * h;

  // By k, beta2, a3, beta1 and d.
  Coupling sensitivity = Coupling::Zero();
  sensitivity(Model::kVelocity, 0) = -course_(Model::kDisplacement) / settings_.model.mass_kg;
  sensitivity(Model::kZRate, 1) = -course_(Model::kZ);
  sensitivity(Model::kForce, 2) = -course_(Model::kForce);
  sensitivity(Model::kZRate, 3) = -course_(Model::kZRate);
  sensitivity.col(4) = input_vector_;
  spread(PlantMatrix::Identity() + a * integral, integral * sensitivity);

  state_.head<kPlant>() = after;
  const Eigen::Vector4d bound = settings_.parameter_bound * deviations_;
  state_.segment<4>(kStiffness) = (keep_ * state_.segment<4>(kStiffness)).cwiseMax(-bound).cwiseMin(bound).eval();
}

// P <- f P f' + noise with f = (transition, coupling; 0, K) and K diagonal, block by block: half of f is zeros.
void AdaptiveModelInverse::spread(const PlantMatrix& transition, const Coupling& coupling) noexcept {
  Eigen::Matrix<double, 5, 1> kept;
  kept << keep_, keep_, keep_, keep_, 1.0;
  const PlantMatrix plant = covariance_.topLeftCorner<kPlant, kPlant>();
  const Coupling cross = covariance_.topRightCorner<kPlant, 5>();
  const Coupling others = covariance_.bottomRightCorner<5, 5>();

  PlantMatrix moved = transition * plant;
  moved.noalias() += coupling * cross.transpose();
  Coupling moved_cross = transition * cross;
  moved_cross.noalias() += coupling * others;
  PlantMatrix next_plant = moved * transition.transpose();
  next_plant.noalias() += moved_cross * coupling.transpose();
  const PlantState command_noise = coupling.col(4) * settings_.command_noise_m;
  next_plant.noalias() += command_noise * command_noise.transpose();
  Coupling next_others = kept.asDiagonal() * others * kept.asDiagonal();
  if (settings_.adapts) next_others.diagonal().head<4>() += (1.0 - keep_ * keep_) * deviations_.cwiseAbs2();
  next_others(4, 4) += settings_.disturbance_walk_m * settings_.disturbance_walk_m * control_period_s_;

  covariance_.topLeftCorner<kPlant, kPlant>() = 0.5 * (next_plant + next_plant.transpose());
  covariance_.topRightCorner<kPlant, 5>() = moved_cross * kept.asDiagonal();
  covariance_.bottomLeftCorner<5, kPlant>() = covariance_.topRightCorner<kPlant, 5>().transpose();
  covariance_.bottomRightCorner<5, 5>() = 0.5 * (next_others + next_others.transpose());
}

}  // namespace hybridtest
