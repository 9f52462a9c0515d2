#include "diagnosis/test_response.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace hybridtest {
namespace {

constexpr double kStep_s = 0.01;

/// Two degrees of freedom at a steady speed against a steady force, pulled by twice of it.
TestResponse steady(double speed_m_per_s, double force_n, Eigen::Index steps) {
  TestResponse response;
  response.step_s = kStep_s;
  response.velocity_m_per_s = Eigen::MatrixXd::Constant(2, steps, speed_m_per_s);
  response.restoring_force_n = Eigen::MatrixXd::Constant(2, steps, force_n);
  response.applied_force_n = 2.0 * response.restoring_force_n;
  const double way_m = speed_m_per_s * kStep_s * static_cast<double>(steps - 1);
  response.displacement_m = Eigen::Vector2d::Ones() * Eigen::RowVectorXd::LinSpaced(steps, 0.0, way_m);
  return response;
}

// What rounding leaves of a few hundred additions.
constexpr double kRounding = 1e-12;

TEST(TestResponse, SameTestHasNoError) {
  const TestResponse test = steady(0.1, 1000.0, 101);
  const ResponseError error = response_error(test, test);
  EXPECT_EQ(error.nrmse, 0.0);
  EXPECT_EQ(error.peak_error, 0.0);
  EXPECT_EQ(error.energy_error, 0.0);
}

TEST(TestResponse, ErrorsAreRelativeToTheRecordedTest) {
  const TestResponse real = steady(0.1, 1000.0, 101);
  const TestResponse tenth_faster = steady(0.11, 1000.0, 101);
  const ResponseError error = response_error(real, tenth_faster);
  EXPECT_NEAR(error.nrmse, 0.1, kRounding);
  EXPECT_NEAR(error.peak_error, 0.1, kRounding);
  // A tenth more is taken, and twice as much as is taken was put in.
  EXPECT_NEAR(error.energy_error, 0.05, kRounding);
}

TEST(TestResponse, PeaksUseWorstDegreeOfFreedom) {
  const TestResponse real = steady(0.1, 1000.0, 101);
  TestResponse other = real;
  other.displacement_m.row(1) *= -1.3;
  EXPECT_NEAR(response_error(real, other).peak_error, 0.3, kRounding);
}

TEST(TestResponse, ComparesUpToAnEarlyEnd) {
  const TestResponse real = steady(0.1, 1000.0, 101);
  const ResponseError error = response_error(real, steady(0.1, 1000.0, 51));
  EXPECT_NEAR(error.nrmse, 0.0, kRounding);
  EXPECT_NEAR(error.peak_error, 0.0, kRounding);
  EXPECT_NEAR(error.energy_error, 0.0, kRounding);
}

TEST(TestResponse, EmptyComparisonHasNoError) {
  const TestResponse still = steady(0.0, 0.0, 101);
  const ResponseError error = response_error(still, still);
  EXPECT_EQ(error.nrmse + error.peak_error + error.energy_error, 0.0);
  EXPECT_EQ(response_error(steady(0.1, 1.0, 10), TestResponse{kStep_s, Eigen::MatrixXd{2, 0}, Eigen::MatrixXd{2, 0},
                                                              Eigen::MatrixXd{2, 0}, Eigen::MatrixXd{2, 0}})
                .nrmse,
            0.0);
}

}  // namespace
}  // namespace hybridtest
