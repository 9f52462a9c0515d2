#include "validation/studies/rths_benchmark/frame.hpp"

#include <string>

#include "core/config_error.hpp"
#include "validation/studies/rths_benchmark/runge_kutta.hpp"

namespace hybridtest::rths {
namespace {

/// Upper triangle by rows.
using Triangle = std::array<double, 6>;

// Masses, dampings and stiffness as in the files released with the benchmark.
constexpr std::array<double, kCases> kMassKg{1000.0, 1100.0, 1300.0, 1000.0};
constexpr std::array<Triangle, kCases> kDampingNSPerM{{
    {14084.275745299876, -7873.031460913151, 440.45149884262497, 14943.622937895665, -6348.672096305332,
     7223.101316804461},
    {11817.42262041908, -6606.215423308699, 369.6755622296924, 12538.57756973086, -5327.047373791856,
     6060.319809850064},
    {9635.014363361863, -5386.025774196528, 301.4386401440686, 10223.006811768844, -4343.084702116764,
     4941.298824869293},
    {8450.565447179924, -4723.818876547892, 264.27089930557594, 8966.173762737399, -3809.203257783199,
     4333.8607900826755},
}};
constexpr Triangle kStiffnessNPerM{26054883.879603837, -23133938.877108198, 5937035.463339146,
                                   32560774.186380334, -14419970.777236985, 9267275.506224312};

constexpr std::array<std::array<double, kFloors>, kFloors> symmetric(const Triangle& t) {
  return {{{t[0], t[1], t[2]}, {t[1], t[3], t[4]}, {t[2], t[4], t[5]}}};
}

}  // namespace

Frame Frame::of_case(int case_number) {
  if (case_number < 1 || case_number > kCases) {
    throw ConfigError{"case " + std::to_string(case_number) + "; the benchmark has cases 1 to 4"};
  }
  const auto index = static_cast<std::size_t>(case_number - 1);
  Frame frame;
  frame.mass_kg_ = frame.mass_of_floor_1_kg_ = kMassKg[index];
  frame.damping_n_s_per_m_ = symmetric(kDampingNSPerM[index]);
  frame.stiffness_n_per_m_ = symmetric(kStiffnessNPerM);
  return frame;
}

Frame Frame::without(const TransferSystemModel& specimen) const noexcept {
  Frame rest = *this;
  rest.mass_of_floor_1_kg_ -= specimen.mass_kg;
  rest.damping_n_s_per_m_[0][0] -= specimen.damping_n_s_per_m;
  rest.stiffness_n_per_m_[0][0] -= specimen.stiffness_n_per_m;
  return rest;
}

bool Frame::equals(const Eigen::Ref<const Eigen::Matrix3d>& mass_kg,
                   const Eigen::Ref<const Eigen::Matrix3d>& damping_n_s_per_m,
                   const Eigen::Ref<const Eigen::Matrix3d>& stiffness_n_per_m) const noexcept {
  constexpr double kSame = 1e-9;
  using RowMajor = Eigen::Matrix<double, kFloors, kFloors, Eigen::RowMajor>;
  const Eigen::Matrix3d mass{Eigen::Vector3d{mass_of_floor_1_kg_, mass_kg_, mass_kg_}.asDiagonal()};
  return mass.isApprox(mass_kg, kSame) &&
         Eigen::Map<const RowMajor>{damping_n_s_per_m_[0].data()}.isApprox(damping_n_s_per_m, kSame) &&
         Eigen::Map<const RowMajor>{stiffness_n_per_m_[0].data()}.isApprox(stiffness_n_per_m, kSame);
}

Frame::Floors Frame::acceleration(std::span<const double, 2 * kFloors> state, double ground_m_per_s2,
                                  double specimen_force_n) const noexcept {
  Floors acceleration{};
  for (std::size_t i = 0; i < kFloors; ++i) {
    double force_n = -mass_kg_ * ground_m_per_s2 - (i == 0 ? specimen_force_n : 0.0);
    for (std::size_t j = 0; j < kFloors; ++j) {
      force_n -= stiffness_n_per_m_[i][j] * state[j] + damping_n_s_per_m_[i][j] * state[kFloors + j];
    }
    acceleration[i] = force_n / (i == 0 ? mass_of_floor_1_kg_ : mass_kg_);
  }
  return acceleration;
}

void Frame::step(State& state, const GroundMotion& motion, double time_s, double specimen_force_n) const noexcept {
  runge_kutta_step(state, kPeriodS, [&](double share, const State& at, State& rate) {
    const Floors second = acceleration(at, motion.at(time_s + share * kPeriodS), specimen_force_n);
    for (std::size_t i = 0; i < kFloors; ++i) {
      rate[i] = at[kFloors + i];
      rate[kFloors + i] = second[i];
    }
  });
}

}  // namespace hybridtest::rths
