#include "coordinator/preflight/coupled_loop.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "mechanics/structure/damping.hpp"
#include "tests/support/amplification.hpp"
#include "tests/support/critical_delay.hpp"
#include "tests/support/integration_methods.hpp"
#include "tests/support/spring_answer.hpp"
#include "tests/support/structures.hpp"

namespace hybridtest {
namespace {

CoupledLoop loop_of(const LinearStructure& structure, const VibrationModes& modes,
                    const std::vector<CoupledSite>& sites, const test::IntegrationMethod& method, double step_s) {
  std::vector<InterfaceMap> interfaces;
  std::vector<SiteAnswer> answers;
  for (const CoupledSite& site : sites) {
    interfaces.push_back(site.interface);
    answers.push_back(test::spring_answer(site.stiffness_n_per_m, site.stiffness_n_per_m));
  }
  return {StructureResponse{structure, modes, interfaces, method.make, step_s, method.needs.commands_per_step},
          answers};
}

CoupledLoop loop_of(const LinearStructure& structure, const std::vector<CoupledSite>& sites,
                    const test::IntegrationMethod& method, double step_s) {
  return loop_of(structure, vibration_modes(structure), sites, method, step_s);
}

CoupledSite site_at(const InterfaceMap& interface, double stiffness_n_per_m) {
  CoupledSite site;
  site.id = "site";
  site.interface = interface;
  site.stiffness_n_per_m = test::one_by_one(stiffness_n_per_m);
  return site;
}

LinearStructure damped(LinearStructure structure, double ratio) {
  structure.damping_n_s_per_m =
      rayleigh_damping(structure, rayleigh_coefficients(ratio, 1, 2, vibration_modes(structure)));
  return structure;
}

class EveryIntegrator : public testing::TestWithParam<test::IntegrationMethod> {};
INSTANTIATE_TEST_SUITE_P(All, EveryIntegrator, testing::ValuesIn(test::all_methods()),
                         [](const auto& method) { return method.param.name; });

TEST_P(EveryIntegrator, HasTheRootsOfItsAmplificationMatrix) {
  const test::IntegrationMethod& method = GetParam();
  for (const double omega_dt : {0.05, 0.4, 1.2}) {
    const auto roots = test::amplification_roots(method.make, method.needs.commands_per_step, {.omega_dt = omega_dt});
    const std::complex<double> root = test::principal_root(roots);
    const NumericalMode mode = numerical_mode(method.make, method.needs.commands_per_step, omega_dt);
    EXPECT_NEAR(mode.damping_ratio, -std::log(std::abs(root)) / std::arg(root), 1e-7) << omega_dt;
    EXPECT_NEAR(mode.period_error, method.needs.commands_per_step * omega_dt / std::arg(root) - 1.0, 1e-7) << omega_dt;
  }
}

TEST_P(EveryIntegrator, HasTheCriticalDelayOfTheStructureAtShortSteps) {
  if (GetParam().needs.tries_displacements) return;  // it has no sites
  const LinearStructure structure = damped(test::two_storeys(), 0.03);
  for (const InterfaceMap& interface : {InterfaceMap{2, {{0}}}, InterfaceMap{2, {{1, 0}}}}) {
    const std::vector<CoupledSite> sites{site_at(interface, 2.5e6)};
    const CriticalDelay reference = critical_delay(structure, sites, 0);
    CoupledLoop loop = loop_of(structure, sites, GetParam(), 2e-4);
    EXPECT_EQ(loop.growing_motions({0.0}), 0);
    const CriticalDelay found = loop.critical_delay({true}, 0.5);
    // Numerical damping of the first order in the step is part of some methods.
    EXPECT_NEAR(found.delay_s, reference.delay_s, 0.01 * reference.delay_s);
    EXPECT_NEAR(found.frequency_rad_per_s, reference.frequency_rad_per_s, 0.02 * reference.frequency_rad_per_s);
  }
}

TEST(CoupledLoop, HoldsForSeveralDofsAndSites) {
  const LinearStructure structure = damped(test::shear_building(4, 2.0e4, 4.0e6), 0.03);
  CoupledSite both;
  both.id = "two_actuators";
  both.interface = InterfaceMap{4, {{0}, {1}}};
  both.stiffness_n_per_m.resize(2, 2);
  both.stiffness_n_per_m << 6.0e6, -3.0e6, -3.0e6, 3.5e6;
  const std::vector<CoupledSite> sites{both, site_at(InterfaceMap{4, {{3, 2}}}, 2.0e6)};
  CoupledLoop loop = loop_of(structure, sites, test::explicit_methods()[0], 1e-3);
  std::vector<double> alone_s;
  for (const std::size_t late : {std::size_t{0}, std::size_t{1}}) {
    std::vector<bool> is_late(2, false);
    is_late[late] = true;
    const CriticalDelay reference = critical_delay(structure, sites, late);
    alone_s.push_back(loop.critical_delay(is_late, 0.5).delay_s);
    EXPECT_NEAR(alone_s.back(), reference.delay_s, 2e-3 * reference.delay_s);
  }
  EXPECT_LT(loop.critical_delay({true, true}, 0.5).delay_s, std::min(alone_s[0], alone_s[1])) << "both late at once";
}

TEST(CoupledLoop, HoldsForDampingThatCouplesTheModes) {
  LinearStructure structure = test::two_storeys();
  structure.damping_n_s_per_m = damped(structure, 0.01).damping_n_s_per_m;
  structure.damping_n_s_per_m.coeffRef(1, 1) += 3.0e4;  // a dashpot between the roof and the ground
  const std::vector<CoupledSite> sites{site_at(InterfaceMap{2, {{0}}}, 4.0e6)};
  const CriticalDelay reference = critical_delay(structure, sites, 0);
  CoupledLoop loop = loop_of(structure, sites, test::explicit_methods()[1], 5e-4);
  EXPECT_NEAR(loop.critical_delay({true}, 0.5).delay_s, reference.delay_s, 1e-3 * reference.delay_s);
}

TEST(CoupledLoop, IsZeroWithoutDampingAndInfiniteForSoftSpecimens) {
  const auto critical_s = [](double damping, double stiffness) {
    CoupledLoop loop = loop_of(test::oscillator(3.0, damping, 1200.0), {site_at(InterfaceMap{1, {{0}}}, stiffness)},
                               test::explicit_methods()[0], 1e-3);
    return loop.critical_delay({true}, 1.0).delay_s;
  };
  EXPECT_LT(critical_s(0.0, 600.0), 1e-5);
  EXPECT_TRUE(std::isinf(critical_s(60.0, 60.0)));
}

TEST(CoupledLoop, GrowsBeyondTheExcessThatCrAllows) {
  // omega dt of the excess is 2 where it is 4 N/m.
  const auto growing = [](double excess) {
    const LinearStructure structure = test::oscillator(1.0, 0.0, 1.0);
    CoupledLoop loop{
        StructureResponse{structure, vibration_modes(structure), {InterfaceMap{1, {{0}}}}, test::cr().make, 1.0, 1},
        {test::spring_answer(test::one_by_one(0.0), test::one_by_one(excess))}};
    return loop.growing_motions({0.0});
  };
  EXPECT_EQ(growing(0.0), 0);
  EXPECT_EQ(growing(3.99), 0);
  EXPECT_GT(growing(4.01), 0);
}

TEST(CoupledLoop, StaticDeflectionsStandForTheModesLeftOut) {
  constexpr Eigen::Index kKept = 20;
  const LinearStructure structure = damped(test::shear_building(120, 2.0e4, 4.0e8), 0.02);
  const VibrationModes all = vibration_modes(structure);
  VibrationModes lowest = all;
  lowest.frequency_rad_per_s.conservativeResize(kKept);
  lowest.shapes.conservativeResize(Eigen::NoChange, kKept);
  const std::vector<CoupledSite> sites{site_at(InterfaceMap{120, {{0}}}, 4.0e8)};
  const auto method = test::explicit_methods()[0];
  CoupledLoop whole = loop_of(structure, all, sites, method, 2e-3);
  CoupledLoop reduced = loop_of(structure, lowest, sites, method, 2e-3);
  const double reference_s = whole.critical_delay({true}, 0.5).delay_s;
  EXPECT_NEAR(reduced.critical_delay({true}, 0.5).delay_s, reference_s, 0.02 * reference_s);
}

TEST(CoupledLoop, NoiseMovesTheCommandsAsAnIntegratorDrivenByIt) {
  // Standard deviation of the displacement under white forces: simulated with many steps.
  const LinearStructure structure = test::oscillator(1.0, 0.4, 4.0);
  constexpr double kStep = 0.1;
  CoupledLoop loop = loop_of(structure, {site_at(InterfaceMap{1, {{0}}}, 4.0)}, test::explicit_methods()[0], kStep);
  const auto integrator = test::explicit_methods()[0].make(structure, kStep, {});
  Random random{3};
  double sum = 0.0;
  constexpr int kMany = 400'000;
  for (int step = 0; step < kMany; ++step) {
    const double displacement = integrator->current().displacement_m[0];
    sum += displacement * displacement;
    integrator->advance(Eigen::VectorXd::Constant(1, 4.0 * displacement + random.normal()), Eigen::VectorXd::Zero(1));
  }
  const double simulated = std::sqrt(sum / kMany);
  EXPECT_NEAR(loop.noise_m_per_n(0)[0], simulated, 0.02 * simulated);
}

}  // namespace
}  // namespace hybridtest
