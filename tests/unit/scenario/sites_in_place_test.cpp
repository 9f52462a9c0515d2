#include "scenario/sites_in_place.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "scenario/site_model_file.hpp"
#include "tests/unit/scenario/scenario_file.hpp"

namespace hybridtest {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr const char* kSite =
    "name: storey\n"
    "transfer_system: {type: second_order, natural_frequency_hz: 15.0, damping_ratio: 0.9, delay_s: 0.004}\n"
    "specimen: {type: bilinear, stiffness_n_per_m: 4.0e6, yield_force_n: 40.0e3, hardening_ratio: 0.05}\n"
    "sensors: {displacement_noise_m: 1.0e-5, force_noise_n: 50.0, seed: 7}\n"
    "effects:\n  - {interface: specimen, effect: coulomb_friction, friction_force_n: 512.0}\n";

class SitesInPlace : public testing::Test {
 protected:
  void write_site(const std::string& text) { std::ofstream{file_.directory() / "site.yaml"} << text; }

  ScenarioFile file_;
};

const std::string kRigOfFile = "substructures[storey_1].rig={type: simulated, model: site.yaml}";

TEST_F(SitesInPlace, RigFromFileEqualsInlineRig) {
  write_site(kSite);
  const Scenario from_file = file_.read(kScenarioText, {kRigOfFile});
  const Scenario written_out =
      file_.read(kScenarioText, {"substructures[storey_1].rig.effects=[{interface: specimen, effect: coulomb_friction, "
                                 "friction_force_n: 512.0}]"});
  EXPECT_EQ(from_file.effective, written_out.effective);
  EXPECT_EQ(from_file.digest, written_out.digest);
  EXPECT_THAT(from_file.effective, Not(HasSubstr("site.yaml"))) << "a run directory needs no other file";
  EXPECT_EQ(file_.read(from_file.effective).effective, from_file.effective);
}

TEST_F(SitesInPlace, OmittedPartsAreIdeal) {
  write_site("specimen: {type: elastic, stiffness_n_per_m: 4.0e6}\n");
  const Scenario scenario = file_.read(kScenarioText, {kRigOfFile});
  EXPECT_THAT(scenario.effective, HasSubstr("type: ideal"));
  EXPECT_EQ(scenario.find("storey_1")->site.delays.at(0).transfer_s, 0.0);
}

TEST_F(SitesInPlace, DiagnosisReadsModelBesideRig) {
  write_site("name: mine\nspecimen: {type: elastic, stiffness_n_per_m: 3.0e6}\n");
  EXPECT_FALSE(file_.read().find("storey_1")->site.has_model);
  for (const char* model : {"site.yaml", "{specimen: {type: elastic, stiffness_n_per_m: 3.0e6}}"}) {
    const Scenario scenario = file_.read(kScenarioText, {std::string{"substructures[storey_1].model="} + model});
    EXPECT_TRUE(scenario.find("storey_1")->site.has_model);
    std::ofstream{file_.directory() / "effective.yaml"} << scenario.effective;
    const SiteModelFile site = read_site_model(file_.directory() / "effective.yaml", "storey_1");
    ASSERT_EQ(site.dofs.size(), 1U);
    EXPECT_EQ(site.dofs[0].make_law()->initial_stiffness_n_per_m(), 3.0e6) << "the model, not the rig beside it";
  }
}

/// The site's compensator is 23 ms; a correction found beside another one would be counted in addition.
TEST_F(SitesInPlace, CorrectionNeedsTheCompensatorItWasFoundBeside) {
  const std::string correction =
      "effects: [{interface: compensator, effect: setting_mismatch, delay_error_s: 0.002}]\n";
  const auto refused = [&](const std::string& file) {
    write_site(file);
    return testing::Value(file_.errors(kScenarioText, {kRigOfFile}),
                          testing::Contains(HasSubstr("corrects the compensator that the file names")));
  };
  EXPECT_TRUE(refused(correction));
  EXPECT_TRUE(refused("compensator: {type: polynomial_displacement, order: 3, delay_s: 0.01}\n" + correction));
  EXPECT_FALSE(refused("compensator: {type: polynomial_displacement, delay_s: 0.01}\n"));
  const std::string own = compensators_of_site(file_.directory() / "scenario.yaml", "storey_1");
  EXPECT_FALSE(refused("compensator:\n" + own + correction));
}

TEST_F(SitesInPlace, ReportsErrorsWithTheirPlace) {
  write_site("specimen: {type: elastic, stiffness_n_per_m: -1}\n");
  EXPECT_THAT(file_.errors(kScenarioText, {kRigOfFile}), testing::Contains(HasSubstr("site.yaml:1")));
  EXPECT_THAT(file_.errors(kScenarioText, {"substructures[storey_1].rig={model: nowhere.yaml}"}),
              testing::Contains(HasSubstr("nowhere.yaml")));
  write_site(kSite);
  EXPECT_THAT(file_.errors(kScenarioText, {"substructures[storey_1].rig.model=site.yaml"}),
              testing::Contains(HasSubstr("has no keys of its own")));
  EXPECT_THAT(file_.errors(kScenarioText, {"substructures[storey_1].model={specimen: {type: elastik}}"}),
              testing::Contains(HasSubstr("did you mean 'elastic'?")));
}

}  // namespace
}  // namespace hybridtest
