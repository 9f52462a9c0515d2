#include "validation/studies/rths_benchmark/frame.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <numbers>
#include <ostream>

#include "core/config_error.hpp"

namespace hybridtest::rths {
namespace {

/// -M^-1 K (first 3 columns) and -M^-1 C, as the frame's accelerations show them.
Eigen::Matrix<double, 3, 6> accelerations(const Frame& frame) {
  Eigen::Matrix<double, 3, 6> found;
  for (int column = 0; column < 6; ++column) {
    std::array<double, 6> state{};
    state[static_cast<std::size_t>(column)] = 1.0;
    const auto acceleration = frame.acceleration(state, 0.0, 0.0);
    for (int row = 0; row < 3; ++row) found(row, column) = acceleration[static_cast<std::size_t>(row)];
  }
  return found;
}

struct PublishedCase {
  int number;
  std::array<double, 3> frequencies_hz;
  double damping_ratio;
};

void PrintTo(const PublishedCase& published, std::ostream* out) { *out << "case " << published.number; }

class PublishedCases : public testing::TestWithParam<PublishedCase> {};

TEST_P(PublishedCases, MatchPublishedFrequenciesAndDamping) {
  const auto a = accelerations(Frame::of_case(GetParam().number));
  // All masses of a case are the same, so that M^-1 K is symmetric and its eigenvectors are the modes.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> modes{-a.leftCols<3>()};
  for (int mode = 0; mode < 3; ++mode) {
    const double omega = std::sqrt(modes.eigenvalues()(mode));
    // Published to a thousandth of a hertz.
    EXPECT_NEAR(omega / (2.0 * std::numbers::pi), GetParam().frequencies_hz[static_cast<std::size_t>(mode)], 5e-4);
    const Eigen::Vector3d shape = modes.eigenvectors().col(mode);
    // The released matrices give it to five digits.
    EXPECT_NEAR(-shape.dot(a.rightCols<3>() * shape) / (2.0 * omega), GetParam().damping_ratio, 1e-5);
  }
}

INSTANTIATE_TEST_SUITE_P(Frame, PublishedCases,
                         testing::Values(PublishedCase{1, {3.612, 15.997, 38.086}, 0.05},
                                         PublishedCase{2, {3.444, 15.252, 36.314}, 0.04},
                                         PublishedCase{3, {3.168, 14.030, 33.404}, 0.03},
                                         PublishedCase{4, {3.612, 15.997, 38.086}, 0.03}));

TEST(Frame, PartitionedFrameMovesAsTheWhole) {
  const Frame whole = Frame::of_case(2);
  const TransferSystemModel specimen;
  const Frame rest = whole.without(specimen);
  const std::array<double, 6> state{0.002, -0.001, 0.003, 0.05, -0.02, 0.01};
  const auto wanted = whole.acceleration(state, 1.5, 0.0);
  // The specimen's share of the whole frame's motion; the load is that of the full mass on either side.
  const double force_n =
      specimen.mass_kg * wanted[0] + specimen.damping_n_s_per_m * state[3] + specimen.stiffness_n_per_m * state[0];
  const auto found = rest.acceleration(state, 1.5, force_n);
  for (std::size_t floor = 0; floor < 3; ++floor) EXPECT_NEAR(found[floor], wanted[floor], 1e-10);
}

TEST(Frame, StepIsOfFourthOrder) {
  // Free vibration against itself at half the step would need another step; against the exponential of A it is exact.
  const Frame frame = Frame::of_case(1);
  const auto a = accelerations(frame);
  Eigen::Matrix<double, 6, 6> system = Eigen::Matrix<double, 6, 6>::Zero();
  system.topRightCorner<3, 3>().setIdentity();
  system.bottomRows<3>() = a;
  const Eigen::Matrix<double, 6, 6> h = system * kPeriodS;
  const Eigen::Matrix<double, 6, 6> taylor =
      Eigen::Matrix<double, 6, 6>::Identity() + h + h * h / 2.0 + h * h * h / 6.0 + h * h * h * h / 24.0;
  Frame::State state{0.001, 0.002, -0.001, 0.1, -0.05, 0.02};
  const Eigen::Matrix<double, 6, 1> wanted = taylor * Eigen::Map<const Eigen::Matrix<double, 6, 1>>(state.data());
  frame.step(state, GroundMotion{}, 0.0, 0.0);
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(state[static_cast<std::size_t>(i)], wanted(i), 1e-14);
}

TEST(Frame, RejectsUnknownCase) {
  EXPECT_THROW(static_cast<void>(Frame::of_case(0)), ConfigError);
  EXPECT_THROW(static_cast<void>(Frame::of_case(5)), ConfigError);
}

}  // namespace
}  // namespace hybridtest::rths
