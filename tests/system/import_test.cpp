#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "mechanics/structure/matrix_market.hpp"
#include "tests/support/opensees.hpp"
#include "tests/support/system_fixture.hpp"

/// `hybridtest import opensees`: the stock OpenSees runs the script, and what it builds becomes a scenario.
namespace hybridtest {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::Optional;

class Import : public SystemTest {
 protected:
  void SetUp() override { HYBRIDTEST_NEEDS_OPENSEES(); }

  void write(const std::string& name, const std::string& text) const { std::ofstream{directory() / name} << text; }
  /// What the program prints.
  std::string imported(Arguments arguments, int exit_code = kExitCompleted) const {
    arguments.insert(arguments.begin(), {"import", "opensees"});
    StartedProgram started = start_hybridtest(arguments, "import");
    EXPECT_THAT(started.wait(), Optional(exit_code)) << started.standard_error();
    return exit_code == kExitCompleted ? started.standard_output() + started.standard_error()
                                       : started.standard_error();
  }
  [[nodiscard]] Eigen::MatrixXd matrix(const std::string& file) const {
    return Eigen::MatrixXd{read_matrix_market(directory() / file)};
  }
};

/// Two masses on springs, in kip and inches: 2 and 1 kip s2/in, 300 and 200 kip/in.
constexpr const char* kSprings = R"tcl(
model BasicBuilder -ndm 1 -ndf 1
node 1 0
node 2 0 -mass 2.0
node 3 0 -mass 1.0
fix 1 1
uniaxialMaterial Elastic 1 300.0
uniaxialMaterial Elastic 2 200.0
element zeroLength 1 1 2 -mat 1 -dir 1 -doRayleigh 1
element zeroLength 2 2 3 -mat 2 -dir 1 -doRayleigh 1
)tcl";

TEST_F(Import, SpaceFrameEqualsTheMatricesOfTheReference) {
  const std::filesystem::path reference = std::filesystem::path{HYBRIDTEST_SOURCE_DIR} / "tests/reference";
  // The script takes arguments, writes its files and analyses; none of it is ours to ask for.
  write("frame.tcl", "set argv {0.05 " + directory().string() + "}\nsource " + (reference / "frame_3d.tcl").string());
  const std::string printed = imported({"frame.tcl", "--interface", "300,1", "300,2", "--out", "frame"});
  EXPECT_THAT(printed,
              AllOf(HasSubstr("108 degrees of freedom"), HasSubstr("hybridtest check"), Not(HasSubstr("warning"))));
  for (const std::string name : {"mass.mtx", "stiffness.mtx"}) {
    const Eigen::MatrixXd expected{read_matrix_market(reference / "frame_3d" / name)};
    const Eigen::MatrixXd found = matrix("frame/" + name);
    ASSERT_EQ(found.rows(), expected.rows());
    EXPECT_LE((found - expected).cwiseAbs().maxCoeff(), 1e-10 * expected.cwiseAbs().maxCoeff()) << name;
  }
  // As the script says: rayleigh 0.35 0.0 0.0006 0.0.
  const std::string scenario = text_of(directory() / "frame/scenario.yaml");
  const auto value = [&](const std::string& key) {
    return std::stod(scenario.substr(scenario.find(key) + key.size()));
  };
  EXPECT_NEAR(value("mass_per_s: "), 0.35, 1e-8);
  EXPECT_NEAR(value("stiffness_s: "), 0.0006, 1e-12);
  EXPECT_THAT(scenario, HasSubstr("interface: [{dof: node_300_uy}]"));
  StartedProgram check = start_hybridtest({"check", "frame/scenario.yaml", "--quick"}, "check");
  EXPECT_THAT(check.wait(), Optional(kExitCompleted)) << check.standard_output() << check.standard_error();
}

/// The history of the reference: time, then a column for each of `dofs`, every 0.05 s.
std::vector<std::vector<double>> history_of_the_frame() {
  std::ifstream file{std::filesystem::path{HYBRIDTEST_SOURCE_DIR} / "tests/reference/frame_3d/history.csv"};
  std::vector<std::vector<double>> rows;
  std::string line;
  for (std::getline(file, line); std::getline(file, line);) {
    std::ranges::replace(line, ',', ' ');
    std::istringstream words{line};
    std::vector<double>& row = rows.emplace_back();
    for (double value = 0.0; words >> value;) row.push_back(value);
  }
  return rows;
}

