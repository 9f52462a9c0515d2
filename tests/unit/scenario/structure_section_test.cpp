#include "scenario/structure_section.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "coordinator/coordinator.hpp"
#include "recording/run_file_writer.hpp"
#include "runtime/run_directory.hpp"
#include "tests/unit/scenario/scenario_file.hpp"

namespace hybridtest {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Two floors that move along x and y. The elastic part is a storey between them in each direction; substructures
/// hold the first floor.
class StructureSection : public testing::Test {
 protected:
  StructureSection() {
    write("m.mtx", "%%MatrixMarket matrix coordinate real symmetric\n4 4 4\n1 1 2e4\n2 2 2e4\n3 3 1e4\n4 4 1e4\n");
    write("k.mtx",
          "%%MatrixMarket matrix coordinate real symmetric\n4 4 6\n"
          "1 1 3e6\n2 2 5e6\n3 1 -3e6\n3 3 3e6\n4 2 -5e6\n4 4 5e6\n");
    write("dofs.csv", "node,direction,name\n1,x,\n1,y,\n2,x,roof_x\n2,y,roof_y\n");
  }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream{file_.directory() / name} << text;
  }

  [[nodiscard]] std::string text(const std::string& structure = kStructure) const {
    std::string text = kScenarioText;
    const std::size_t begin = text.find("structure:\n");
    text.replace(begin, text.find("integrator:") - begin, structure);
    text.replace(text.find("dof: floor_1}]"), 13, "dof: node 1 dof 1}");
    const std::size_t numerical = text.find("  - id: storey_2");
    return text.replace(numerical, std::string::npos,
                        "  - id: storey_2\n    kind: numerical\n    interface: [{dof: 1.y}]\n"
                        "    model: {type: elastic, stiffness_n_per_m: 6.0e6}\n");
  }

  static constexpr const char* kStructure =
      "structure: {mass: m.mtx, stiffness: k.mtx, damping: {type: rayleigh, ratio: 0.02, modes: [1, 4]}, "
      "degrees_of_freedom: dofs.csv}\n";
  ScenarioFile file_;
};

TEST_F(StructureSection, ReadsMatricesAndAddsThoseOfSubstructures) {
  const Scenario scenario = file_.read(text());
  EXPECT_THAT(scenario.dofs, ElementsAre("1.x", "1.y", "roof_x", "roof_y"));
  const Eigen::MatrixXd own{{3e6, 0, -3e6, 0}, {0, 5e6, 0, -5e6}, {-3e6, 0, 3e6, 0}, {0, -5e6, 0, 5e6}};
  Eigen::MatrixXd all = own;
  all(0, 0) += 4.0e6;
  all(1, 1) += 6.0e6;
  EXPECT_EQ(Eigen::MatrixXd{scenario.structure.stiffness_n_per_m}, own);
  EXPECT_EQ(Eigen::MatrixXd{scenario.structure.initial_stiffness_n_per_m}, all);
  EXPECT_EQ(Eigen::MatrixXd{scenario.structure.mass_kg}.diagonal(), Eigen::Vector4d(2e4, 2e4, 1e4, 1e4));
  EXPECT_THAT(scenario.substructures[0].interface_names, ElementsAre("1.x"));
  EXPECT_EQ(scenario.substructures[1].interface.dofs()[0].dof, 1);
  EXPECT_GT(scenario.structure.damping_n_s_per_m.coeff(2, 2), 0.0);
}

TEST_F(StructureSection, PatternListsInterfaceDofsOneByOne) {
  const std::string model = "    model: {type: elastic, stiffness_n_per_m: 6.0e6}\n";
  std::string wide = text();
  wide.replace(wide.find(model), model.size(),
               "    model: {type: elastic, stiffness_matrix_n_per_m: [[6.0e6, 0], [0, 7.0e6]]}\n");
  wide.replace(wide.find("[{dof: 1.y}]"), 12, "[{dofs: \"*y\"}]");
  const Scenario scenario = file_.read(wide);
  const SubstructureScenario& frame = scenario.substructures[1];
  EXPECT_THAT(frame.interface_names, ElementsAre("1.y", "roof_y"));
  EXPECT_EQ(frame.interface.dofs()[1].dof, 3);
  EXPECT_EQ(frame.interface.dofs()[1].relative_to, InterfaceDof::kGround);
  EXPECT_THAT(frame.recorded, ElementsAre(0, 1));

  EXPECT_THAT(file_.errors(with("\"*y\"", "\"*w\"", wide)), Contains(HasSubstr("no degree of freedom matches '*w'")));
  EXPECT_THAT(file_.errors(with("{dofs: \"*y\"}", "{dofs: \"*y\"}, {dof: roof_y}", wide)),
              Contains(HasSubstr("'roof_y' is listed twice")));
}

