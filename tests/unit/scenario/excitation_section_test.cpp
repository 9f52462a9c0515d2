#include "scenario/excitation_section.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "coordinator/excitation/response_spectrum.hpp"
#include "scenario/scenario.hpp"
#include "tests/unit/scenario/scenario_file.hpp"

namespace hybridtest {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class ExcitationSection : public testing::Test {
 protected:
  ExcitationSection() {
    std::ofstream{file_.directory() / "other.txt"} << "time_s acceleration_m_per_s2\n0.0 0.5\n0.04 -2.0\n0.08 0.25\n";
    std::ofstream{file_.directory() / "forces.csv"} << "time_s,floor_2_n,floor_1_kn\n0,0,1\n0.05,100,2\n0.1,0,1\n";
    std::ofstream{file_.directory() / "force.csv"} << "time_s,actuator_n\n0,1\n0.1,1\n";
    std::ofstream{file_.directory() / "flat.txt"} << "time_s acceleration_m_per_s2\n0.0 0.0\n0.1 0.0\n";
  }

  /// The sound scenario with another section.
  [[nodiscard]] static std::string text(const std::string& excitation) {
    return with("excitation: {ground_motion: motion.txt, scale: 1.0}", "excitation: " + excitation);
  }
  [[nodiscard]] Scenario read(const std::string& excitation) const { return file_.read(text(excitation)); }
  [[nodiscard]] std::vector<std::string> errors(const std::string& excitation) const {
    return file_.errors(text(excitation));
  }

