#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "diagnosis/runs/run_records.hpp"
#include "diagnosis/structure/structure_diagnosis.hpp"
#include "recording/error.hpp"
#include "tests/simulation/kept_simulation.hpp"
#include "tests/simulation/recorded_simulation.hpp"
#include "tests/support/shear_frame.hpp"
#include "tests/unit/recording/temporary_directory.hpp"

/// Structures from matrices: the elastic part in the coordinator, the sites beside it.
namespace hybridtest {
namespace {

using namespace test::shear_frame;

/// Bilinear with kinematic hardening, by return mapping.
class YieldingColumn {
 public:
  [[nodiscard]] double force_n(double drift_m) const {
    const double elastic_n = (1.0 - kHardening) * kStorey_n_per_m * (drift_m - slip_m_);
    return kHardening * kStorey_n_per_m * drift_m + std::clamp(elastic_n, -strength_n(), strength_n());
  }
  void commit(double drift_m) {
    const double reach_m = strength_n() / ((1.0 - kHardening) * kStorey_n_per_m);
    slip_m_ = std::clamp(slip_m_, drift_m - reach_m, drift_m + reach_m);
  }
  [[nodiscard]] bool has_slipped() const { return slip_m_ != 0.0; }

 private:
  static double strength_n() { return (1.0 - kHardening) * kYield_n; }
  double slip_m_ = 0.0;
};

/// The whole frame in one piece, by the classical Runge-Kutta method.
class WholeFrame {
 public:
  explicit WholeFrame(double substep_s)
      : substep_s_{substep_s}, rest_{frame_stiffness(false)}, whole_{frame_stiffness(true)} {
    // The frames of the lowest three modes move together: those of a building of equal storeys.
    const auto mode = [](int number) {
      return 2.0 * std::sqrt(kStorey_n_per_m / kMass_kg) *
             std::sin((2 * number - 1) * std::numbers::pi / (4 * kFloors + 2));
    };
    const double factor = 2.0 * kRatio / (mode(1) + mode(3));
    mass_damping_per_s_ = factor * mode(1) * mode(3);
    stiffness_damping_s_ = factor;
  }

  void step(double ground_from, double ground_to) {
    const double middle = 0.5 * (ground_from + ground_to);
    const Eigen::VectorXd a1 = acceleration(u_, v_, ground_from);
    const Eigen::VectorXd v2 = v_ + 0.5 * substep_s_ * a1;
    const Eigen::VectorXd a2 = acceleration(u_ + 0.5 * substep_s_ * v_, v2, middle);
    const Eigen::VectorXd v3 = v_ + 0.5 * substep_s_ * a2;
    const Eigen::VectorXd a3 = acceleration(u_ + 0.5 * substep_s_ * v2, v3, middle);
    const Eigen::VectorXd v4 = v_ + substep_s_ * a3;
    const Eigen::VectorXd a4 = acceleration(u_ + substep_s_ * v3, v4, ground_to);
    u_ += substep_s_ / 6.0 * (v_ + 2.0 * v2 + 2.0 * v3 + v4);
    v_ += substep_s_ / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
    first_.commit(drift(u_, kFirst));
    second_.commit(drift(u_, kSecond));
  }
  [[nodiscard]] const Eigen::VectorXd& displacement_m() const { return u_; }
  [[nodiscard]] bool has_yielded() const { return first_.has_slipped() && second_.has_slipped(); }

 private:
  static double drift(const Eigen::VectorXd& u, const TestedColumn& column) {
    return u[column.upper] - (column.lower < 0 ? 0.0 : u[column.lower]);
  }
  [[nodiscard]] Eigen::VectorXd acceleration(const Eigen::VectorXd& u, const Eigen::VectorXd& v, double ground) const {
    Eigen::VectorXd force_n = -(rest_ * u);
    for (const auto& [column, law] : {std::pair{kFirst, &first_}, std::pair{kSecond, &second_}}) {
      const double column_n = law->force_n(drift(u, column));
      force_n[column.upper] -= column_n;
      if (column.lower >= 0) force_n[column.lower] += column_n;
    }
    force_n -= stiffness_damping_s_ * (whole_ * v);
    return force_n / kMass_kg - mass_damping_per_s_ * v - Eigen::VectorXd::Constant(kDofs, ground);
  }