TEST_F(StructureSection, SiteHasFewerInterfaceDofsThanNumericalOne) {
  std::string rows = "%%MatrixMarket matrix coordinate real symmetric\n13 13 13\n";
  std::string dofs = "node,direction\n";
  for (int node = 1; node <= 13; ++node) {
    rows += std::to_string(node) + " " + std::to_string(node) + " 2e4\n";
    dofs += std::to_string(node) + ",x\n";
  }
  write("m.mtx", rows);
  write("k.mtx", rows);
  write("dofs.csv", dofs);
  const std::string wide_site = with("{dof: node 1 dof 1}", "{dofs: \"*\"}", with("{dof: 1.y}", "{dof: 1.x}", text()));
  EXPECT_THAT(file_.errors(wide_site), Contains(AllOf(HasSubstr("13 degrees of freedom; expected 1 to 12"),
                                                      HasSubstr("control loop of a site"))));
}

TEST_F(StructureSection, GroundMovesOneDirection) {
  EXPECT_EQ(file_.read(text()).structure.influence, Eigen::Vector4d(1, 0, 1, 0));
  EXPECT_EQ(file_.read(text(), {"excitation.direction=y"}).structure.influence, Eigen::Vector4d(0, 1, 0, 1));
  EXPECT_EQ(file_.read(text(), {"excitation.influence={roof_y: 0.5, node 1 dof 1: -1}"}).structure.influence,
            Eigen::Vector4d(-1, 0, 0, 0.5));
  EXPECT_THAT(file_.errors(text(), {"excitation.direction=rz"}), Contains(HasSubstr("would move nothing")));
  EXPECT_THAT(file_.errors(text(), {"excitation.influence={roof_z: 1}"}),
              Contains(HasSubstr("no degree of freedom 'roof_z'; did you mean 'roof_x'?")));
}

TEST_F(StructureSection, DampingIsAMatrixToo) {
  write("c.mtx", "%%MatrixMarket matrix coordinate real symmetric\n4 4 1\n3 3 7.0\n");
  const Scenario scenario = file_.read(text(), {"structure.damping=c.mtx"});
  EXPECT_EQ(scenario.structure.damping_n_s_per_m.nonZeros(), 1);
  EXPECT_EQ(scenario.structure.damping_n_s_per_m.coeff(2, 2), 7.0);
}

TEST_F(StructureSection, NamedDofsTakeAStiffnessFile) {
  write("storey.mtx", "%%MatrixMarket matrix array real symmetric\n2 2\n1e6\n-1e6\n1e6\n");
  const Scenario scenario = file_.read(kScenarioText, {"structure.stiffness=storey.mtx"});
  EXPECT_EQ(Eigen::MatrixXd{scenario.structure.initial_stiffness_n_per_m},
            (Eigen::MatrixXd{{8.0e6, -4.0e6}, {-4.0e6, 4.0e6}}));
  EXPECT_EQ(file_.read(kScenarioText).structure.stiffness_n_per_m.size(), 0);
}

TEST_F(StructureSection, ReportsWrongFilesAtTheirKeys) {
  write("small.mtx", "%%MatrixMarket matrix coordinate real symmetric\n2 2 1\n1 1 2e4\n");
  EXPECT_THAT(file_.errors(text(), {"structure.mass=small.mtx"}),
              Contains(HasSubstr("the matrix is 2 by 2; expected 4 by 4")));
  write("pattern.mtx", "%%MatrixMarket matrix coordinate pattern symmetric\n4 4 1\n1 1\n");
  EXPECT_THAT(
      file_.errors(text(), {"structure.stiffness=pattern.mtx"}),
      Contains(AllOf(HasSubstr("pattern.mtx:1: 'pattern' is not read"), HasSubstr("expected integer or real"))));
  EXPECT_THAT(file_.errors(text(), {"structure.mass=none.mtx"}), Contains(HasSubstr("there is no file")));
  write("wrong.csv", "node,direction\n1,x\n1,u\n");
  EXPECT_THAT(file_.errors(text(), {"structure.degrees_of_freedom=wrong.csv"}),
              Contains(HasSubstr("wrong.csv:3: 'u'")));
  write("skew.mtx",
        "%%MatrixMarket matrix coordinate real general\n4 4 5\n1 1 1e6\n2 2 1e6\n3 3 1e6\n4 4 1e6\n1 3 1e5\n");
  EXPECT_THAT(
      file_.errors(text(), {"structure.stiffness=skew.mtx"}),
      Contains(AllOf(HasSubstr("stiffness matrix is not symmetric"), HasSubstr("'1.x'"), HasSubstr("'roof_x'"))));
}

TEST_F(StructureSection, RejectsDofThatNothingHolds) {
  write("loose.mtx", "%%MatrixMarket matrix coordinate real symmetric\n4 4 2\n1 1 3e6\n2 2 5e6\n");
  EXPECT_THAT(file_.errors(text(), {"structure.stiffness=loose.mtx"}), Contains(HasSubstr("'roof_x'")));
}

