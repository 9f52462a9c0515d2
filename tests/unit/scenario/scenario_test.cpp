#include "scenario/scenario.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string_view>

#include "tests/unit/scenario/scenario_file.hpp"

namespace hybridtest {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

class ScenarioTest : public testing::Test {
 protected:
  ScenarioFile file_;
};

TEST_F(ScenarioTest, ReadsAllValues) {
  const Scenario scenario = file_.read();
  EXPECT_EQ(scenario.name, "sound");
  EXPECT_EQ(scenario.time.mode, CouplingMode::lockstep);
  EXPECT_EQ(scenario.time.last_step, 100);
  ASSERT_EQ(scenario.excitation.records.front().acceleration_m_per_s2.size(), 101U);
  EXPECT_DOUBLE_EQ(scenario.excitation.records.front().acceleration_m_per_s2[25], 0.5)
      << "linear between the points of the motion";
  ASSERT_EQ(scenario.substructures.size(), 2U);
  const SubstructureScenario& site = scenario.substructures[0];
  EXPECT_EQ(site.role, Role::experimental_site);
  EXPECT_EQ(site.site.loop.limits.displacement_m, 0.2);
  EXPECT_EQ(site.site.periods_per_step, 2) << "1024 Hz rounded up to whole periods in a step";
  EXPECT_EQ(site.interface.dofs()[0].relative_to, InterfaceDof::kGround);
  const SubstructureScenario& model = scenario.substructures[1];
  EXPECT_EQ(model.role, Role::numerical_substructure);
  EXPECT_EQ(model.interface.dofs()[0].relative_to, 0);
  EXPECT_EQ(scenario.find("storey_2"), &model);
  EXPECT_EQ(scenario.find("storey_3"), nullptr);
  EXPECT_EQ(scenario.index_of(model), 1);
  // K of a shear building of 4 and 3 MN/m.
  const Eigen::MatrixXd stiffness = scenario.structure.initial_stiffness_n_per_m;
  EXPECT_EQ(stiffness, (Eigen::Matrix2d{} << 7.0e6, -3.0e6, -3.0e6, 3.0e6).finished());
}

TEST_F(ScenarioTest, ListsAllErrorsWithTheirPlaces) {
  std::string text = with("name: sound", "name: a/b");
  text = with("step_s: 0.001", "step_s: -0.001", text);
  text = with("ratio: 0.02", "ratoi: 0.02", text);
  text = with("central_difference", "central_diference", text);
  text = with("[{dof: floor_1}]", "[{dof: flor_1}]", text);
  text = with("yield_force_n: 40.0e3", "yield_force_n: soft", text);
  text = with("order: 3", "order: 7", text);
  text = with("force_n: 150.0e3", "force_n: .inf", text);
  text = with("kind: numerical", "kind: numeric", text);
  const std::vector<std::string> errors = file_.errors(text);
  EXPECT_THAT(errors, Contains(AllOf(StartsWith("2:1: name:"), HasSubstr("'a/b'"))));
  EXPECT_THAT(errors, Contains(AllOf(StartsWith("3:32: time.step_s:"), HasSubstr("-0.001 is out of range"))));
  EXPECT_THAT(errors, Contains(AllOf(StartsWith("8:29: structure.damping.ratoi:"), HasSubstr("did you mean 'ratio'"))));
  EXPECT_THAT(errors, Contains(AllOf(HasSubstr("structure.damping.ratio"), HasSubstr("missing"))));
  EXPECT_THAT(errors, Contains(AllOf(StartsWith("9:20: integrator.type:"), HasSubstr("'central_difference'"),
                                     HasSubstr("explicit_newmark"))));
  EXPECT_THAT(errors, Contains(AllOf(StartsWith("13:18:"), HasSubstr("did you mean 'floor_1'"))));
  EXPECT_THAT(errors, Contains(AllOf(StartsWith("18:"), HasSubstr("yield_force_n"), HasSubstr("\"soft\""))));
  EXPECT_THAT(errors, Contains(AllOf(StartsWith("22:"), HasSubstr("force_n"), HasSubstr(".inf"))));
  EXPECT_THAT(errors,
              Contains(AllOf(StartsWith("24:11: substructures[1].kind:"), HasSubstr("did you mean 'numerical'"))));
  for (const std::string& error : errors) EXPECT_TRUE(std::isdigit(error.front())) << "without a place: " << error;
}

TEST_F(ScenarioTest, UnknownTypeListsKnownNames) {
  EXPECT_THAT(file_.errors(with("type: second_order", "type: third_order")),
              Contains(AllOf(StartsWith("17:"), HasSubstr("ideal, delay, first_order, second_order"))));
  EXPECT_THAT(file_.errors(with("type: bilinear", "type: steel02")),
              Contains(HasSubstr("elastic, bilinear, giuffre_menegotto_pinto, bouc_wen")));
  EXPECT_THAT(file_.errors(with("type: polynomial_displacement", "type: smith")),
              Contains(AllOf(HasSubstr("none"), HasSubstr("polynomial_displacement"))));
  EXPECT_THAT(file_.errors(with("model: {type: elastic", "model: {type: frame")),
              Contains(HasSubstr("elastic, springs, shear_building")));
  EXPECT_THAT(file_.errors(with("type: simulated", "type: hardware")), Contains(HasSubstr("choices: simulated")));
  EXPECT_THAT(file_.errors(with("mode: lockstep", "mode: fast")), Contains(HasSubstr("lockstep, paced")));
  EXPECT_THAT(file_.errors(with("hybridtest/1", "hybridtest/2")), Contains(HasSubstr("hybridtest/1")));
}

TEST_F(ScenarioTest, RejectsStepAboveStabilityLimit) {
  const auto errors = file_.errors(with("step_s: 0.001", "step_s: 0.1"));
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_THAT(errors[0], AllOf(StartsWith("3:1: time:"), HasSubstr("T_n/pi"), HasSubstr("shorten the step")));
  // 2/omega of the second mode, omega^2 = (10 + sqrt(52))/2 * 1e6/20e3.
  const double limit_s = 2.0 / std::sqrt((10.0 + std::sqrt(52.0)) / 2.0 * 50.0);
  EXPECT_THAT(file_.errors(with("step_s: 0.001, duration_s: 0.1",
                                "step_s: " + std::to_string(limit_s * 1.001) + ", duration_s: 0.2")),
              Contains(HasSubstr("T_n/pi")));
  EXPECT_THAT(file_.errors(with("step_s: 0.001, duration_s: 0.1",
                                "step_s: " + std::to_string(limit_s * 0.999) + ", duration_s: 0.2"),
                           {"substructures[storey_1].compensator={type: none}"}),
              IsEmpty());
}

TEST_F(ScenarioTest, RejectsDegreeOfFreedomWithoutSubstructure) {
  const auto errors = file_.errors(with("[{dof: floor_2, relative_to: floor_1}]", "[{dof: floor_1}]"));
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_THAT(errors[0], AllOf(StartsWith("10:1: substructures:"), HasSubstr("'floor_2'")));
}

TEST_F(ScenarioTest, RejectsDuplicateSubstructureId) {
  const auto errors = file_.errors(with("id: storey_2", "id: storey_1"));
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_THAT(errors[0], HasSubstr("two substructures with the id 'storey_1'"));
  EXPECT_THAT(file_.errors(with("id: storey_2", "id: coordinator")), ElementsAre(HasSubstr("'coordinator' is taken")));
}

/// One storey after the other, all numerical.
std::string storeys(int count) {
  std::string names;
  std::string mass;
  std::string parts;
  for (int i = 1; i <= count; ++i) {
    const std::string_view comma = i == 1 ? "" : ", ";
    const std::string below = i == 1 ? "" : fmt::format(", relative_to: floor_{}", i - 1);
    names += fmt::format("{}floor_{}", comma, i);
    mass += fmt::format("{}floor_{}: 1.0", comma, i);
    parts += fmt::format(
        "  - {{id: storey_{0}, kind: numerical, interface: [{{dof: floor_{0}{1}}}], "
        "model: {{type: elastic, stiffness_n_per_m: 1.0}}}}\n",
        i, below);
  }
  return "schema: hybridtest/1\nname: storeys\ntime: {mode: lockstep, step_s: 0.001, duration_s: 0.1}\n"
         "excitation: {ground_motion: motion.txt}\nstructure:\n  degrees_of_freedom: [" +
         names + "]\n  mass_kg: {" + mass +
         "}\n  damping: {type: none}\nintegrator: {type: central_difference}\nsubstructures:\n" + parts;
}

TEST_F(ScenarioTest, TakesUpTo1000Substructures) {
  EXPECT_EQ(file_.read(storeys(1000)).substructures.size(), 1000U);
  EXPECT_THAT(file_.errors(storeys(1001)),
              ElementsAre(HasSubstr("1001 substructures; expected 1 to 32, or under simulated time alone up to 1000")));
}

TEST_F(ScenarioTest, RecordsInterfacesOfFewSubstructuresAlways) {
  EXPECT_EQ(file_.read(storeys(32)).recorded_dofs.size(), 32U);
  EXPECT_EQ(file_.read(storeys(32) + "output: {degrees_of_freedom: [floor_1]}\n").recorded_dofs.size(), 32U);
  EXPECT_EQ(file_.read(storeys(33) + "output: {degrees_of_freedom: [floor_1]}\n").recorded_dofs.size(), 1U);
  EXPECT_EQ(file_.read(storeys(120)).recorded_dofs.size(), 20U);
  EXPECT_EQ(file_.read(storeys(120) + "output: {degrees_of_freedom: [interfaces]}\n").recorded_dofs.size(), 120U);
}

TEST_F(ScenarioTest, RejectsDuplicateAndSelfRelativeInterfaces) {
  EXPECT_THAT(file_.errors(with("[{dof: floor_2, relative_to: floor_1}]", "[{dof: floor_2}, {dof: floor_2}]")),
              Contains(HasSubstr("listed twice")));
  EXPECT_THAT(file_.errors(with("relative_to: floor_1", "relative_to: floor_2")),
              Contains(HasSubstr("relative to itself, expected another one")));
}

TEST_F(ScenarioTest, RejectsNamesTooLongForARecording) {
  const auto renamed = [](const std::string& name) {
    std::string text = kScenarioText;
    for (std::size_t at = text.find("floor_2"); at != std::string::npos; at = text.find("floor_2", at + name.size())) {
      text.replace(at, 7, name);
    }
    return text;
  };
  EXPECT_THAT(file_.errors(renamed(std::string(28, 'f'))), IsEmpty());  // f..f_relative_to_floor_1 has 48
  EXPECT_THAT(file_.errors(renamed(std::string(29, 'f'))), Contains(HasSubstr("expected at most 48 letters")));
  EXPECT_THAT(file_.errors(renamed(std::string(42, 'f'))), Contains(HasSubstr("expected at most 41 in a recording")));
}

TEST_F(ScenarioTest, RejectsMatricesOfWrongSize) {
  EXPECT_THAT(file_.errors(with("[[4.0e6]]", "[[4.0e6, 0.0], [0.0, 4.0e6]]")),
              Contains(AllOf(StartsWith("14:"), HasSubstr("expected"))));
  EXPECT_THAT(file_.errors(with("mass_kg: {floor_1: 20.0e3, floor_2: 20.0e3}", "mass_matrix_kg: [[20.0e3]]")),
              Contains(AllOf(StartsWith("7:"), HasSubstr("mass_matrix_kg"))));
  EXPECT_THAT(file_.errors(with("floor_2: 20.0e3}", "floor_3: 20.0e3}")),
              Contains(AllOf(StartsWith("7:"), HasSubstr("floor_3"))));
  EXPECT_THAT(file_.errors(with("modes: [1, 2]", "modes: [1, 3]")), Contains(HasSubstr("from 1 to 2")));
}

TEST_F(ScenarioTest, RejectsNonPositiveMass) {
  EXPECT_THAT(file_.errors(with("floor_2: 20.0e3}", "floor_2: 0.0}")), Contains(StartsWith("7:")));
  EXPECT_THAT(file_.errors(with("mass_kg: {floor_1: 20.0e3, floor_2: 20.0e3}",
                                "mass_matrix_kg: [[20.0e3, 30.0e3], [30.0e3, 20.0e3]]")),
              Contains(HasSubstr("mass")));
}

TEST_F(ScenarioTest, RejectsDelayBeyondTheCompensator) {
  EXPECT_THAT(file_.errors(with("delay_s: 0.023", "delay_s: -0.001")), Contains(StartsWith("21:")));
  // More than eight point spacings ahead.
  EXPECT_THAT(file_.errors(with("delay_s: 0.023}", "delay_s: 0.023, point_spacing_s: 0.002}")), Not(IsEmpty()));
}

TEST_F(ScenarioTest, RejectsCommandAgeBelowTheStep) {
  const auto errors =
      file_.errors(with("mode: lockstep, step_s: 0.001", "mode: paced, time_scale: 1500.0, step_s: 0.001"));
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_THAT(errors[0], AllOf(StartsWith("22:"), HasSubstr("command_age_s"), HasSubstr("1.5 s")));
  EXPECT_THAT(file_.errors(with("mode: lockstep, step_s: 0.001", "mode: paced, time_scale: 500.0, step_s: 0.001")),
              IsEmpty());
}

TEST_F(ScenarioTest, RejectsMissingOrInvalidGroundMotion) {
  EXPECT_THAT(file_.errors(with("motion.txt", "moton.txt")), Contains(AllOf(StartsWith("4:"), HasSubstr("moton.txt"))));
  std::ofstream{file_.directory() / "broken.txt"} << "time_s acceleration_m_per_s2\n0.0 0.0\n0.05 loud\n";
  EXPECT_THAT(file_.errors(with("motion.txt", "broken.txt")), Contains(AllOf(StartsWith("4:"), HasSubstr("loud"))));
}

TEST_F(ScenarioTest, ReportsUnknownDuplicateAndMissingKeys) {
  EXPECT_THAT(file_.errors(with("name: sound", "name: sound\nnmae: sound")), Contains(StartsWith("3:1: nmae:")));
  EXPECT_THAT(file_.errors(with("name: sound", "name: sound\nname: again")), Contains(StartsWith("3:")));
  EXPECT_THAT(file_.errors(with("integrator: {type: central_difference}\n", "")), Contains(HasSubstr("integrator")));
}

TEST_F(ScenarioTest, EffectiveScenarioKeepsTheDigest) {
  const Scenario first = file_.read();
  EXPECT_THAT(first.effective,
              AllOf(HasSubstr("command_age_s"), HasSubstr("liveliness_lease_s"), HasSubstr("on_failure")))
      << "defaults are filled in";
  const Scenario again = file_.read(first.effective);
  EXPECT_EQ(again.effective, first.effective);
  EXPECT_EQ(again.digest, first.digest);
}

TEST_F(ScenarioTest, SiteWaitsForALinkAsLongAsTheTest) {
  const auto overdue = [&](const std::vector<std::string>& overrides) {
    const Scenario scenario = file_.read(kScenarioText, overrides);
    const LoopScenario& loop = scenario.find("storey_1")->site.loop;
    return std::pair{loop.limits.command_age_s,
                     loop.rules[static_cast<std::size_t>(InterlockKind::command_age)].clears};
  };
  EXPECT_EQ(overdue({"time.mode=paced"}), std::pair(1.0, ClearCondition::never));
  EXPECT_EQ(overdue({"time.mode=paced", "timeouts={link_s: 60.0}"}), std::pair(1.0, ClearCondition::when_cleared));
  EXPECT_EQ(overdue({"time.mode=lockstep", "timeouts={link_s: 60.0}"}), std::pair(60.0, ClearCondition::never));
  EXPECT_THAT(file_.errors(kScenarioText, {"time.mode=real_time", "timeouts={link_s: 60.0}"}),
              Contains(HasSubstr("in real time the test does not wait for a link")));
}

TEST_F(ScenarioTest, RefusesTrialsOfASpecimen) {
  EXPECT_THAT(
      file_.errors(kScenarioText, {"integrator={type: implicit_newmark}"}),
      Contains(AllOf(HasSubstr("the specimen of 'storey_1' cannot go back"), HasSubstr("alpha_operator_splitting"))));
}

TEST_F(ScenarioTest, ShippedScenariosKeepTheirDigest) {
  const std::filesystem::path directory = std::filesystem::path{HYBRIDTEST_SOURCE_DIR} / "launch" / "scenarios";
  const std::vector<std::string> motion{"excitation.ground_motion=" + (file_.directory() / "motion.txt").string(),
                                        "time.duration_s=0.1"};
  for (const char* name :
       {"two_storey_one_site", "two_storey_two_sites", "three_storey_base_isolated", "isolated_with_dampers"}) {
    const Scenario shipped = read_scenario(directory / (std::string{name} + ".yaml"), motion);
    EXPECT_EQ(file_.read(shipped.effective).digest, shipped.digest) << name;
  }
}

TEST_F(ScenarioTest, DigestDependsOnContentNotOnFormatting) {
  const ScenarioDigest digest = file_.read().digest;
  EXPECT_EQ(file_.read(with("name: sound", "# a comment\nname: \"sound\"  # another")).digest, digest);
  EXPECT_EQ(file_.read(with("20.0e3, floor_2: 20.0e3", "20000, floor_2: 2.0e+4")).digest, digest);
  EXPECT_EQ(file_
                .read(with("{mode: lockstep, step_s: 0.001, duration_s: 0.1}",
                           "{duration_s: 0.1, step_s: 0.001, mode: lockstep}"))
                .digest,
            digest);
  EXPECT_EQ(file_
                .read(with("integrator: {type: central_difference}\n", "",
                           with("name: sound", "name: sound\nintegrator:\n  type: central_difference")))
                .digest,
            digest);
  EXPECT_EQ(file_.read(with("force_n: 150.0e3}", "force_n: 150.0e3, command_age_s: 1.0}")).digest, digest)
      << "a default that is written out";
}

TEST_F(ScenarioTest, DigestChangesWithEveryValue) {
  std::set<ScenarioDigest> digests{file_.read().digest};
  const std::vector<std::string> changes{
      "name=other",
      "time.mode=paced",
      "time.step_s=0.0005",
      "time.duration_s=0.09",
      "excitation.scale=1.0000000000000002",
      "excitation.unit=m_per_s2",
      "structure.mass_kg.floor_1=20.001e3",
      "structure.damping.ratio=0.021",
      "structure.damping.modes=[2, 1]",
      "integrator.type=explicit_newmark",
      "substructures[storey_1].id=storey_one",
      "substructures[storey_1].initial_stiffness_n_per_m=[[4.1e6]]",
      "substructures[storey_1].rig.transfer_system.natural_frequency_hz=15.5",
      "substructures[storey_1].rig.transfer_system.damping_ratio=0.8",
      "substructures[storey_1].rig.transfer_system.delay_s=0.005",
      "substructures[storey_1].rig.specimen.stiffness_n_per_m=4.1e6",
      "substructures[storey_1].rig.specimen.yield_force_n=41.0e3",
      "substructures[storey_1].rig.specimen.hardening_ratio=0.06",
      "substructures[storey_1].rig.sensors.displacement_noise_m=2.0e-5",
      "substructures[storey_1].rig.sensors.force_noise_n=51.0",
      "substructures[storey_1].rig.sensors.seed=8",
      "substructures[storey_1].rig.sensors={displacement_noise_m: 1.0e-5, force_noise_n: 50.0, seed: 7, "
      "force_coloured_noise_n: 20.0, force_correlation_time_s: 0.01}",
      "substructures[storey_1].rig.sensors={displacement_noise_m: 1.0e-5, force_noise_n: 50.0, seed: 7, "
      "force_coloured_noise_n: 20.0, force_correlation_time_s: 0.02}",
      "substructures[storey_1].rig.sensors={displacement_noise_m: 1.0e-5, force_noise_n: 50.0, seed: 7, "
      "displacement_coloured_noise_m: 1.0e-6, displacement_correlation_time_s: 0.02}",
      "substructures[storey_1].control_rate_hz=1025",
      "substructures[storey_1].compensator.order=2",
      "substructures[storey_1].compensator.delay_s=0.024",
      "substructures[storey_1].limits.displacement_m=0.21",
      "substructures[storey_1].limits.velocity_m_per_s=1.6",
      "substructures[storey_1].limits.force_n=151.0e3",
      "substructures[storey_1].limits.command_age_s=1.5",
      "substructures[storey_1].limits.energy_error_ratio=2.0",
      "substructures[storey_1].limits.tracking_error_m=0.05",
      "substructures[storey_1].return_time_s=3.0",
      "substructures[storey_2].interface[0]={dof: floor_2}",
      "substructures[storey_2].model.stiffness_n_per_m=3.1e6",
      "timeouts={discovery_s: 31.0}",
      "timeouts={arm_s: 11.0}",
      "timeouts={stop_s: 11.0}",
      "timeouts={liveliness_lease_s: 3.0}",
      "timeouts={link_s: 60.0}",
      "timeouts={resume_s: 5.0, liveliness_lease_s: 0.5}",
      "recording={on_failure: continue}",
  };
  for (const std::string& change : changes) {
    EXPECT_TRUE(digests.insert(file_.read(kScenarioText, {change}).digest).second) << change;
  }
}

TEST_F(ScenarioTest, SitesThatWaitNeedALongerCommandAge) {
  const std::string waits = "timeouts={resume_s: 60.0}";
  EXPECT_THAT(file_.errors(kScenarioText, {waits, "substructures[storey_1].limits.command_age_s=2.0"}),
              Contains(HasSubstr("limits.command_age_s longer than timeouts.liveliness_lease_s")));
  const Scenario scenario = file_.read(kScenarioText, {waits, "substructures[storey_1].limits.command_age_s=2.1"});
  EXPECT_EQ(scenario.timeouts.resume, std::chrono::seconds{60});
  EXPECT_EQ(file_.read().timeouts.resume, Duration::zero());
}

TEST_F(ScenarioTest, RealTimeTestCannotWaitForACoordinator) {
  EXPECT_THAT(file_.errors(kScenarioText, {"timeouts={resume_s: 60.0}", "time.mode=real_time"}),
              Contains(HasSubstr("a test in real time cannot wait for a coordinator")));
}

TEST_F(ScenarioTest, GroundMotionIsToldAsScaled) {
  const GroundMotionFacts motion =
      file_.read(kScenarioText, {"excitation.scale=-2.0"}).excitation.records.front().facts;
  EXPECT_EQ(motion.peak_m_per_s2, 2.0);
  EXPECT_EQ(motion.points, 3);
  EXPECT_DOUBLE_EQ(motion.duration_s, 0.1);
}

TEST_F(ScenarioTest, LastOverrideWins) {
  const Scenario scenario =
      file_.read(kScenarioText, {"substructures[storey_1].limits.force_n=1.0e3", "substructures[1].id=upper",
                                 "substructures[storey_1].limits.force_n=2.0e3"});
  EXPECT_EQ(scenario.substructures[0].site.loop.limits.force_n, 2.0e3);
  EXPECT_EQ(scenario.substructures[1].id, "upper");
  EXPECT_EQ(file_.read(scenario.effective).digest, scenario.digest);
}

TEST_F(ScenarioTest, ReportsUnknownOverridesWithNearestName) {
  const auto errors =
      file_.errors(kScenarioText, {"time.step=0.002", "substructures[storey_3].id=x", "tim.step_s=1.0"});
  ASSERT_EQ(errors.size(), 3U);
  EXPECT_THAT(errors, Contains(AllOf(StartsWith("--set time.step:"), HasSubstr("step_s"))));
  EXPECT_THAT(errors, Contains(AllOf(StartsWith("--set substructures[storey_3].id:"), HasSubstr("storey_1"))));
  EXPECT_THAT(errors, Contains(AllOf(StartsWith("--set tim.step_s:"), HasSubstr("time"))));
}

TEST_F(ScenarioTest, LawAloneIsAModelForOneDof) {
  const std::string bilinear =
      "model: {type: bilinear, stiffness_n_per_m: 3.0e6, yield_force_n: 1.0e4, hardening_ratio: 0.1}";
  const std::string model = "model: {type: elastic, stiffness_n_per_m: 3.0e6}";
  const Scenario scenario = file_.read(with(model, bilinear));
  EXPECT_EQ(scenario.substructures[1].make_model()->initial_stiffness_n_per_m()(0, 0), 3.0e6);
  const std::string two = with("[{dof: floor_2, relative_to: floor_1}]", "[{dof: floor_1}, {dof: floor_2}]");
  EXPECT_THAT(file_.errors(with(model, bilinear, two)),
              Contains(HasSubstr("one for each interface degree of freedom")));
}

TEST_F(ScenarioTest, FactoriesMakeIndependentParts) {
  const Scenario scenario = file_.read();
  const SubstructureScenario& site = scenario.substructures[0];
  EXPECT_NE(site.make_rig(0.0005).get(), site.make_rig(0.0005).get());
  EXPECT_NE(scenario.make_integrator().get(), scenario.make_integrator().get());
}

}  // namespace
}  // namespace hybridtest