  ScenarioFile file_;
};

TEST_F(ExcitationSection, ShortFormIsAListOfOne) {
  const Scenario one = read("{ground_motion: motion.txt, scale: 1.5}");
  const Scenario listed = read("{records: [{ground_motion: motion.txt, scale: 1.5}]}");
  ASSERT_EQ(listed.excitation.records.size(), 1U);
  EXPECT_EQ(listed.excitation.records[0].acceleration_m_per_s2, one.excitation.records[0].acceleration_m_per_s2);
  EXPECT_EQ(listed.excitation.records[0].influence, one.excitation.records[0].influence);
}

TEST_F(ExcitationSection, ShortFormKeepsItsEffectiveText) {
  EXPECT_THAT(file_.read().effective, HasSubstr("excitation:\n  ground_motion: motion.txt\n  scale: 1\nstructure:"));
}

TEST_F(ExcitationSection, SeveralRecordsMoveWhatTheirInfluenceSays) {
  const Scenario scenario = read(
      "{records: [{ground_motion: motion.txt, influence: {floor_1: 1.0}}, "
      "{ground_motion: other.txt, influence: {floor_2: 0.5}, start_s: 0.02}]}");
  const auto& records = scenario.excitation.records;
  ASSERT_EQ(records.size(), 2U);
  EXPECT_EQ(records[0].influence, Eigen::Vector2d(1.0, 0.0));
  EXPECT_EQ(records[1].influence, Eigen::Vector2d(0.0, 0.5));
  EXPECT_EQ(scenario.structure.influence, records[0].influence) << "participation of the modes: that of the first";
  EXPECT_EQ(records[1].acceleration_m_per_s2[19], 0.0) << "has not begun";
  EXPECT_EQ(records[1].acceleration_m_per_s2[20], 0.5);
  EXPECT_NEAR(records[1].acceleration_m_per_s2[60], -2.0, 1e-12);
  Eigen::VectorXd force_n(2);
  scenario.excitation.load(scenario.structure).ground_at(60, force_n);
  EXPECT_NEAR(force_n[0], -20e3 * records[0].acceleration_m_per_s2[60], 1e-9);
  EXPECT_NEAR(force_n[1], 20e3 * 0.5 * 2.0, 1e-9);
}

TEST_F(ExcitationSection, ScalesToAPeak) {
  const Scenario scenario = read("{ground_motion: other.txt, scale_to: {peak_g: 0.35}}");
  const GroundRecord& record = scenario.excitation.records[0];
  EXPECT_NEAR(record.facts.peak_m_per_s2, 0.35 * kStandardGravity_m_per_s2, 1e-12);
  EXPECT_NEAR(record.factor_found.value_or(0.0), 0.35 * kStandardGravity_m_per_s2 / 2.0, 1e-12);
}

TEST_F(ExcitationSection, ScalesToASpectrumOrdinate) {
  const Scenario plain = read("{ground_motion: other.txt}");
  const Scenario scenario =
      read("{ground_motion: other.txt, scale_to: {spectral_acceleration_g: 0.8, period_s: 0.6, damping_ratio: 0.02}}");
  // The record as the file has it; the applied one stands at the steps of the test.
  GroundMotion motion{.dt_s = 0.04, .start_s = 0.0, .acceleration_m_per_s2 = {0.5, -2.0, 0.25}};
  const double factor = scenario.excitation.records[0].factor_found.value_or(0.0);
  motion.multiply(factor);
  EXPECT_NEAR(spectrum_ordinate(motion, 0.6, 0.02).pseudo_acceleration_m_per_s2, 0.8 * kStandardGravity_m_per_s2,
              1e-12);
  EXPECT_NEAR(scenario.excitation.records[0].facts.peak_m_per_s2,
              factor * plain.excitation.records[0].facts.peak_m_per_s2, 1e-12);
}

TEST_F(ExcitationSection, TheFactorFoundStandsInTheEffectiveScenario) {
  const Scenario scenario = read("{ground_motion: other.txt, scale_to: {peak_g: 0.35}}");
  EXPECT_THAT(scenario.effective, HasSubstr("factor: 1.71616"));
  const Scenario again = file_.read(scenario.effective);
  EXPECT_EQ(again.effective, scenario.effective);
  EXPECT_EQ(again.excitation.records[0].acceleration_m_per_s2, scenario.excitation.records[0].acceleration_m_per_s2);
  EXPECT_THAT(errors("{ground_motion: other.txt, scale_to: {peak_g: 0.35, factor: 1.7}}"),
              ElementsAre(HasSubstr("the motion needs the factor 1.71616375 to get there, not 1.7")));
}

TEST_F(ExcitationSection, CorrectionsLeaveTheGroundAtRest) {
  const Scenario scenario = read("{ground_motion: other.txt, baseline: linear}");
  const GroundRecord& record = scenario.excitation.records[0];
  EXPECT_TRUE(record.is_corrected);
  EXPECT_GT(std::abs(record.end_as_read.velocity_m_per_s), 0.05);
  EXPECT_NEAR(record.end.velocity_m_per_s, 0.0, 1e-15);
  EXPECT_THAT(errors("{ground_motion: other.txt, high_pass: {frequency_hz: 0.5}}"), IsEmpty());
}

TEST_F(ExcitationSection, GeneratedGroundMotionsAreSampledAtTheSteps) {
  const Scenario scenario =
      read("{harmonic: {amplitude_g: 0.1, frequency_hz: 20.0, cycles: 1.5}, influence: {floor_1: 1.0}}");
  const std::vector<double>& found = scenario.excitation.records[0].acceleration_m_per_s2;
  for (std::size_t step = 0; step <= 100; ++step) {
    const double time_s = 0.001 * static_cast<double>(step);
    const double expected = step <= 75 ? std::sin(2.0 * M_PI * 20.0 * time_s) : 0.0;
    ASSERT_NEAR(found[step], 0.1 * kStandardGravity_m_per_s2 * expected, 1e-9) << step;
  }
  const Scenario sweep =
      read("{sweep: {amplitude_m_per_s2: 2.0, from_hz: 1.0, to_hz: 50.0, duration_s: 0.1, type: logarithmic}}");
  EXPECT_GT(sweep.excitation.records[0].facts.peak_m_per_s2, 1.9);
}

TEST_F(ExcitationSection, ForcesActWhereTheyAreNamed) {
  const Scenario scenario = read(
      "{forces: [{force_history: forces.csv, scale: 2.0}, {force_history: force.csv, dof: floor_2}, "
      "{harmonic: {amplitude_n: 10.0, frequency_hz: 25.0}, dofs: {floor_1: 1.0, floor_2: -1.0}}]}");
  EXPECT_TRUE(scenario.excitation.records.empty());
  ASSERT_EQ(scenario.excitation.forces.size(), 4U);
  const AppliedLoad load = scenario.excitation.load(scenario.structure);
  Eigen::VectorXd force_n(2);
  load.forces_at(50, force_n);
  EXPECT_NEAR(force_n[0], 4000.0 + 10.0 * std::sin(2.0 * M_PI * 25.0 * 0.05), 1e-9);
  EXPECT_NEAR(force_n[1], 200.0 + 1.0 - 10.0 * std::sin(2.0 * M_PI * 25.0 * 0.05), 1e-9);
  EXPECT_EQ(scenario.excitation.forces[0].peak_n, 200.0);
}

TEST_F(ExcitationSection, RecordsBeginAtTheRelease) {
  const Scenario scenario = read(
      "{ground_motion: other.txt, free_vibration: {displacement_m: {floor_1: 0.001, floor_2: 0.002}, ramp_s: 0.03, "
      "hold_s: 0.01}}");
  EXPECT_EQ(scenario.excitation.release_step(), 40);
  EXPECT_EQ(scenario.excitation.records[0].acceleration_m_per_s2[39], 0.0);
  EXPECT_EQ(scenario.excitation.records[0].acceleration_m_per_s2[40], 0.5);
  const auto integrator = scenario.make_integrator();
  EXPECT_TRUE(integrator->current().displacement_m.isZero(0.0));
  const Eigen::VectorXd nothing = Eigen::VectorXd::Zero(2);
  for (int step = 0; step < 40; ++step) integrator->advance(nothing, nothing);
  EXPECT_EQ(integrator->current().displacement_m, Eigen::Vector2d(0.001, 0.002));
}

TEST_F(ExcitationSection, OthersFollowTheDisplacementsThatAreGiven) {
  const Scenario scenario = read("{free_vibration: {displacement_m: {floor_2: 0.007}, others: follow, ramp_s: 0.05}}");
  // Storeys of 4e6 and 3e6 N/m in series.
  const Eigen::VectorXd& start_m = scenario.excitation.free_vibration->initial.displacement_m;
  EXPECT_NEAR(start_m[0], 0.003, 1e-15);
  EXPECT_EQ(start_m[1], 0.007);
}

struct WrongExcitation {
  const char* name;
  const char* excitation;
  const char* message;
};

void PrintTo(const WrongExcitation& wrong, std::ostream* stream) { *stream << wrong.name; }

class WrongExcitations : public ExcitationSection, public testing::WithParamInterface<WrongExcitation> {};

TEST_P(WrongExcitations, AreRefusedAtTheirKey) {
  EXPECT_THAT(errors(GetParam().excitation), Contains(HasSubstr(GetParam().message)));
}

INSTANTIATE_TEST_SUITE_P(
    Records, WrongExcitations,
    testing::Values(
        WrongExcitation{"Nothing", "{}", "excitation.ground_motion"},
        WrongExcitation{"NoRecords", "{records: []}", "excitation.records: expected 1 to 20 records"},
        WrongExcitation{"ListAndShortForm", "{records: [{ground_motion: motion.txt}], scale: 2.0}", "scale"},
        WrongExcitation{"TwoKinds", "{ground_motion: motion.txt, sweep: {}}",
                        "sweep: beside ground_motion; expected one of"},
        WrongExcitation{"ScaleTwice", "{ground_motion: motion.txt, scale: 1.0, scale_to: {peak_g: 0.1}}",
                        "scale: beside scale_to"},
        WrongExcitation{"ScaleToNothing", "{ground_motion: motion.txt, scale_to: {}}",
                        "scale_to: expected one of peak_g, spectral_acceleration_g"},
        WrongExcitation{"ScaleToBoth",
                        "{ground_motion: motion.txt, scale_to: {peak_g: 1.0, spectral_acceleration_g: 1.0}}",
                        "spectral_acceleration_g: beside peak_g"},
        WrongExcitation{"PeriodMissing", "{ground_motion: motion.txt, scale_to: {spectral_acceleration_g: 1.0}}",
                        "period_s"},
        WrongExcitation{"FlatMotion", "{ground_motion: flat.txt, scale_to: {peak_g: 0.1}}",
                        "scale_to: the motion is zero everywhere"},
        WrongExcitation{"Baseline", "{ground_motion: motion.txt, baseline: cubic}", "baseline"},
        WrongExcitation{"HighPass", "{ground_motion: motion.txt, high_pass: {frequency_hz: 100.0}}",
                        "frequency_hz: the frequency of the high-pass filter is above a quarter"},
        WrongExcitation{"ScaledGenerated", "{harmonic: {amplitude_g: 0.1, frequency_hz: 1.0}, scale: 2.0}", "scale"},
        WrongExcitation{"AmplitudeMissing", "{harmonic: {frequency_hz: 1.0}}",
                        "harmonic: expected one of amplitude_g, amplitude_m_per_s2"},
        WrongExcitation{"FrequencyAboveSteps", "{harmonic: {amplitude_g: 0.1, frequency_hz: 300.0}}", "frequency_hz"},
        WrongExcitation{"CyclesAndDuration",
                        "{harmonic: {amplitude_g: 0.1, frequency_hz: 20.0, cycles: 1, duration_s: 0.05}}",
                        "duration_s: beside cycles"},
        WrongExcitation{"LongRamp", "{harmonic: {amplitude_g: 0.1, frequency_hz: 20.0, cycles: 1, ramp_s: 0.03}}",
                        "ramp_s: the signal grows and fades over 0.03 s each, but lasts 0.05 s"},
        WrongExcitation{"SupportWithoutInfluence", "{ground_motion: motion.txt, support: west}",
                        "support: a support that moves alone needs influence"},
        WrongExcitation{"SupportOfInterface", "{ground_motion: motion.txt, support: west, influence: {floor_1: 1.0}}",
                        "interface[0].dof: supports move on their own, and this interface stands on one of them"},
        WrongExcitation{"SupportThatStrains", "{ground_motion: motion.txt, support: west, influence: {floor_1: 1.0}}",
                        "substructures[1].interface[0].dof: a displacement of the support 'west' strains this "
                        "substructure by -1 of it"}),
    [](const auto& instance) { return std::string{instance.param.name}; });

INSTANTIATE_TEST_SUITE_P(
    ForcesAndStart, WrongExcitations,
    testing::Values(
        WrongExcitation{"ForceWithoutKind", "{forces: [{dof: floor_1}]}",
                        "forces[0]: expected one of force_history, harmonic, sweep"},
        WrongExcitation{"ForceWithoutPlace", "{forces: [{harmonic: {amplitude_n: 1.0, frequency_hz: 1.0}}]}",
                        "forces[0]: expected one of dof, dofs"},
        WrongExcitation{"ForceAtUnknownDof", "{forces: [{force_history: force.csv, dof: floor_3}]}",
                        "forces[0].dof: no degree of freedom 'floor_3'; did you mean 'floor_1'?"},
        WrongExcitation{"ColumnOfUnknownDof", "{forces: [{force_history: force.csv}]}",
                        "force_history: force.csv: column 2: no degree of freedom 'actuator'"},
        WrongExcitation{"ColumnsAtOneDof", "{forces: [{force_history: forces.csv, dof: floor_1}]}",
                        "dof: the file has 2 columns of forces; expected one"},
        WrongExcitation{"ForceFileMissing", "{forces: [{force_history: none.csv}]}", "force_history: there is no file"},
        WrongExcitation{"StartWithoutMotion", "{free_vibration: {ramp_s: 0.01}}",
                        "free_vibration: expected displacement_m, velocity_m_per_s, or both"},
        WrongExcitation{"StartAtUnknownDof", "{free_vibration: {displacement_m: {roof: 0.01}, ramp_s: 0.05}}",
                        "displacement_m.roof: no degree of freedom 'roof'"},
        WrongExcitation{"StartJumps", "{free_vibration: {displacement_m: {floor_1: 0.01}}}",
                        "free_vibration: the specimen of 'storey_1' must be brought to its initial displacement"},
        WrongExcitation{"StartTooFast", "{free_vibration: {displacement_m: {floor_1: 0.1}, ramp_s: 0.05}}",
                        "ramp_s: 'storey_1' would be pulled at 3.75 m/s, but its limit is 1.5 m/s"},
        WrongExcitation{"StartTooFar", "{free_vibration: {displacement_m: {floor_1: 0.3}, ramp_s: 0.09}}",
                        "'storey_1' would get a command of 0.3 m before the release, but its limit is 0.2 m"},
        WrongExcitation{"HeldWithVelocity",
                        "{free_vibration: {velocity_m_per_s: {floor_1: 0.01}, ramp_s: 0.05, hold_s: 0.01}}",
                        "hold_s: a structure that is held has no velocity"},
        WrongExcitation{"ReleasedAfterTheTest", "{free_vibration: {displacement_m: {floor_1: 0.01}, ramp_s: 0.2}}",
                        "ramp_s: the test ends before the structure is released"}),
    [](const auto& instance) { return std::string{instance.param.name}; });

TEST_F(ExcitationSection, SupportsThatStrainNoSubstructureAreTaken) {
  // Both floors follow the west support alike, and the site stands on the other one, which does not move.
  const std::string moved = with("interface: [{dof: floor_1}]", "interface: [{dof: floor_1, relative_to: floor_2}]",
                                 text("{records: [{ground_motion: motion.txt, support: west, influence: {floor_1: 0.4, "
                                      "floor_2: 0.4}}, {ground_motion: other.txt, support: east, influence: {floor_1: "
                                      "0.6, floor_2: 0.6}}]}"));
  EXPECT_THAT(file_.errors(moved, {"structure.damping={type: none}"}), IsEmpty());
}

}  // namespace
}  // namespace hybridtest
