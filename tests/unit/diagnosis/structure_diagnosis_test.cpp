#include "diagnosis/structure/structure_diagnosis.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "coordinator/integrators/central_difference.hpp"

namespace hybridtest {
namespace {

using report::Verdict;

constexpr double kStep_s = 0.005;
constexpr Eigen::Index kSteps = 2000;
constexpr double kStorey_n_per_m = 3e6;

/// Two storeys, the upper one numerical.
ComputedStructure two_storeys() {
  ComputedStructure model;
  const Eigen::Matrix2d mass{{20e3, 0.0}, {0.0, 15e3}};
  const Eigen::Matrix2d damping{{8e3, -3e3}, {-3e3, 3e3}};
  model.structure.degrees_of_freedom = {"floor_1", "floor_2"};
  model.structure.mass_kg = mass.sparseView();
  model.structure.damping_n_s_per_m = damping.sparseView();
  model.structure.initial_stiffness_n_per_m =
      Eigen::Matrix2d{{2 * kStorey_n_per_m, -kStorey_n_per_m}, {-kStorey_n_per_m, kStorey_n_per_m}}.sparseView();
  model.structure.influence = Eigen::Vector2d::Ones();
  model.influence = model.structure.influence;
  model.step_s = kStep_s;
  model.make_integrator = [](const LinearStructure& structure, double step_s) -> std::unique_ptr<Integrator> {
    return std::make_unique<CentralDifference>(structure, step_s);
  };
  return model;
}

/// A test of that structure with errors: what it received and commanded, the lower storey yielding a little.
StructureRecording tested(const StructureErrors& errors, double second_mass_factor = 1.0) {
  const ComputedStructure model = two_storeys();
  LinearStructure structure = model.structure;
  structure.mass_kg *= 1.0 + errors.mass;
  structure.mass_kg.coeffRef(1, 1) *= second_mass_factor;
  structure.damping_n_s_per_m *= 1.0 + errors.damping;
  CentralDifference integrator{structure, kStep_s * (1.0 + errors.step)};
  StructureRecording recording;
  recording.step_s = kStep_s;
  recording.ground_m_per_s2.resize(1, kSteps);
  for (Eigen::MatrixXd* signal : {&recording.displacement_m, &recording.restoring_force_n, &recording.numerical_force_n,
                                  &recording.modelled_numerical_force_n}) {
    signal->resize(2, kSteps);
  }
  for (Eigen::Index i = 0; i < kSteps; ++i) {
    const double time_s = static_cast<double>(i) * kStep_s;
    recording.ground_m_per_s2(0, i) =
        std::sin(2.0 * std::numbers::pi * 1.1 * time_s) + 0.7 * std::sin(2.0 * std::numbers::pi * 2.9 * time_s);
    const Eigen::Vector2d u_m = integrator.current().displacement_m;
    const double numerical_n = kStorey_n_per_m * (u_m[1] - u_m[0]);
    const double specimen_n = kStorey_n_per_m * u_m[0] / std::sqrt(1.0 + std::pow(u_m[0] / 0.01, 2));
    recording.displacement_m.col(i) = u_m;
    recording.modelled_numerical_force_n.col(i) = Eigen::Vector2d{-numerical_n, numerical_n};
    recording.numerical_force_n.col(i) = (1.0 + errors.stiffness) * recording.modelled_numerical_force_n.col(i);
    recording.restoring_force_n.col(i) = recording.numerical_force_n.col(i) + Eigen::Vector2d{specimen_n, 0.0};
    integrator.advance(recording.restoring_force_n.col(i),
                       structure.load_per_ground_acceleration_kg() * recording.ground_m_per_s2(0, i));
  }
  return recording;
}

/// Rounding of 2000 steps, integrated twice, is 1e-11 of the displacement at most; a ratio changes that by a
/// hundredth of itself at least (damping), an error in it counts a hundredfold.
constexpr double kRatioError = 1e-9;

double value_of(const StructureDiagnosis& diagnosis, std::string_view effect) {
  for (const FittedRatio& ratio : diagnosis.fit.ratios) {
    if (ratio.effect->type().name == effect) return ratio.value;
  }
  return std::nan("");
}

TEST(StructureDiagnosis, RecomputedCommandsAreBitIdentical) {
  const StructureRecording recording = tested({});
  EXPECT_EQ(recomputed_displacement_m(two_storeys(), recording), recording.displacement_m);
  const StructureDiagnosis diagnosis = diagnose_structure(two_storeys(), recording);
  EXPECT_EQ(diagnosis.verdict, Verdict::none);
  EXPECT_EQ(diagnosis.nrmse, 0.0);
  EXPECT_TRUE(diagnosis.fit.ratios.empty());
}

class WrongNumber : public testing::TestWithParam<std::size_t> {};

TEST_P(WrongNumber, IsNamedWithItsValue) {
  const StructureEffect& effect = kStructureEffects[GetParam()];
  for (const double ratio : {0.05, -0.2}) {
    StructureErrors errors;
    errors.*(effect.ratio) = ratio;
    const StructureDiagnosis diagnosis = diagnose_structure(two_storeys(), tested(errors));
    EXPECT_EQ(diagnosis.verdict, Verdict::named) << effect.type().name;
    ASSERT_EQ(diagnosis.fit.ratios.size(), 1U) << effect.type().name;
    EXPECT_NEAR(value_of(diagnosis, effect.type().name), ratio, kRatioError);
    EXPECT_LT(diagnosis.fit.nrmse, 1.15 * diagnosis.floor_nrmse);
  }
}

INSTANTIATE_TEST_SUITE_P(Each, WrongNumber, testing::Range<std::size_t>(0, kStructureEffects.size()));

TEST(StructureDiagnosis, FindsTwoWrongNumbersTogether) {
  const StructureDiagnosis diagnosis = diagnose_structure(two_storeys(), tested({.mass = 0.05, .damping = 0.5}));
  EXPECT_EQ(diagnosis.verdict, Verdict::named);
  ASSERT_EQ(diagnosis.fit.ratios.size(), 2U);
  EXPECT_NEAR(value_of(diagnosis, "mass_error"), 0.05, kRatioError);
  EXPECT_NEAR(value_of(diagnosis, "damping_error"), 0.5, kRatioError);
  EXPECT_NEAR(diagnosis.shares[0] + diagnosis.shares[1], 1.0, 1e-12);
}

TEST(StructureDiagnosis, WrongMassOnOneFloorIsNotACommonRatio) {
  const StructureDiagnosis diagnosis = diagnose_structure(two_storeys(), tested({}, 1.4));
  EXPECT_EQ(diagnosis.verdict, Verdict::unknown);
  EXPECT_TRUE(diagnosis.fit.ratios.empty());
}

TEST(StructureDiagnosis, SkipsStiffnessWithoutNumericalRecords) {
  StructureRecording recording = tested({.stiffness = 0.1});
  EXPECT_EQ(diagnose_structure(two_storeys(), recording).verdict, Verdict::named) << "with them it is found";
  recording.numerical_force_n.resize(2, 0);
  recording.modelled_numerical_force_n.resize(2, 0);
  EXPECT_EQ(diagnose_structure(two_storeys(), recording).verdict, Verdict::none) << "forces as received agree";
}

Diagnosis of_site(Verdict verdict) {
  Diagnosis diagnosis;
  diagnosis.report.verdict = verdict;
  report::InterfaceGap specimen{.interface = "specimen"};
  specimen.is_judged = true;
  specimen.share = 1.0;
  specimen.share_ci95 = {0.9, 1.0};
  specimen.nrmse = verdict == Verdict::none ? 0.01 : 0.2;
  specimen.floor_nrmse = 0.01;
  diagnosis.report.where = {specimen};
  report::RankedCause friction{.interface = "specimen", .effect = "coulomb_friction"};
  friction.is_cause = verdict == Verdict::named || verdict == Verdict::partial;
  friction.share = friction.is_cause ? 1.0 : 0.0;
  diagnosis.report.ranking = {friction};
  return diagnosis;
}

TEST(StructureDiagnosis, IsMergedIntoTheSiteVerdict) {
  const StructureDiagnosis wrong_mass = diagnose_structure(two_storeys(), tested({.mass = 0.05}));
  const StructureDiagnosis right = diagnose_structure(two_storeys(), tested({}));
  const StructureDiagnosis strange{
      .nrmse = 0.5, .floor_nrmse = 1e-11, .verdict = Verdict::unknown, .fit = {}, .shares = {}};
  const auto together = [](Verdict site, const StructureDiagnosis& structure) {
    Diagnosis diagnosis = of_site(site);
    add_structure(structure, diagnosis);
    return diagnosis.report.verdict;
  };
  for (const Verdict site : {Verdict::none, Verdict::named, Verdict::set, Verdict::partial, Verdict::unknown}) {
    EXPECT_EQ(together(site, right), site);
  }
  EXPECT_EQ(together(Verdict::none, wrong_mass), Verdict::named);
  EXPECT_EQ(together(Verdict::not_excited, wrong_mass), Verdict::named);
  EXPECT_EQ(together(Verdict::named, wrong_mass), Verdict::named);
  EXPECT_EQ(together(Verdict::set, wrong_mass), Verdict::set);
  EXPECT_EQ(together(Verdict::unknown, wrong_mass), Verdict::partial);
  EXPECT_EQ(together(Verdict::none, strange), Verdict::unknown);
  EXPECT_EQ(together(Verdict::named, strange), Verdict::partial);
  EXPECT_EQ(together(Verdict::unknown, strange), Verdict::unknown);
}

TEST(StructureDiagnosis, DividesTheGapWithTheSite) {
  Diagnosis diagnosis = of_site(Verdict::named);
  add_structure(diagnose_structure(two_storeys(), tested({.mass = 0.05})), diagnosis);
  const report::DiagnosisReport& report = diagnosis.report;
  ASSERT_EQ(report.where.size(), 2U);
  EXPECT_NEAR(report.where[0].share + report.where[1].share, 1.0, 1e-12);
  ASSERT_EQ(report.ranking.size(), 2U);
  EXPECT_NEAR(report.ranking[0].share + report.ranking[1].share, 1.0, 1e-12);
  EXPECT_TRUE(diagnosis.causes.empty()) << "effects of the structure are not the site's";
}

TEST(StructureDiagnosis, CorrectStructureIsCleanWithoutShare) {
  Diagnosis diagnosis = of_site(Verdict::named);
  add_structure(diagnose_structure(two_storeys(), tested({})), diagnosis);
  ASSERT_EQ(diagnosis.report.where.size(), 2U);
  EXPECT_EQ(diagnosis.report.where[0].share, 1.0);
  EXPECT_EQ(diagnosis.report.where[1].interface, "numerical_substructure");
  EXPECT_TRUE(diagnosis.report.where[1].is_judged);
  EXPECT_FALSE(diagnosis.report.where[1].is_at_fault);
  EXPECT_THAT(diagnosis.report.notes, testing::Contains(testing::HasSubstr("bit for bit")));
}

}  // namespace
}  // namespace hybridtest
