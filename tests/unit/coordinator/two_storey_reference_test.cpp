#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "coordinator/central_difference.hpp"
#include "coordinator/explicit_newmark.hpp"
#include "coordinator/ground_motion/read_ground_motion.hpp"
#include "mechanics/structure/damping.hpp"
#include "tests/support/shared_data.hpp"
#include "tests/support/structures.hpp"

/// The integrators against time histories of an established program (OpenSees 3.8, Newmark's
/// average acceleration at 0.0005 s): reader, damping, integrator and load together.
namespace hybridtest {
namespace {

constexpr double kStep_s = 0.001;
constexpr int kStepsPerSample = 10;

struct Reference {
  std::vector<std::array<double, 2>> displacement_m;  // of both floors, at 0.01 s, 0.02 s …
};

Reference read_reference(const std::filesystem::path& file) {
  Reference reference;
  std::ifstream stream{file};
  std::string line;
  std::getline(stream, line);
  while (std::getline(stream, line)) {
    std::array<double, 5> row{};
    std::size_t begin = 0;
    for (double& value : row) {
      std::size_t used = 0;
      value = std::stod(line.substr(begin), &used);
      begin += used + 1;
    }
    reference.displacement_m.push_back({row[1], row[2]});
  }
  return reference;
}

/// First storey with kinematic hardening: the force stays between two lines of the hardening slope.
class Column {
 public:
  Column(double yield_force_n, double hardening_ratio)
      : band_n_{(1.0 - hardening_ratio) * yield_force_n}, slope_n_per_m_{hardening_ratio * kStiffness_n_per_m} {}

  double force_n(double displacement_m) {
    const double elastic = force_n_ + kStiffness_n_per_m * (displacement_m - displacement_m_);
    const double middle = slope_n_per_m_ * displacement_m;
    force_n_ = std::clamp(elastic, middle - band_n_, middle + band_n_);
    displacement_m_ = displacement_m;
    return force_n_;
  }

 private:
  static constexpr double kStiffness_n_per_m = 4.0e6;
  double band_n_;
  double slope_n_per_m_;
  double displacement_m_ = 0.0;
  double force_n_ = 0.0;
};

/// Largest displacement error of each floor over all 31 s, in percent of its peak.
template <typename Method>
std::array<double, 2> error_percent(Column first_storey, const Reference& reference, const GroundMotion& motion) {
  LinearStructure structure = test::two_storeys();
  structure.damping_n_s_per_m =
      rayleigh_damping(structure, rayleigh_coefficients(0.02, 1, 2, vibration_modes(structure)));
  const Eigen::VectorXd load = structure.load_per_ground_acceleration_kg();
  Method integrator{structure, kStep_s};
  std::array<double, 2> error{};
  std::array<double, 2> peak{};
  const int steps = kStepsPerSample * static_cast<int>(reference.displacement_m.size());
  for (int step = 0; step <= steps; ++step) {
    const Eigen::VectorXd& displacement = integrator.current().displacement_m;
    if (step > 0 && step % kStepsPerSample == 0) {
      const auto& expected = reference.displacement_m[static_cast<std::size_t>(step / kStepsPerSample - 1)];
      for (std::size_t floor = 0; floor < 2; ++floor) {
        const double actual = displacement[static_cast<Eigen::Index>(floor)];
        error[floor] = std::max(error[floor], std::abs(actual - expected[floor]));
        peak[floor] = std::max(peak[floor], std::abs(expected[floor]));
      }
    }
    const double lower = first_storey.force_n(displacement[0]);
    const double upper = 3.0e6 * (displacement[1] - displacement[0]);
    integrator.advance(Eigen::Vector2d{lower - upper, upper}, load * motion.at(step * kStep_s));
  }
  return {100.0 * error[0] / peak[0], 100.0 * error[1] / peak[1]};
}

template <typename Method>
void expect_reference(const std::string& name, Column first_storey) {
  const auto record = shared_data("ground_motions/elcentro_1940_ns.AT2");
  const auto history = shared_data("reference/two_storey_" + name + ".csv");
  HYBRIDTEST_NEEDS_DATA(record);
  HYBRIDTEST_NEEDS_DATA(history);
  const Reference reference = read_reference(history);
  ASSERT_EQ(reference.displacement_m.size(), 3100U);
  const auto error = error_percent<Method>(first_storey, reference, read_ground_motion(record));
  ::testing::Test::RecordProperty("floor_1_error_percent", std::to_string(error[0]));
  ::testing::Test::RecordProperty("floor_2_error_percent", std::to_string(error[1]));
  // Both methods are of second order; their difference at these steps is 0.02 % at most.
  EXPECT_LT(error[0], 0.02);
  EXPECT_LT(error[1], 0.02);
}

const Column kElastic{1.0e12, 1.0};
const Column kBilinear{40.0e3, 0.05};

TEST(TwoStoreyReference, CentralDifferenceLinear) { expect_reference<CentralDifference>("linear", kElastic); }
TEST(TwoStoreyReference, CentralDifferenceBilinear) { expect_reference<CentralDifference>("bilinear", kBilinear); }
TEST(TwoStoreyReference, ExplicitNewmarkLinear) { expect_reference<ExplicitNewmark>("linear", kElastic); }
TEST(TwoStoreyReference, ExplicitNewmarkBilinear) { expect_reference<ExplicitNewmark>("bilinear", kBilinear); }

}  // namespace
}  // namespace hybridtest
