#include "validation/reference/opensees_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "core/config_error.hpp"

namespace hybridtest {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

std::filesystem::path source(const std::string& name) { return std::filesystem::path{HYBRIDTEST_SOURCE_DIR} / name; }

std::string model_of(const std::string& name, const std::vector<std::string>& overrides = {}) {
  return opensees_model(read_scenario(source("launch/scenarios/" + name + ".yaml"), overrides), "out.txt");
}

TEST(OpenSeesModel, HasEachLawOnceAsAMaterial) {
  const std::string text = model_of("two_storey_one_site");
  EXPECT_THAT(
      text, AllOf(HasSubstr("uniaxialMaterial Steel01 1 40000 4000000 0.05"),
                  HasSubstr("element zeroLength 1 0 1 -mat 1 -dir 1"), HasSubstr("uniaxialMaterial Elastic 2 3000000"),
                  HasSubstr("node 2 0.0 -mass 20000"), HasSubstr("load 1 -20000")));
}

TEST(OpenSeesModel, LawWithoutCounterpartIsNamedWithThoseThatHaveOne) {
  const auto write = [] {
    static_cast<void>(model_of("two_storey_one_site",
                               {"substructures[storey_1].rig.specimen={type: elastomer, stiffness_n_per_m: 4.0e6}"}));
  };
  EXPECT_THAT(write, ThrowsMessage<ConfigError>(
                         AllOf(HasSubstr("storey_1: the law elastomer has no counterpart in OpenSees"),
                               HasSubstr("bilinear, giuffre_menegotto_pinto"), HasSubstr("without --with opensees"))));
}

TEST(OpenSeesModel, ParametersWithoutCounterpartAreRefused) {
  const auto write = [] {
    static_cast<void>(
        model_of("two_storey_one_site",
                 {"substructures[storey_1].rig.specimen={type: lead_rubber, rubber_stiffness_n_per_m: 1.0e6, "
                  "lead_strength_n: 4.0e4, yield_displacement_m: 0.01, heating_path_m: 1.0}"}));
  };
  EXPECT_THAT(write, ThrowsMessage<ConfigError>(HasSubstr("no counterpart with these parameters")));
}

TEST(OpenSeesModel, InitialMotionIsRefused) {
  const auto write = [] {
    static_cast<void>(model_of("two_storey_one_site",
                               {"excitation={free_vibration: {displacement_m: {floor_1: 0.001, floor_2: 0.002}, "
                                "ramp_s: 2.0}}"}));
  };
  EXPECT_THAT(write, ThrowsMessage<ConfigError>(HasSubstr("excitation.free_vibration")));
}

TEST(OpenSeesModel, MassBetweenDegreesOfFreedomIsRefused) {
  const auto write = [] {
    static_cast<void>(
        model_of("two_storey_one_site",
                 {"structure={degrees_of_freedom: [floor_1, floor_2], mass_matrix_kg: [[2.0e4, 1.0e3], [1.0e3, "
                  "2.0e4]], damping: {type: none}}"}));
  };
  EXPECT_THAT(write, ThrowsMessage<ConfigError>(HasSubstr("mass between 'floor_1' and 'floor_2'")));
}

TEST(OpenSeesModel, LawsAreThoseOfTheDocument) {
  std::ifstream file{source("docs/opensees.md")};
  const std::string document{std::istreambuf_iterator<char>{file}, {}};
  for (const std::string_view law : laws_with_counterpart()) {
    EXPECT_THAT(document, HasSubstr("| `" + std::string{law} + "` |"));
  }
}

}  // namespace
}  // namespace hybridtest