TEST_F(StructureSection, UnknownAddressExplainsTheWaysToName) {
  EXPECT_THAT(
      file_.errors(text(), {"substructures[storey_2].interface=[{dof: node 9 dof 2}]"}),
      Contains(AllOf(HasSubstr("no degree of freedom 'node 9 dof 2'"), HasSubstr("node.direction such as '1.x'"))));
}

TEST_F(StructureSection, DigestDependsOnTheContentOfFiles) {
  const ScenarioDigest digest = file_.read(text()).digest;
  EXPECT_EQ(file_.read(text()).digest, digest);
  write("k.mtx",
        "%%MatrixMarket matrix coordinate real symmetric\n4 4 6\n"
        "1 1 3e6\n2 2 5e6\n3 1 -3e6\n3 3 3e6\n4 2 -5e6\n4 4 5.1e6\n");
  EXPECT_NE(file_.read(text()).digest, digest);
}

TEST_F(StructureSection, RunDirectoryHoldsTheFiles) {
  write("spring.mtx", "%%MatrixMarket matrix array real symmetric\n1 1\n6e6\n");
  const Scenario scenario = file_.read(with("model: {type: elastic, stiffness_n_per_m: 6.0e6}",
                                            "model: {type: elastic, matrix_market: spring.mtx}", text()));
  const TemporaryDirectory run;
  prepare_run_directory(run.path(), scenario);
  EXPECT_EQ(read_scenario(run / "scenario.yaml", {}).digest, scenario.digest);
  write("spring.mtx", "%%MatrixMarket matrix array real symmetric\n1 1\n7e6\n");
  EXPECT_EQ(read_scenario(run / "scenario.yaml", {}).digest, scenario.digest) << "the run has its own copy";
  EXPECT_NE(read_scenario(file_.path(), {}).digest, scenario.digest);
}

/// What the scenario accepts, the file takes: as many names of this length as are accepted.
TEST_F(StructureSection, RecordingHoldsTheDofsThatAreAccepted) {
  struct Case {
    std::size_t length;
    bool has_forces;
    std::size_t at_least;
  };
  constexpr std::size_t kRecordsMax = 20;
  for (const auto [length, has_forces, at_least] :
       {Case{3, false, 170}, Case{12, false, 170}, Case{kDofNameLongest, false, 170}, Case{3, true, 170},
        Case{kDofNameLongest, true, 150}}) {
    std::size_t accepted = 0;
    std::vector<std::string> names;
    for (const std::size_t count : {100U, 150U, 170U, 190U, 250U, 300U, 350U, 400U}) {
      names.clear();
      for (std::size_t i = 0; i < count; ++i) names.push_back(fmt::format("{:0{}}", i, length));
      config::Document tried = config::Document::parse("output: {degrees_of_freedom: [all]}", "limits");
      config::Section root = tried.root();
      static_cast<void>(read_output(root, DofTable{names}, {}, has_forces));
      if (tried.has_errors()) break;
      accepted = count;
      const TemporaryDirectory directory;
      EXPECT_NO_THROW(
          (RunFileWriter{directory / "file.h5", {}, {Coordinator::steps_layout(names, kRecordsMax, has_forces)}}))
          << count;
    }
    EXPECT_GE(accepted, at_least) << length;
    EXPECT_LT(accepted, 400U) << length;
  }
}

TEST_F(StructureSection, OutputChoosesRecordedDofs) {
  EXPECT_THAT(file_.read(text()).recorded_names(), ElementsAre("1.x", "1.y", "roof_x", "roof_y"));
  EXPECT_THAT(file_.read(text(), {"output={degrees_of_freedom: [interfaces]}"}).recorded_names(),
              ElementsAre("1.x", "1.y"));
  EXPECT_THAT(file_.read(text(), {"output={degrees_of_freedom: [2.y]}"}).recorded_names(),
              ElementsAre("1.x", "1.y", "roof_y"));
  EXPECT_THAT(file_.read(text(), {"output={degrees_of_freedom: [all]}"}).recorded_names().size(), 4);
  EXPECT_THAT(file_.errors(text(), {"output={degrees_of_freedom: [2.z]}"}),
              Contains(HasSubstr("no degree of freedom '2.z'")));
}