TEST_F(Import, RunEqualsTheAnalysisOfOpenSees) {
  const std::filesystem::path reference = std::filesystem::path{HYBRIDTEST_SOURCE_DIR} / "tests/reference";
  write("frame.tcl", "set argv {0.05 " + directory().string() + "}\nsource " + (reference / "frame_3d.tcl").string());
  imported({"frame.tcl", "--interface", "300,1"});
  std::string scenario = text_of(directory() / "frame/scenario.yaml");
  const auto replace = [&](const std::string& key, const std::string& line) {
    const std::size_t begin = scenario.find("\n" + key) + 1;
    scenario.replace(begin, scenario.find('\n', begin) - begin, line);
  };
  replace("time:", "time: {mode: lockstep, step_s: 0.001, duration_s: 10.0}");
  std::string records = "excitation:\n  records:";
  for (const std::string axis : {"x", "y"}) {
    std::filesystem::copy_file(reference / "frame_3d" / (axis + ".txt"), directory() / "frame" / (axis + ".txt"));
    records.append("\n    - {ground_motion: ").append(axis).append(".txt, unit: m_per_s2, dt_s: 0.01, direction: ");
    records.append(axis).append("}");
  }
  replace("excitation:", records);
  write("frame/shaken.yaml", scenario);
  // Control: three hundredths more of the damping by mass are far above the limit.
  replace("  damping:", "  damping: {type: mass_and_stiffness, mass_per_s: 0.36, stiffness_s: 0.0006}");
  write("frame/damped.yaml", scenario);
  const std::vector<std::vector<double>> expected = history_of_the_frame();
  ASSERT_EQ(expected.size(), 200U);
  const auto worst_share_of_peak = [&](const std::string& name) {
    StartedProgram simulate = start_hybridtest(
        {"simulate", "frame/" + name + ".yaml", "--seed", "1", "--out", name + ".run"}, "simulate_" + name);
    EXPECT_THAT(simulate.wait(), Optional(kExitCompleted)) << simulate.standard_error();
    double worst = 0.0;
    std::size_t column = 0;
    for (const std::string dof : {"node_300_ux", "node_300_uy", "node_321_ux", "node_321_uy"}) {
      ++column;
      const std::vector<double> found =
          recorded(name + ".run").column("coordinator", "steps", "displacement_" + dof + "_m");
      double peak = 0.0;
      double distance = 0.0;
      for (std::size_t i = 0; i < expected.size(); ++i) {
        peak = std::max(peak, std::abs(expected[i][column]));
        distance = std::max(distance, std::abs(found.at((i + 1) * 50) - expected[i][column]));
      }
      worst = std::max(worst, distance / peak);
    }
    return worst;
  };
  const double share = worst_share_of_peak("shaken");
  RecordProperty("worst_share_of_peak", std::to_string(share));
  EXPECT_LE(share, 5e-4);
  EXPECT_GE(worst_share_of_peak("damped"), 2e-3);
}

TEST_F(Import, UnitsOfTheScriptBecomeSi) {
  write("springs.tcl", kSprings + std::string{"rayleigh 0.2 0 0.001 0\nputs done\nexit\n"});
  imported({"springs.tcl", "--interface", "3,1", "--length", "in", "--force", "kip"});
  const double stiffness_n_per_m = 4448.2216152605 / 0.0254;
  const Eigen::MatrixXd stiffness = matrix("springs/stiffness.mtx");
  EXPECT_NEAR(stiffness(0, 0), 500.0 * stiffness_n_per_m, 1e-3);
  EXPECT_NEAR(stiffness(0, 1), -200.0 * stiffness_n_per_m, 1e-3);
  EXPECT_NEAR(matrix("springs/mass.mtx")(1, 1), stiffness_n_per_m, 1e-5);
  // omega^2 of det(K - omega^2 M) = 0, whatever the units.
  std::istringstream modes{text_of(directory() / "springs/modes.csv")};
  std::string line;
  std::getline(modes, line);
  for (const double omega_squared :
       {225.0 - std::sqrt(225.0 * 225.0 - 30000.0), 225.0 + std::sqrt(225.0 * 225.0 - 30000.0)}) {
    std::getline(modes, line);
    const double expected_hz = std::sqrt(omega_squared) / 6.283185307179586;
    EXPECT_NEAR(std::stod(line.substr(line.find(',') + 1)), expected_hz, 1e-8 * expected_hz);
    EXPECT_NEAR(std::stod(line.substr(line.find(',', 2) + 1)), expected_hz, 1e-8 * expected_hz);
  }
}

