#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <ostream>
#include <string>
#include <utility>

#include "diagnosis/diagnose.hpp"
#include "mechanics/laws/elastomer.hpp"
#include "mechanics/laws/friction_pendulum.hpp"
#include "mechanics/laws/giuffre_menegotto_pinto.hpp"
#include "mechanics/laws/lead_rubber.hpp"
#include "mechanics/laws/mr_damper.hpp"
#include "tests/support/material_path.hpp"
#include "tests/unit/diagnosis/answers.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

/// Isolators and dampers, and steel that hardens, of which the user's model knows nothing but a spring.
namespace hybridtest {
namespace {

struct Device {
  std::string law;
  std::function<std::unique_ptr<Law>()> make;
  std::map<std::string, double> parameters;  // that show in the force
  double tolerance;                          // of each, as a share: some times what the noise leaves
};

void PrintTo(const Device& device, std::ostream* stream) { *stream << device.law; }

class SpecialLaw : public testing::TestWithParam<Device> {};

TEST_P(SpecialLaw, IsNamedWithItsParameters) {
  const std::unique_ptr<Law> real = GetParam().make();
  const Recording recording = made_recording(made_motion_m, [&](double time_s) {
    const double force_n = real->trial(made_motion_m(time_s), made_velocity_m_per_s(time_s));
    real->commit();
    return force_n;
  });
  const Diagnosis diagnosis = diagnosis_of(made_model(), recording);
  EXPECT_EQ(diagnosis.report.verdict, report::Verdict::named);
  ASSERT_FALSE(diagnosis.report.ranking.empty());
  const report::RankedCause& cause = diagnosis.report.ranking.front();
  EXPECT_EQ(std::ranges::count_if(diagnosis.report.ranking, &report::RankedCause::is_cause), 1);
  EXPECT_EQ(cause.law, GetParam().law);
  EXPECT_EQ(cause.lost_stiffness, 0.0) << "it curves, and does not soften";
  for (const auto& [name, value] : GetParam().parameters) {
    const report::ReportedParameter* const parameter = find_parameter(cause, name);
    ASSERT_NE(parameter, nullptr) << name;
    EXPECT_NEAR(parameter->value, value, GetParam().tolerance * value) << name;
  }
}

template <class Part>
Device device(std::string law, typename Part::Parameters parameters, std::map<std::string, double> seen,
              double tolerance) {
  return {std::move(law), [parameters] { return std::make_unique<Part>(parameters); }, std::move(seen), tolerance};
}

INSTANTIATE_TEST_SUITE_P(
    OfADevice, SpecialLaw,
    testing::Values(device<FrictionPendulum>("friction_pendulum",
                                             {.weight_n = 4.0e5,
                                              .radius_m = 1.5,
                                              .friction_coefficient = 0.06,
                                              .slow_friction_ratio = 0.4,
                                              .friction_rate_s_per_m = 40.0,
                                              .presliding_displacement_m = 0.0005},
                                             {{"slow_friction_ratio", 0.4}, {"friction_rate_s_per_m", 40.0}}, 0.02),
                    device<LeadRubber>("lead_rubber",
                                       {.rubber_stiffness_n_per_m = 8.0e5,
                                        .lead_strength_n = 20.0e3,
                                        .yield_displacement_m = 0.003,
                                        .heating_path_m = 1.5},
                                       {{"lead_strength_n", 20.0e3}, {"heating_path_m", 1.5}}, 0.01),
                    device<MrDamper>("mr_damper",
                                     {.damping_n_s_per_m = 4.0e4,
                                      .stiffness_n_per_m = 2.0e4,
                                      .hysteretic_force_n = 8.0e3,
                                      .hysteretic_displacement_m = 0.002},
                                     {{"damping_n_s_per_m", 4.0e4}, {"hysteretic_force_n", 8.0e3}}, 0.01),
                    device<Elastomer>("elastomer",
                                      {.stiffness_n_per_m = 1.0e6,
                                       .stiffening_n_per_m3 = 5.0e8,
                                       .mullins_softening = 0.35,
                                       .mullins_displacement_m = 0.015,
                                       .payne_force_n = 4.0e3,
                                       .payne_displacement_m = 0.002},
                                      {{"mullins_softening", 0.35}, {"payne_force_n", 4.0e3}}, 0.02),
                    device<GiuffreMenegottoPinto>("giuffre_menegotto_pinto",
                                                  {.stiffness_n_per_m = kMadeStiffness_n_per_m,
                                                   .yield_force_n = 16.0e3,
                                                   .hardening_ratio = 0.02,
                                                   .r0 = 18.0,
                                                   .a1 = 0.05,
                                                   .a3 = 0.05},
                                                  {{"yield_force_n", 16.0e3}, {"a1", 0.05}}, 0.02)),
    [](const auto& instance) { return instance.param.law; });

/// A friction pendulum that OpenSees computed: its own equations, integration and tilt of the dish.
TEST(SpecialLawOfOpenSees, IsAFrictionPendulum) {
  Recording recording;
  recording.file = "law_friction_pendulum.csv";
  recording.sample_period_s = 0.0125;
  recording.dofs.resize(1);
  constexpr double kNoise_n = 30.0;  // a thousandth of the force
  Random random{5};
  for (const PathPoint& point : read_material_path("friction_pendulum")) {
    recording.dofs[0].of(Channel::command_displacement).push_back(point.displacement_m);
    recording.dofs[0].of(Channel::measured_displacement).push_back(point.displacement_m);
    recording.dofs[0].of(Channel::measured_force).push_back(point.force_n + kNoise_n * random.normal());
  }
  recording.samples = recording.dofs[0].of(Channel::measured_force).size();
  const Diagnosis diagnosis = diagnosis_of(made_model(), recording);
  EXPECT_TRUE(report::names_a_cause(diagnosis.report.verdict));
  ASSERT_FALSE(diagnosis.report.ranking.empty());
  const report::RankedCause& cause = diagnosis.report.ranking.front();
  EXPECT_EQ(cause.law, "friction_pendulum");
  // As tests/reference/friction_pendulum.tcl has them.
  const std::map<std::string, double> real{
      {"slow_friction_ratio", 0.5}, {"friction_rate_s_per_m", 50.0}, {"presliding_displacement_m", 0.001}};
  for (const auto& [name, value] : real) {
    const report::ReportedParameter* const parameter = find_parameter(cause, name);
    ASSERT_NE(parameter, nullptr) << name;
    ASSERT_TRUE(parameter->ci95.has_value()) << name;
    EXPECT_LT(parameter->ci95->low, value) << name;
    EXPECT_GT(parameter->ci95->high, value) << name;
  }
  // Noise of a thousandth, and few samples in which it slides fast: a hundredth.
  const report::ReportedParameter* const weight_n = find_parameter(cause, "weight_n");
  const report::ReportedParameter* const coefficient = find_parameter(cause, "friction_coefficient");
  ASSERT_TRUE(weight_n != nullptr && coefficient != nullptr);
  EXPECT_NEAR(weight_n->value * coefficient->value, 32.0e3, 320.0);
}

}  // namespace
}  // namespace hybridtest