  double substep_s_;
  SparseMatrix rest_;
  SparseMatrix whole_;
  double mass_damping_per_s_ = 0.0;
  double stiffness_damping_s_ = 0.0;
  Eigen::VectorXd u_ = Eigen::VectorXd::Zero(kDofs);
  Eigen::VectorXd v_ = Eigen::VectorXd::Zero(kDofs);
  YieldingColumn first_;
  YieldingColumn second_;
};

TEST(MatrixStructure, FrameOfTenThousandEqualsItsMonolithicSolution) {
  const TemporaryDirectory directory;
  const Scenario scenario = read_scenario(write_files(directory.path()), {});
  ASSERT_EQ(scenario.dofs.size(), static_cast<std::size_t>(kDofs));
  const KeptSimulation kept = keep_simulation(scenario, SimulationSettings{});
  ASSERT_EQ(kept.result.coordinator.reason, StopReason::completed);
  const KeptRows& steps = kept.table("coordinator", "steps");

  constexpr int kSubsteps = 2;
  WholeFrame frame{kStep_s / kSubsteps};
  const auto recorded = static_cast<Eigen::Index>(scenario.recorded_dofs.size());
  Eigen::MatrixXd expected_m = Eigen::MatrixXd::Zero(recorded, kSteps + 1);
  const std::vector<double>& ground_m_per_s2 = scenario.excitation.records.front().acceleration_m_per_s2;
  for (int step = 0; step < kSteps; ++step) {
    const double from = ground_m_per_s2[static_cast<std::size_t>(step)];
    const double to = ground_m_per_s2[static_cast<std::size_t>(step) + 1];
    for (int substep = 0; substep < kSubsteps; ++substep) {
      frame.step(from + (to - from) * substep / kSubsteps, from + (to - from) * (substep + 1) / kSubsteps);
    }
    expected_m.col(step + 1) = frame.displacement_m()(scenario.recorded_dofs);
  }
  EXPECT_TRUE(frame.has_yielded()) << "of both sites";

  const std::vector<std::string> names = scenario.recorded_names();
  ASSERT_GE(names.size(), 20U);
  double worst = 0.0;
  for (Eigen::Index i = 0; i < recorded; ++i) {
    const std::vector<double> found_m =
        steps.column_values("displacement_" + names[static_cast<std::size_t>(i)] + "_m");
    ASSERT_EQ(found_m.size(), static_cast<std::size_t>(kSteps) + 1);
    const Eigen::Map<const Eigen::RowVectorXd> found{found_m.data(), kSteps + 1};
    const double peak_m = expected_m.row(i).cwiseAbs().maxCoeff();
    EXPECT_GT(peak_m, 1e-3) << names[static_cast<std::size_t>(i)];
    worst = std::max(worst, (found - expected_m.row(i)).cwiseAbs().maxCoeff() / peak_m);
  }
  RecordProperty("worst_share_of_peak", std::to_string(worst));
  EXPECT_LT(worst, 1e-4) << "measured 0.51e-4";
}

const std::string kTestedStorey =
    "{id: storey_1, kind: experimental, interface: [{dof: floor_1}], initial_stiffness_n_per_m: [[4.0e6]], "
    "rig: {type: simulated, transfer_system: {type: ideal}, "
    "specimen: {type: bilinear, stiffness_n_per_m: 4.0e6, yield_force_n: 40.0e3, hardening_ratio: 0.05}}, "
    "control_rate_hz: 1000, limits: {displacement_m: 0.2, velocity_m_per_s: 1.5, force_n: 150.0e3}}";

/// The two storeys that ship, the second one as a matrix in the coordinator.
class MatrixStorey : public testing::Test {
 protected:
  MatrixStorey() {
    std::ofstream{directory_ / "storey_2.mtx"} << "%%MatrixMarket matrix array real symmetric\n2 2\n3e6\n-3e6\n3e6\n";
  }
  [[nodiscard]] Scenario scenario(std::vector<std::string> more = {}) const {
    more.emplace_back("time.duration_s=4");
    more.push_back("structure.stiffness=" + (directory_ / "storey_2.mtx").string());
    more.push_back("substructures=[" + kTestedStorey + "]");
    return shipped_scenario("two_storey_one_site", more);
  }
  void record(const std::string& run, const Scenario& scenario) const {
    prepare_run_directory(directory_ / run, scenario);
    RecordedSimulation simulation{scenario, directory_ / run, std::size_t{1} << 14U};
    EXPECT_EQ(simulation.run(SimulationSettings{}), StopReason::completed);
  }