TEST_F(Import, DamperBecomesADampingMatrix) {
  write("damped.tcl", kSprings + std::string{"uniaxialMaterial Viscous 3 7.0 1.0\n"
                                             "element zeroLength 3 2 3 -mat 3 -dir 1\n"});
  imported({"damped.tcl", "--interface", "2,1"});
  const Eigen::MatrixXd expected{{7.0, -7.0}, {-7.0, 7.0}};
  EXPECT_LE((matrix("damped/damping.mtx") - expected).cwiseAbs().maxCoeff(), 1e-9);
}

TEST_F(Import, RigidFloorsMoveWithTheirMasters) {
  // Two columns of 12 E I / h^3 each under a floor that is rigid, with its mass at node 9.
  write("floor.tcl", R"tcl(
model BasicBuilder -ndm 3 -ndf 6
foreach {n x z} {1 0 0 2 4 0 3 0 3 4 4 3 9 2 3} { node $n $x 0 $z }
fix 1 1 1 1 1 1 1
fix 2 1 1 1 1 1 1
foreach n {3 4} { fix $n 0 0 1 1 1 0 }
fix 9 0 0 1 1 1 0
mass 9 1000 1000 0 0 0 500
geomTransf Linear 1 0 1 0
foreach c {1 2} { element elasticBeamColumn $c $c [expr $c + 2] 0.1 2e10 1e10 1e-3 2e-3 2e-3 1 }
rigidDiaphragm 3 9 3 4
)tcl");
  imported({"floor.tcl", "--interface", "9.x"});
  EXPECT_THAT(text_of(directory() / "floor/dofs.csv"),
              "node,direction,name\n9,x,node_9_ux\n9,y,node_9_uy\n9,rz,node_9_rz\n");
  const Eigen::MatrixXd stiffness = matrix("floor/stiffness.mtx");
  const double column = 12.0 * 2e10 * 2e-3 / 27.0;
  EXPECT_NEAR(stiffness(0, 0), 2.0 * column, 1e-6 * column);
  EXPECT_NEAR(stiffness(1, 1), 2.0 * column, 1e-6 * column);
  // Each column twists, and moves along y with its lever arm of 2 m.
  EXPECT_NEAR(stiffness(2, 2), 2.0 * (1e10 * 1e-3 / 3.0 + 4.0 * column), 1e-6 * column);
}

TEST_F(Import, ModelsThatCannotBeReadSayWhy) {
  write("springs.tcl", kSprings);
  EXPECT_THAT(imported({"springs.tcl", "--interface", "7,1"}, kExitConfiguration),
              HasSubstr("the model has no node '7'; its nodes are 1, 2, 3"));
  EXPECT_THAT(imported({"springs.tcl", "--interface", "1,1"}, kExitConfiguration),
              AllOf(HasSubstr("degree of freedom 1 of node 1"), HasSubstr("is fixed")));
  EXPECT_THAT(imported({"springs.tcl", "--interface", "3"}, kExitConfiguration), HasSubstr("such as 3,1"));
  write("wrong.tcl", kSprings + std::string{"element unheard 1 2\n"});
  EXPECT_THAT(imported({"wrong.tcl", "--interface", "3,1"}, kExitConfiguration),
              AllOf(HasSubstr("wrong.tcl: OpenSees does not give its model"), HasSubstr("unheard")));
  write("empty.tcl", kSprings + std::string{"wipe\n"});
  EXPECT_THAT(imported({"empty.tcl", "--interface", "3,1"}, kExitConfiguration),
              HasSubstr("leaves no nodes; expected one that builds a model and does not end with `wipe`"));
  write("weightless.tcl",
        "model BasicBuilder -ndm 1 -ndf 1\nnode 1 0\nnode 2 0\nfix 1 1\n"
        "uniaxialMaterial Elastic 1 3.0\nelement zeroLength 1 1 2 -mat 1 -dir 1\n");
  EXPECT_THAT(imported({"weightless.tcl", "--interface", "2,1"}, kExitConfiguration), HasSubstr("has a mass"));
  EXPECT_THAT(imported({"springs.tcl", "--interface", "3,1", "--program", "/no/OpenSees"}, kExitConfiguration),
              HasSubstr("/no/OpenSees"));
  EXPECT_FALSE(std::filesystem::exists(directory() / "springs"));
}

}  // namespace
}  // namespace hybridtest
