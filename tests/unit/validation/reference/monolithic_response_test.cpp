#include "validation/reference/monolithic_response.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <ostream>
#include <string>
#include <vector>

#include "core/config_error.hpp"
#include "tests/support/reference_history.hpp"

/// The test without coupling against histories that OpenSees computed (tests/reference), under the whole shipped
/// motion.
namespace hybridtest {
namespace {

using ::testing::HasSubstr;
using ::testing::Property;
using ::testing::ThrowsMessage;

struct Building {
  std::string reference;
  std::string scenario;
  std::vector<std::string> overrides;
  double tolerance;  // largest difference over the peak of the floor
};

void PrintTo(const Building& building, std::ostream* stream) { *stream << building.reference; }

Scenario shipped(const std::string& name, const std::vector<std::string>& overrides = {}) {
  return read_scenario(std::filesystem::path{HYBRIDTEST_SOURCE_DIR} / "launch" / "scenarios" / (name + ".yaml"),
                       overrides);
}

double largest_difference(const Building& building, const Scenario& scenario) {
  const ReferenceHistory reference = read_reference(committed_reference(building.reference));
  const ReferenceResponse response = monolithic_response(scenario);
  double largest = 0.0;
  for (std::size_t floor = 0; floor < reference.displacement_m.size(); ++floor) {
    const Eigen::RowVectorXd found = response.displacement_m.row(static_cast<Eigen::Index>(floor));
    largest = std::max(largest,
                       largest_share(reference.displacement_m[floor], std::vector<double>(found.begin(), found.end())));
  }
  return largest;
}

class Monolithic : public testing::TestWithParam<Building> {};

TEST_P(Monolithic, AgreesWithOpenSees) {
  const double found = largest_difference(GetParam(), shipped(GetParam().scenario, GetParam().overrides));
  RecordProperty("largest_difference", std::to_string(found));
  EXPECT_LE(found, GetParam().tolerance);
}

// The references have a step of 0.0001 s: the error of average acceleration at 0.001 s is what is left.
INSTANTIATE_TEST_SUITE_P(
    ShippedBuildings, Monolithic,
    testing::Values(Building{"two_storey_linear",
                             "two_storey_one_site",
                             {"substructures[storey_1].rig.specimen={type: elastic, stiffness_n_per_m: 4.0e6}"},
                             2e-4},
                    Building{"two_storey_bilinear", "two_storey_one_site", {}, 2e-4},
                    Building{"three_storey_base_isolated", "three_storey_base_isolated", {}, 2e-4},
                    Building{"isolated_with_dampers", "isolated_with_dampers", {}, 2e-4}),
    [](const auto& instance) { return instance.param.reference; });

TEST(MonolithicResponse, ControlWrongStiffnessIsSeen) {
  const Building building{"two_storey_bilinear", "two_storey_one_site", {}, 0.0};
  EXPECT_GT(largest_difference(
                building, shipped("two_storey_one_site", {"substructures[storey_2].model.stiffness_n_per_m=3.03e6"})),
            1e-3);
}

TEST(MonolithicResponse, ErrorFallsWithTheSquareOfTheStep) {
  const std::string elastic = "substructures[storey_1].rig.specimen={type: elastic, stiffness_n_per_m: 4.0e6}";
  const auto at_step = [&](const char* step_s) {
    return monolithic_response(shipped("two_storey_one_site", {elastic, std::string{"time.step_s="} + step_s}));
  };
  const ReferenceResponse coarse = at_step("0.002");
  const ReferenceResponse middle = at_step("0.001");
  const ReferenceResponse fine = at_step("0.000125");
  double of_coarse = 0.0;
  double of_middle = 0.0;
  for (Eigen::Index i = 0; i < coarse.displacement_m.cols(); ++i) {
    of_coarse += (coarse.displacement_m.col(i) - fine.displacement_m.col(16 * i)).squaredNorm();
    of_middle += (middle.displacement_m.col(2 * i) - fine.displacement_m.col(16 * i)).squaredNorm();
  }
  // The error of `fine` itself is 1/64 of that of `middle`.
  EXPECT_NEAR(std::log2(std::sqrt(of_coarse / of_middle)), 2.0, 0.05);
}

TEST(MonolithicResponse, SiteWithoutAKnownSpecimenIsRefused) {
  EXPECT_THAT(
      [] {
        static_cast<void>(monolithic_response(
            shipped("two_storey_one_site",
                    {"substructures[storey_1].rig={type: udp, host: 127.0.0.1, port: 9000}", "time.mode=paced"})));
      },
      ThrowsMessage<ConfigError>(HasSubstr("the specimen of the site 'storey_1' is not known")));
}

TEST(MonolithicResponse, OpenSeesThatLeadsIsRefused) {
  EXPECT_THAT([] { static_cast<void>(monolithic_response(shipped("opensees/shear_frame"))); },
              ThrowsMessage<ConfigError>(HasSubstr("OpenSees leads this test")));
}

}  // namespace
}  // namespace hybridtest
