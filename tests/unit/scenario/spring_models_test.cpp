#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/scenario/scenario_file.hpp"

/// Springs of a numerical substructure, as a scenario places them.
namespace hybridtest {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

class SpringModels : public testing::Test {
 protected:
  static std::string with_springs(const std::string& springs) {
    std::string text = kScenarioText;
    const auto storey = text.find("    interface: [{dof: floor_2, relative_to: floor_1}]");
    return text.substr(0, storey) +
           "    interface: [{dof: floor_1}, {dof: floor_2}]\n    model: {type: springs, springs: " + springs + "}\n";
  }
  [[nodiscard]] Eigen::MatrixXd stiffness(const std::string& springs) const {
    return file_.read(with_springs(springs)).find("storey_2")->initial_stiffness_n_per_m;
  }

  ScenarioFile file_;
};

TEST_F(SpringModels, ActAtBetweenAndAlong) {
  const Eigen::MatrixXd found = stiffness(
      "[{at: floor_1, law: {type: elastic, stiffness_n_per_m: 100}},"
      " {between: [floor_2, floor_1], law: {type: elastic, stiffness_n_per_m: 20}},"
      " {between: [floor_2, floor_1], law: {type: viscous, damping_n_s_per_m: 5.0}},"
      " {elongation: {floor_2: 0.6, floor_1: -0.6}, law: {type: elastic, stiffness_n_per_m: 1000}}]");
  EXPECT_TRUE(found.isApprox(Eigen::Matrix2d{{480.0, -380.0}, {-380.0, 380.0}}, 1e-12)) << found;
}

TEST_F(SpringModels, LawsAloneActOnTheGroundInOrder) {
  const Eigen::MatrixXd found =
      stiffness("[{type: elastic, stiffness_n_per_m: 100}, {type: elastic, stiffness_n_per_m: 20}]");
  EXPECT_EQ(found, (Eigen::Matrix2d{{100.0, 0.0}, {0.0, 20.0}}));
}

TEST_F(SpringModels, EffectiveScenarioReadsBackTheSame) {
  const Scenario first = file_.read(
      with_springs("[{elongation: {floor_2: 0.6, floor_1: -0.6}, law: {type: elastic, stiffness_n_per_m: 1000}}]"));
  const Scenario again = file_.read(first.effective);
  EXPECT_EQ(again.digest, first.digest);
}

TEST_F(SpringModels, SayWhatIsWrongWithThePlace) {
  const std::string law = "law: {type: elastic, stiffness_n_per_m: 100}";
  const std::string sound = "{between: [floor_2, floor_1], " + law + "}";
  const auto errors = [&](const std::string& spring) {
    return file_.errors(with_springs("[" + sound + ", " + spring + "]"));
  };
  EXPECT_THAT(errors(sound), IsEmpty());
  EXPECT_THAT(errors("{at: floor_3, " + law + "}"), Contains(HasSubstr("did you mean")));
  EXPECT_THAT(errors("{at: chimney, " + law + "}"),
              Contains(HasSubstr("'chimney' is not at the interface of this substructure; expected one of floor_1, "
                                 "floor_2, or add it to `interface`")));
  EXPECT_THAT(errors("{between: [floor_1], " + law + "}"), Contains(HasSubstr("expected two degrees of freedom")));
  EXPECT_THAT(errors("{" + law + "}"), Contains(HasSubstr("expected where the spring acts")));
  EXPECT_THAT(errors("{at: floor_1, between: [floor_2, floor_1], " + law + "}"),
              Contains(HasSubstr("one of the three")));
  EXPECT_THAT(errors("{at: floor_1}"), Contains(HasSubstr("law")));
  EXPECT_THAT(errors("{type: elastic, stiffness_n_per_m: 100}"), Contains(HasSubstr("law")));
  EXPECT_THAT(errors("{elongation: {floor_1: 0.0}, " + law + "}"), Contains(HasSubstr("spring 2 has the factor")));
  EXPECT_THAT(file_.errors(with_springs("[{at: floor_1, " + law + "}]")),
              Contains(HasSubstr("no spring acts on degree of freedom 2")));
}

}  // namespace
}  // namespace hybridtest