  TemporaryDirectory directory_;
};

TEST_F(MatrixStorey, GivesTheMotionOfTheSubstructureInItsPlace) {
  const Scenario as_substructure = shipped_scenario(
      "two_storey_one_site",
      {"time.duration_s=4", "substructures=[" + kTestedStorey +
                                ", {id: storey_2, kind: numerical, interface: [{dof: floor_2, relative_to: floor_1}], "
                                "model: {type: elastic, stiffness_n_per_m: 3.0e6}}]"});
  const Scenario as_matrix = scenario();
  EXPECT_EQ(Eigen::MatrixXd{as_matrix.structure.initial_stiffness_n_per_m},
            Eigen::MatrixXd{as_substructure.structure.initial_stiffness_n_per_m});
  const KeptSimulation one = keep_simulation(as_substructure, SimulationSettings{});
  const KeptSimulation other = keep_simulation(as_matrix, SimulationSettings{});
  for (const char* column : {"displacement_floor_1_m", "displacement_floor_2_m", "restoring_force_floor_2_n"}) {
    const std::vector<double> expected = one.table("coordinator", "steps").column_values(column);
    const std::vector<double> found = other.table("coordinator", "steps").column_values(column);
    ASSERT_EQ(found.size(), 4001U);
    ASSERT_EQ(expected.size(), found.size());
    double peak = 0.0;
    double worst = 0.0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      peak = std::max(peak, std::abs(expected[i]));
      worst = std::max(worst, std::abs(found[i] - expected[i]));
    }
    EXPECT_GT(peak, 1e-3) << column;
    EXPECT_LT(worst, 1e-10 * peak) << column << ": the order of two sums";
  }
}

TEST_F(MatrixStorey, RecomputedCommandsAreBitIdentical) {
  record("run", scenario());
  const Scenario ran = read_scenario(directory_ / "run" / "scenario.yaml", {});
  const StructureRecord record = structure_record(directory_ / "run", ran);
  EXPECT_GT(record.recording.numerical_force_n.norm(), 0.0);
  EXPECT_EQ(recomputed_displacement_m(record.model, record.recording), record.recording.displacement_m);
  EXPECT_EQ(record.recording.modelled_numerical_force_n, record.recording.numerical_force_n);
}

TEST_F(MatrixStorey, DiagnosisNamesItsWrongStiffness) {
  record("run", scenario({"effects=[{interface: numerical_substructure, effect: stiffness_error, "
                          "stiffness_error_ratio: 0.05}]"}));
  const StructureRecord record = structure_record(directory_ / "run", scenario());
  const StructureDiagnosis diagnosis = diagnose_structure(record.model, record.recording);
  ASSERT_EQ(diagnosis.fit.ratios.size(), 1U);
  EXPECT_EQ(diagnosis.fit.ratios.front().effect->number, ModelNumber::stiffness);
  EXPECT_NEAR(diagnosis.fit.ratios.front().value, 0.05, 1e-8);
}

TEST_F(MatrixStorey, PartlyRecordedStructureIsNotRecomputed) {
  const Scenario partly = scenario({"output={degrees_of_freedom: [interfaces]}"});
  record("run", partly);
  EXPECT_EQ(recorded_response(directory_ / "run", partly).displacement_m.rows(), 1);
  EXPECT_THAT([&] { static_cast<void>(structure_record(directory_ / "run", partly)); },
              testing::ThrowsMessage<RecordingError>(testing::HasSubstr("has 1 of 2 degrees of freedom")));
}

}  // namespace
}  // namespace hybridtest
