#include "mechanics/structure/sparse_modes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/config_error.hpp"
#include "mechanics/structure/vibration_modes.hpp"
#include "tests/support/structures.hpp"

namespace hybridtest {
namespace {

using SparseMatrix = Eigen::SparseMatrix<double>;

constexpr int kStoreys = 10'000;
constexpr double kMass_kg = 1.0e3;
constexpr double kStorey_n_per_m = 1.0e8;

/// omega_j = 2 sqrt(k/m) sin((2j - 1) pi / (4n + 2)) of equal storeys, j from 1.
double storey_mode_rad_per_s(int mode) {
  const double angle = (2 * mode - 1) * std::numbers::pi / (4 * kStoreys + 2);
  return 2.0 * std::sqrt(kStorey_n_per_m / kMass_kg) * std::sin(angle);
}

/// Equal storeys one on the other; without the first it stands on nothing.
LinearStructure tall_building(bool stands_on_ground) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int floor = 0; floor < kStoreys; ++floor) {
    const bool has_storey_below = floor > 0 || stands_on_ground;
    if (has_storey_below) entries.emplace_back(floor, floor, kStorey_n_per_m);
    if (floor == 0) continue;
    entries.emplace_back(floor - 1, floor - 1, kStorey_n_per_m);
    entries.emplace_back(floor, floor - 1, -kStorey_n_per_m);
    entries.emplace_back(floor - 1, floor, -kStorey_n_per_m);
  }
  LinearStructure structure;
  structure.mass_kg = SparseMatrix(kStoreys, kStoreys);
  structure.mass_kg.setIdentity();
  structure.mass_kg *= kMass_kg;
  structure.damping_n_s_per_m = SparseMatrix(kStoreys, kStoreys);
  structure.initial_stiffness_n_per_m = SparseMatrix(kStoreys, kStoreys);
  structure.initial_stiffness_n_per_m.setFromTriplets(entries.begin(), entries.end());
  structure.influence = Eigen::VectorXd::Ones(kStoreys);
  return structure;
}

TEST(SparseModes, TenThousandStoreysMatchClosedForm) {
  const VibrationModes modes = vibration_modes(tall_building(true), 12);
  ASSERT_EQ(modes.count(), 12);
  for (int mode = 1; mode <= 12; ++mode) {
    const double expected = storey_mode_rad_per_s(mode);
    EXPECT_NEAR(modes.frequency_rad_per_s[mode - 1], expected, 1e-7 * expected) << mode;
  }
  // Of a continuous bar the first mode takes 8/pi^2 of the mass, the third 1/25 of that.
  const double first = 8.0 / (std::numbers::pi * std::numbers::pi) * kStoreys * kMass_kg;
  EXPECT_NEAR(modes.effective_mass_kg[0], first, 1e-3 * first);
  EXPECT_NEAR(modes.effective_mass_kg[2], first / 25.0, 1e-3 * first / 25.0);
}

TEST(SparseModes, HighestFrequencyIsABoundFromAbove) {
  const double expected = storey_mode_rad_per_s(kStoreys);
  const double found = vibration_modes(tall_building(true), 0).highest_frequency_rad_per_s();
  EXPECT_GE(found, expected);
  EXPECT_LE(found, (1.0 + 1e-3) * expected);
}

TEST(SparseModes, StructureWithoutSupportHasAZeroFrequency) {
  const VibrationModes modes = vibration_modes(tall_building(false), 3);
  EXPECT_EQ(modes.frequency_rad_per_s[0], 0.0);
  // Free at both ends: omega_j = 2 sqrt(k/m) sin(j pi / 2n).
  const double second = 2.0 * std::sqrt(kStorey_n_per_m / kMass_kg) * std::sin(std::numbers::pi / (2 * kStoreys));
  EXPECT_NEAR(modes.frequency_rad_per_s[1], second, 1e-6 * second);
  EXPECT_NEAR(modes.effective_mass_kg[0], kStoreys * kMass_kg, 1e-6 * kStoreys * kMass_kg);
}

TEST(SparseModes, RejectsNegativeStiffness) {
  LinearStructure structure = tall_building(true);
  structure.initial_stiffness_n_per_m *= -1.0;
  EXPECT_THROW(static_cast<void>(vibration_modes(structure, 1)), ConfigError);
}

TEST(SparseModes, RejectsMoreModesThanLanczosIsFor) {
  EXPECT_THROW(static_cast<void>(vibration_modes(tall_building(true), kLowestModesMax + 1)), ConfigError);
}

TEST(SparseModes, AgreeWithDenseSolutionForFullMatrices) {
  Random random{11};
  const Eigen::MatrixXd mass = test::random_definite_matrix(60, random);
  const Eigen::MatrixXd stiffness = 1e4 * test::random_definite_matrix(60, random);
  const SparseMatrix sparse_mass = mass.sparseView();
  const SparseMatrix sparse_stiffness = stiffness.sparseView();
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> dense{stiffness, mass};
  const double highest = dense.eigenvalues().maxCoeff();
  const double largest = largest_eigenvalue(sparse_stiffness, sparse_mass);
  EXPECT_GE(largest, highest);
  EXPECT_LE(largest, (1.0 + 1e-3) * highest);
  const Eigenpairs pairs = lowest_eigenpairs(sparse_stiffness, sparse_mass, 5, largest);
  for (Eigen::Index mode = 0; mode < 5; ++mode) {
    EXPECT_NEAR(pairs.values[mode], dense.eigenvalues()[mode], 1e-9 * dense.eigenvalues()[mode]);
    const double same = pairs.vectors.col(mode).dot(mass * dense.eigenvectors().col(mode));
    EXPECT_NEAR(std::abs(same), 1.0, 1e-9);
  }
}

}  // namespace
}  // namespace hybridtest