TEST_F(StructureSection, CondensesDofsWithoutMass) {
  write("light.mtx", "%%MatrixMarket matrix coordinate real symmetric\n4 4 3\n1 1 2e4\n2 2 2e4\n4 4 1e4\n");
  write("series.mtx",
        "%%MatrixMarket matrix coordinate real symmetric\n4 4 7\n"
        "1 1 3e6\n2 2 5e6\n3 1 -3e6\n3 3 9e6\n4 2 -5e6\n4 3 -6e6\n4 4 11e6\n");
  const std::vector<std::string> overrides{"structure.mass=light.mtx", "structure.stiffness=series.mtx",
                                           "structure.damping.modes=[1, 3]"};
  const Scenario scenario = file_.read(text(), overrides);
  EXPECT_THAT(scenario.dofs, ElementsAre("1.x", "1.y", "roof_y"));
  // 3 and 6 MN/m in series are 2 MN/m.
  EXPECT_NEAR(scenario.structure.stiffness_n_per_m.coeff(0, 0), 2.0e6, 1e-6);
  EXPECT_NEAR(scenario.structure.stiffness_n_per_m.coeff(0, 2), -2.0e6, 1e-6);
  EXPECT_NEAR(scenario.structure.stiffness_n_per_m.coeff(2, 2), 7.0e6, 1e-6);
  EXPECT_EQ(scenario.structure.influence, Eigen::Vector3d(1, 0, 0));
  std::vector<std::string> at_interface = overrides;
  at_interface.emplace_back("substructures[storey_2].interface=[{dof: node 2 dof 1}]");
  EXPECT_THAT(file_.errors(text(), at_interface),
              Contains(HasSubstr("'node 2 dof 1' has no mass and is condensed; give it a mass to use it")));
}

TEST_F(StructureSection, DofsWithAConstraintFollowOthers) {
  const std::string constraint = "structure.constraints=[{dof: roof_y, equals: {1.y: 2.0, 1.x: 0.5}}]";
  const std::string modes = "structure.damping.modes=[1, 3]";
  const Scenario scenario = file_.read(text(), {constraint, modes});
  EXPECT_THAT(scenario.dofs, ElementsAre("1.x", "1.y", "roof_x"));
  // T^T M T with the row (0.5, 2, 0) of roof_y.
  EXPECT_EQ(Eigen::MatrixXd{scenario.structure.mass_kg},
            (Eigen::MatrixXd{{2.25e4, 1e4, 0}, {1e4, 6e4, 0}, {0, 0, 1e4}}));
  EXPECT_EQ(Eigen::MatrixXd{scenario.structure.stiffness_n_per_m},
            (Eigen::MatrixXd{{4.25e6, 2.5e6, -3e6}, {2.5e6, 5e6, 0}, {-3e6, 0, 3e6}}));
  EXPECT_THAT(file_.errors(text(), {constraint, modes, "output={degrees_of_freedom: [roof_y]}"}),
              Contains(HasSubstr("'roof_y' follows others by a constraint")));
  EXPECT_THAT(file_.errors(text(), {"structure.constraints=[{dof: roof_y, equals: {1.z: 1}}]"}),
              Contains(HasSubstr("no degree of freedom '1.z'")));
}

/// A chain of many floors on the substructures, in x alone.
TEST_F(StructureSection, LargeStructureRecordsInterfacesAndTwentyMore) {
  constexpr int kFloors = 1000;
  std::string mass = "%%MatrixMarket matrix coordinate real symmetric\n1000 1000 1000\n";
  std::string stiffness = "%%MatrixMarket matrix coordinate real symmetric\n1000 1000 1999\n";
  std::string dofs = "node,direction\n";
  for (int floor = 1; floor <= kFloors; ++floor) {
    mass += fmt::format("{0} {0} 1e3\n", floor);
    stiffness += fmt::format("{0} {0} {1}e8\n", floor, floor == kFloors ? 1 : 2);
    if (floor > 1) stiffness += fmt::format("{} {} -1e8\n", floor, floor - 1);
    dofs += fmt::format("{},x\n", floor);
  }
  write("m.mtx", mass);
  write("k.mtx", stiffness);
  write("dofs.csv", dofs);
  const std::vector<std::string> overrides{"substructures[storey_2].interface=[{dof: 500.x}]",
                                           "structure.damping.modes=[1, 3]"};
  const Scenario scenario = file_.read(text(), overrides);
  const std::vector<std::string> names = scenario.recorded_names();
  EXPECT_EQ(names.size(), 21U);  // the first floor is at an interface and the first of the twenty
  EXPECT_THAT(names, AllOf(Contains("1.x"), Contains("500.x"), Contains("1000.x")));
  std::vector<std::string> all = overrides;
  all.emplace_back("output={degrees_of_freedom: [all]}");
  EXPECT_THAT(file_.errors(text(), all), Contains(AllOf(HasSubstr("1000 degrees of freedom to record"),
                                                        HasSubstr("a table of a recording holds 341:"))));
  std::vector<std::string> modal = overrides;
  modal.emplace_back("structure.damping.modes=[1, 201]");
  EXPECT_THAT(file_.errors(text(), modal), Contains(HasSubstr("the lowest 200")));
}

}  // namespace
}  // namespace hybridtest
