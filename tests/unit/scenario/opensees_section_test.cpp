#include "scenario/opensees_section.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/unit/scenario/scenario_file.hpp"

namespace hybridtest {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kLed = R"(schema: hybridtest/1
name: led
time: {mode: lockstep, step_s: 0.001, duration_s: 0.1}
coordinator:
  type: opensees
  script: model.tcl
  elements:
    - {substructure: storey_1, port: 8090, dofs: [floor_1]}
    - {substructure: storey_2, port: 8091, dofs: [floor_1, floor_2], damping_n_s_per_m: [1.0, 2.0]}
substructures:
  - id: storey_1
    kind: experimental
    interface: [{dof: floor_1}]
    initial_stiffness_n_per_m: [[4.0e6]]
    rig: {type: simulated, transfer_system: {type: ideal}, specimen: {type: elastic, stiffness_n_per_m: 4.0e6}}
    limits: {displacement_m: 0.2, velocity_m_per_s: 1.5, force_n: 150.0e3}
  - id: storey_2
    kind: numerical
    interface: [{dof: floor_2, relative_to: floor_1}]
    model: {type: elastic, stiffness_n_per_m: 3.0e6}
)";

class OpenSeesSection : public testing::Test {
 protected:
  OpenSeesSection() { std::ofstream{file_.directory() / "model.tcl"} << "# a model\n"; }
  static std::string with(const std::string& from, const std::string& to) {
    std::string text = kLed;
    text.replace(text.find(from), from.size(), to);
    return text;
  }

  ScenarioFile file_;
};

TEST_F(OpenSeesSection, ReadsElementsAndDefaults) {
  const Scenario scenario = file_.read(kLed);
  ASSERT_TRUE(scenario.opensees.has_value());
  const OpenSeesLeadScenario& lead = *scenario.opensees;
  EXPECT_EQ(lead.script, file_.directory() / "model.tcl");
  EXPECT_EQ(lead.listen_address, "127.0.0.1");
  EXPECT_EQ(lead.client_address, "127.0.0.1");
  EXPECT_FALSE(lead.allow_iterations);
  EXPECT_EQ(lead.silence, std::chrono::seconds{60});
  ASSERT_EQ(lead.elements.size(), 2U);
  EXPECT_EQ(lead.elements[1].port, 8091);
  EXPECT_THAT(lead.elements[1].dofs, ElementsAre("floor_1", "floor_2"));
  EXPECT_THAT(lead.elements[1].damping_n_s_per_m, ElementsAre(1.0, 2.0));
  EXPECT_THAT(lead.elements[0].mass_kg, ElementsAre(0.0));
  EXPECT_THAT(scenario.dofs, ElementsAre("floor_1", "floor_2"));
  EXPECT_EQ(scenario.structure.initial_stiffness_n_per_m.toDense(),
            (Eigen::Matrix2d{} << 7.0e6, -3.0e6, -3.0e6, 3.0e6).finished())
      << "of the substructures alone";
  EXPECT_FALSE(scenario.make_integrator) << "OpenSees has it";
}

TEST_F(OpenSeesSection, ScriptCountsInTheDigest) {
  const ScenarioDigest before = file_.read(kLed).digest;
  std::ofstream{file_.directory() / "model.tcl"} << "# another model\n";
  EXPECT_NE(file_.read(kLed).digest, before);
}

TEST_F(OpenSeesSection, EffectiveScenarioReadsBackTheSame) {
  const Scenario scenario = file_.read(kLed);
  EXPECT_EQ(file_.read(scenario.effective).digest, scenario.digest);
}

TEST_F(OpenSeesSection, StartedByHandNeedsNoScript) {
  const Scenario scenario = file_.read(with("script: model.tcl", "listen: 0.0.0.0\n  from: 10.1.2.3"));
  EXPECT_TRUE(scenario.opensees->script.empty());
  EXPECT_EQ(scenario.opensees->client_address, "10.1.2.3");
  EXPECT_THAT(file_.errors(with("script: model.tcl", "script: model.tcl\n  started_by_hand: true")),
              ElementsAre(HasSubstr("nothing starts it")));
}

TEST_F(OpenSeesSection, OurIntegratorLeadsWithoutOpenSees) {
  std::string text = kScenarioText;
  text.replace(text.find("integrator:"), 0, "coordinator: {type: integrator}\n");
  const Scenario scenario = file_.read(text);
  EXPECT_FALSE(scenario.opensees.has_value());
  EXPECT_TRUE(scenario.make_integrator);
}

TEST_F(OpenSeesSection, WhatOpenSeesHasMayNotBeGivenTwice) {
  EXPECT_THAT(file_.errors(std::string{kLed} + "integrator: {type: cr}\n"),
              ElementsAre(HasSubstr("is in the model of OpenSees, which leads")));
}

TEST_F(OpenSeesSection, EachSubstructureHasOneElementWithItsInterface) {
  EXPECT_THAT(file_.errors(with("{substructure: storey_1, port: 8090, dofs: [floor_1]}",
                                "{substructure: storey_3, port: 8090, dofs: [floor_1]}")),
              ElementsAre(HasSubstr("there is no substructure 'storey_3'"),
                          HasSubstr("no element for the substructure 'storey_1'")));
  EXPECT_THAT(file_.errors(with("dofs: [floor_1, floor_2], damping_n_s_per_m: [1.0, 2.0]", "dofs: [floor_2]")),
              ElementsAre(HasSubstr("the interface of 'storey_2' has the degree of freedom 'floor_1', its element has "
                                    "not")));
  EXPECT_THAT(file_.errors(with("port: 8091", "port: 8090")),
              ElementsAre(HasSubstr("port 8090 is that of another element")));
}

TEST_F(OpenSeesSection, MissingScriptIsReportedWithItsPath) {
  EXPECT_THAT(file_.errors(with("model.tcl", "modell.tcl")), ElementsAre(HasSubstr("there is no file")));
}

}  // namespace
}  // namespace hybridtest
