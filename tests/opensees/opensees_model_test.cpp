#include "numerical_substructure/opensees/opensees_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <fstream>
#include <string>
#include <vector>

#include "core/config_error.hpp"
#include "mechanics/laws/bilinear.hpp"
#include "numerical_substructure/opensees/opensees_child.hpp"
#include "tests/support/opensees.hpp"

namespace hybridtest {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Throws;
using testing::ThrowsMessage;

const std::string kStorey =
    "model basic -ndm 1 -ndf 1\n"
    "node 1 0.0\nnode 2 0.0\nfix 1 1\n"
    "uniaxialMaterial Steel01 1 40.0e3 4.0e6 0.05\n"
    "element zeroLength 1 1 2 -mat 1 -dir 1\n";

/// A fixed column of fibres, 3 m high; its tip has dof 1 across.
const std::string kFibreColumn =
    "model basic -ndm 2 -ndf 3\n"
    "node 1 0 0\nnode 2 0 3.0\nfix 1 1 1 1\n"
    "geomTransf Linear 1\n"
    "uniaxialMaterial Steel02 1 350.0e6 200.0e9 0.02 18 0.925 0.15\n"
    "section Fiber 1 {\n patch rect 1 8 1 -0.15 -0.15 0.15 0.15\n}\n"
    "element forceBeamColumn 1 1 2 5 1 1\n";

std::string elastic_column(double height, double modulus, double inertia, double area) {
  return "model basic -ndm 2 -ndf 3\nnode 1 0 0\nnode 2 0 " + std::to_string(height) +
         "\nfix 1 1 1 1\ngeomTransf Linear 1\nelement elasticBeamColumn 1 1 2 " + std::to_string(area) + " " +
         std::to_string(modulus) + " " + std::to_string(inertia) + " 1\n";
}

class OpenSeesModelTest : public testing::Test {
 protected:
  OpenSeesModelTest() {
    folder_ = std::filesystem::temp_directory_path() / ("opensees_model_" + std::to_string(getpid()) + "_" +
                                                        testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~OpenSeesModelTest() override { std::filesystem::remove_all(folder_); }

  OpenSeesSettings settings(const std::string& script, std::vector<OpenSeesDof> interface = {{2, 1}}) {
    write("model.tcl", script);
    OpenSeesSettings settings;
    settings.program = test_opensees().string();
    settings.script = folder_ / "model.tcl";
    settings.interface = std::move(interface);
    settings.step_s = 0.01;
    return settings;
  }
  void write(const std::string& name, const std::string& text) const { std::ofstream{folder_ / name} << text; }
  static double step(SubstructureModel& model, double displacement_m) {
    InterfaceVector force_n = InterfaceVector::Zero(1);
    const auto answer =
        model.begin_step(InterfaceVector::Constant(1, displacement_m), InterfaceVector::Zero(1), force_n, Instant{});
    EXPECT_EQ(answer, ModelAnswer::ready) << model.failure_text();
    return force_n[0];
  }
  static double tried(SubstructureModel& model, double displacement_m) {
    InterfaceVector force_n = InterfaceVector::Zero(1);
    model.trial(InterfaceVector::Constant(1, displacement_m), InterfaceVector::Zero(1), force_n);
    return force_n[0];
  }
  /// Starting the model fails with these words.
  void expect_refused(const OpenSeesSettings& settings, const std::string& words) {
    OpenSeesModel model{settings};
    EXPECT_THAT([&] { model.start({}); }, ThrowsMessage<ConfigError>(AllOf(HasSubstr("model.tcl"), HasSubstr(words))));
  }

  std::filesystem::path folder_;
};

/// Displacements of a motion that yields in both directions. [m]
std::vector<double> cycles() {
  std::vector<double> motion_m;
  for (int i = 0; i <= 60; ++i) motion_m.push_back(0.001 * i * std::sin(0.3 * i));
  return motion_m;
}

TEST_F(OpenSeesModelTest, ElasticColumnHasTheStiffnessOfABeam) {
  HYBRIDTEST_NEEDS_OPENSEES();
  constexpr double kStiffness = 200.0e9 * 5.0e-4;  // E I
  OpenSeesSettings beam = settings(elastic_column(3.0, 200.0e9, 5.0e-4, 0.01), {{2, 1}, {2, 3, true}});
  const InterfaceMatrix found = OpenSeesModel{beam}.initial_stiffness_n_per_m();
  const Eigen::Matrix2d expected = (Eigen::Matrix2d{} << 12.0 / 27.0, 6.0 / 9.0, 6.0 / 9.0, 4.0 / 3.0).finished();
  EXPECT_LT((found - kStiffness * expected).norm(), 1e-8 * kStiffness * expected.norm()) << found;
  beam.interface = {{2, 1}};
  EXPECT_NEAR(OpenSeesModel{beam}.initial_stiffness_n_per_m()(0, 0) / (3.0 * kStiffness / 27.0), 1.0, 1e-9)
      << "condensed on one degree of freedom";
}

TEST_F(OpenSeesModelTest, NodesThatFollowTheInterfaceCount) {
  HYBRIDTEST_NEEDS_OPENSEES();
  const std::string columns =
      "model basic -ndm 2 -ndf 3\ngeomTransf Linear 1\n"
      "foreach {foot tip x} {1 2 0.0  3 4 5.0} {\n"
      "  node $foot $x 0.0\n  node $tip $x 3.0\n  fix $foot 1 1 1\n"
      "  element elasticBeamColumn $foot $foot $tip 0.01 200.0e9 5.0e-4 1\n}\n";
  constexpr double kCantilever_n_per_m = 3.0 * 200.0e9 * 5.0e-4 / 27.0;
  OpenSeesModel model{settings(columns + "equalDOF 2 4 1\n")};
  EXPECT_NEAR(model.initial_stiffness_n_per_m()(0, 0) / (2.0 * kCantilever_n_per_m), 1.0, 1e-9) << "by trials";
  model.start({});
  EXPECT_NEAR(step(model, 0.01) / (0.02 * kCantilever_n_per_m), 1.0, 1e-9) << "by a step";
  expect_refused(settings(columns + "rigidLink beam 2 4\n", {{2, 3, true}}), "follows the rotation of node 2");
}

TEST_F(OpenSeesModelTest, YieldingSteelIsOurBilinearLaw) {
  HYBRIDTEST_NEEDS_OPENSEES();
  OpenSeesModel model{settings(kStorey)};
  model.start({});
  Bilinear law{{.stiffness_n_per_m = 4.0e6, .yield_force_n = 40.0e3, .hardening_ratio = 0.05}};
  for (const double displacement_m : cycles()) {
    const double expected_n = law.trial(displacement_m, 0.0);
    law.commit();
    ASSERT_NEAR(step(model, displacement_m), expected_n, 1e-9 * 40.0e3);
  }
}

TEST_F(OpenSeesModelTest, TrialLeavesNoTrace) {
  HYBRIDTEST_NEEDS_OPENSEES();
  OpenSeesModel plain{settings(kFibreColumn)};
  OpenSeesModel tried_first{settings(kFibreColumn)};
  plain.start({});
  tried_first.start({});
  double largest_n = 0.0;
  for (const double displacement_m : cycles()) {
    const double expected_n = step(plain, displacement_m);
    largest_n = std::max(largest_n, std::abs(expected_n));
    ASSERT_NEAR(tried(tried_first, displacement_m), expected_n, 1e-6 * largest_n);
    static_cast<void>(tried(tried_first, 0.5 * displacement_m));
    static_cast<void>(tried(tried_first, displacement_m + 0.005));
    ASSERT_NEAR(step(tried_first, displacement_m), expected_n, 1e-9 * largest_n);
  }
  EXPECT_GT(largest_n, 1.0e5);
}

TEST_F(OpenSeesModelTest, ResetStartsFromTheStateOfTheScript) {
  HYBRIDTEST_NEEDS_OPENSEES();
  OpenSeesModel model{settings(kStorey)};
  model.start({});
  const double virgin_n = step(model, 0.005);
  static_cast<void>(step(model, -0.05));
  EXPECT_NE(step(model, 0.005), virgin_n);
  model.reset();
  EXPECT_EQ(step(model, 0.005), virgin_n);
}

TEST_F(OpenSeesModelTest, UnitsOfTheScriptAreConverted) {
  HYBRIDTEST_NEEDS_OPENSEES();
  constexpr double kInch_m = 0.0254;
  constexpr double kKip_n = 4448.2216152605;
  // 118.11 in high, 29 000 ksi, 100 in^4.
  OpenSeesSettings inches = settings(elastic_column(118.11, 29000.0, 100.0, 10.0), {{2, 1}, {2, 3, true}});
  inches.length_unit_m = kInch_m;
  inches.force_unit_n = kKip_n;
  const InterfaceMatrix found = OpenSeesModel{inches}.initial_stiffness_n_per_m();
  const double height_m = 118.11 * kInch_m;
  const double bending = 29000.0 * 100.0 * kKip_n * kInch_m * kInch_m;  // E I [N m2]
  EXPECT_NEAR(found(0, 0) / (12.0 * bending / std::pow(height_m, 3)), 1.0, 1e-8);
  EXPECT_NEAR(found(0, 1) / (6.0 * bending / std::pow(height_m, 2)), 1.0, 1e-8);
  EXPECT_NEAR(found(1, 1) / (4.0 * bending / height_m), 1.0, 1e-8);
}

TEST_F(OpenSeesModelTest, GravityIsTheStateThatForcesCountFrom) {
  HYBRIDTEST_NEEDS_OPENSEES();
  OpenSeesModel model{settings(kStorey +
                               "timeSeries Linear 1\npattern Plain 1 1 {\n load 2 20.0e3\n}\n"
                               "constraints Plain\nnumberer Plain\nsystem BandGeneral\ntest NormDispIncr 1e-12 10\n"
                               "algorithm Newton\nintegrator LoadControl 0.5\nanalysis Static\n"
                               "if {[analyze 2] != 0} { error gravity }\n")};
  model.start({});
  EXPECT_NEAR(step(model, 0.0), 0.0, 1e-6);
  EXPECT_NEAR(step(model, 0.004), 16.0e3, 1e-6) << "20 kN of gravity and 16 kN: below the yield force";
  EXPECT_NEAR(step(model, 0.015), 22.0e3, 1e-4) << "yields at 20 kN above gravity";
}

TEST_F(OpenSeesModelTest, ScriptKeepsItsFilesAndItsWords) {
  HYBRIDTEST_NEEDS_OPENSEES();
  write("steel.tcl", "uniaxialMaterial Elastic 1 4.0e6\n");
  OpenSeesModel model{
      settings("puts \"script [file tail [info script]] with [llength $argv] arguments\"\n"
               "model basic -ndm 1 -ndf 1\nnode 1 0.0\nnode 2 0.0\nfix 1 1\nsource steel.tcl\n"
               "element zeroLength 1 1 2 -mat 1 -dir 1\nfile mkdir out\n"
               "recorder Node -file out/tip.txt -time -node 2 -dof 1 disp\n"
               "proc send {args} {}\nproc reply {args} {}\nset requests 1\n")};
  const std::filesystem::path log = folder_ / "frame_model.log";
  model.start({.log = log, .wake = {}});
  for (const double displacement_m : {0.0, 0.01, 0.02}) static_cast<void>(step(model, displacement_m));
  model.reset();  // its files are written out
  std::ifstream text{log};
  const std::string words{std::istreambuf_iterator<char>{text}, {}};
  EXPECT_THAT(words, HasSubstr("script model.tcl with 0 arguments"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out" / "tip.txt")) << "relative to the folder of the script";
}

TEST_F(OpenSeesModelTest, RecordersHaveTheModelTime) {
  HYBRIDTEST_NEEDS_OPENSEES();
  {
    OpenSeesModel model{settings(kStorey + "recorder Node -file tip.txt -time -node 2 -dof 1 disp\n")};
    model.start({});
    for (const double displacement_m : {0.0, 0.001, 0.002}) static_cast<void>(step(model, displacement_m));
  }
  std::ifstream text{folder_ / "tip.txt"};
  std::vector<double> values{std::istream_iterator<double>{text}, {}};
  ASSERT_EQ(values.size(), 8U) << "the state of the script, and three steps";
  EXPECT_NEAR(values[6], 0.02, 1e-12);
  EXPECT_NEAR(values[7], 0.002, 1e-12);
}

TEST_F(OpenSeesModelTest, WrongScriptsAreToldInWords) {
  HYBRIDTEST_NEEDS_OPENSEES();
  expect_refused(settings(kStorey + "exit\n"), "the script calls `exit`");
  expect_refused(settings(kStorey + "analyze 1000 0.01\n"), "a transient analysis");
  expect_refused(settings(kStorey + "wipe\n"), "the script leaves no model");
  expect_refused(settings("set x 1\n"), "the script leaves no model");
  expect_refused(settings(kStorey + "\nset y $undefined\n"), "(file \"model.tcl\" line 8)");
  expect_refused(settings(kStorey + "element zeroLength 2 1 77 -mat 1 -dir 1\n"), "77");
  expect_refused(settings(kStorey, {{3, 1}}), "the model has no node 3");
  expect_refused(settings(kStorey, {{2, 2}}), "node 2 has 1 degrees of freedom");
  expect_refused(settings(kStorey, {{1, 1}}), "the script fixes dof 1 of node 1");
  expect_refused(settings(kStorey + "node 3 0.0\nequalDOF 2 3 1\n", {{3, 1}}), "follows another node");
}

TEST_F(OpenSeesModelTest, AbsentProgramIsToldWithWhatToDo) {
  OpenSeesSettings absent = settings(kStorey);
  absent.program = "/no/such/OpenSees";
  OpenSeesModel model{absent};
  EXPECT_THAT([&] { model.start({}); },
              ThrowsMessage<ConfigError>(AllOf(HasSubstr("/no/such/OpenSees"), HasSubstr("path of OpenSees"))));
}

TEST_F(OpenSeesModelTest, StepWithoutEquilibriumFailsWithItsResidual) {
  HYBRIDTEST_NEEDS_OPENSEES();
  // No iteration of a yielding column ends in so small a correction.
  OpenSeesModel model{settings(kFibreColumn + "test NormDispIncr 1e-40 3\n")};
  model.start({});
  InterfaceVector force_n = InterfaceVector::Zero(1);
  EXPECT_EQ(model.begin_step(InterfaceVector::Constant(1, 0.05), InterfaceVector::Zero(1), force_n, Instant{}),
            ModelAnswer::failed);
  EXPECT_EQ(model.failure().fault, ModelFault::not_converged);
  EXPECT_GT(model.failure().value, 1e-40);
  EXPECT_THAT(model.failure_text(), HasSubstr("finds no equilibrium"));
  EXPECT_TRUE(std::isnan(force_n[0]));
}

TEST_F(OpenSeesModelTest, StepThatIsTooLargeIsTakenInParts) {
  HYBRIDTEST_NEEDS_OPENSEES();
  // Three iterations are enough for small parts of this step alone.
  OpenSeesModel parts{settings(kFibreColumn + "test NormDispIncr 1e-9 3\n")};
  OpenSeesModel whole{settings(kFibreColumn)};
  parts.start({});
  whole.start({});
  const double expected_n = step(whole, 0.06);
  EXPECT_NEAR(step(parts, 0.06), expected_n, 1e-3 * std::abs(expected_n));
}

TEST_F(OpenSeesModelTest, InitialStiffnessIsAskedOnce) {
  HYBRIDTEST_NEEDS_OPENSEES();
  const OpenSeesSettings counted = settings("set file [open started.txt a]\nputs $file x\nclose $file\n" + kStorey +
                                            "recorder Node -file tip.txt -node 2 -dof 1 disp\n");
  EXPECT_NEAR(OpenSeesModel{counted}.initial_stiffness_n_per_m()(0, 0), 4.0e6, 1e-2);
  EXPECT_NEAR(OpenSeesModel{counted}.initial_stiffness_n_per_m()(0, 0), 4.0e6, 1e-2);
  EXPECT_EQ(std::filesystem::file_size(folder_ / "started.txt"), 2U);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "tip.txt")) << "its recorders write nothing";
  OpenSeesSettings given = counted;
  given.program = "/no/such/OpenSees";
  given.initial_stiffness_n_per_m = Eigen::MatrixXd::Constant(1, 1, 7.0);
  EXPECT_EQ(OpenSeesModel{given}.initial_stiffness_n_per_m()(0, 0), 7.0);
}

TEST_F(OpenSeesModelTest, SilentProcessFailsAfterItsTime) {
  HYBRIDTEST_NEEDS_OPENSEES();
  OpenSeesSettings impatient = settings(kStorey + "trace add execution setTime enter {apply {args {after 60000}}}\n");
  impatient.answer_timeout = std::chrono::milliseconds{500};
  OpenSeesModel model{impatient};
  model.start({});
  InterfaceVector force_n = InterfaceVector::Zero(1);
  EXPECT_EQ(model.begin_step(InterfaceVector::Zero(1), InterfaceVector::Zero(1), force_n, Instant{}),
            ModelAnswer::failed);
  EXPECT_EQ(model.failure().fault, ModelFault::silent);
  EXPECT_EQ(model.failure().value, 0.5);
}

TEST_F(OpenSeesModelTest, ProcessThatEndsFailsWithItsExitCode) {
  HYBRIDTEST_NEEDS_OPENSEES();
  OpenSeesModel model{settings(kStorey + "trace add execution setTime enter {apply {args {\n"
                                         "  puts stderr {last words}; exec kill -9 [pid]}}}\n")};
  model.start({});
  InterfaceVector force_n = InterfaceVector::Zero(1);
  EXPECT_EQ(model.begin_step(InterfaceVector::Zero(1), InterfaceVector::Zero(1), force_n, Instant{}),
            ModelAnswer::failed);
  EXPECT_EQ(model.failure().fault, ModelFault::ended);
  EXPECT_EQ(model.failure().value, 128.0 + SIGKILL);
  EXPECT_THAT(model.failure_text(), AllOf(HasSubstr("signal 9"), HasSubstr("last words")));
}

}  // namespace
}  // namespace hybridtest
