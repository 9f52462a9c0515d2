#include "coordinator/excitation/force_history.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config_error.hpp"

namespace hybridtest {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string refusal(const std::string& text) {
  try {
    static_cast<void>(parse_force_history(text, "forces.csv"));
  } catch (const ConfigError& error) {
    return error.what();
  }
  return {};
}

TEST(ForceHistory, ReadsAColumnForEachForce) {
  const ForceHistory found =
      parse_force_history("\xEF\xBB\xBF# wind\ntime_s,roof.x_n,floor_1_kn\n0,0,1\n0.5,10,2\n1.0,-4,3\n", "forces.csv");
  EXPECT_THAT(found.columns, ElementsAre("roof.x", "floor_1"));
  ASSERT_EQ(found.histories.size(), 2U);
  EXPECT_EQ(found.histories[0].dt_s, 0.5);
  EXPECT_THAT(found.histories[0].values, ElementsAre(0.0, 10.0, -4.0));
  EXPECT_THAT(found.histories[1].values, ElementsAre(1e3, 2e3, 3e3));
  EXPECT_EQ(found.histories[0].at(0.75), 3.0) << "linear between";
  EXPECT_EQ(found.histories[0].at(1.1), 0.0) << "zero after";
}

TEST(ForceHistory, RefusesWhatIsNoTableOfForces) {
  EXPECT_THAT(refusal(" \n"), HasSubstr("forces.csv:1: the file is empty"));
  EXPECT_THAT(refusal("0,1\n1,2\n"), HasSubstr("forces.csv:1: no line of names"));
  EXPECT_THAT(refusal("time_s,roof\n0,1\n1,2\n"),
              HasSubstr("the column 'roof' has no unit, expected a name that ends"));
  EXPECT_THAT(refusal("seconds,roof_n\n0,1\n1,2\n"), HasSubstr("expected 'time_s'"));
  EXPECT_THAT(refusal("time_s\n0\n1\n"), HasSubstr("one column, expected time_s and one or more forces"));
  EXPECT_THAT(refusal("time_s,roof_n\n0,1\n1,2,3\n"), HasSubstr("forces.csv:3: found 3 columns, expected 2"));
  EXPECT_THAT(refusal("time_s,roof_n\n0,1\n1,x\n"), HasSubstr("forces.csv:3: found 'x', expected a number"));
  EXPECT_THAT(refusal("time_s,roof_n\n0,1\n1,2\n3,2\n"),
              HasSubstr("forces.csv:4: the time is 2 s after the one before"));
  EXPECT_THAT(refusal("time_s,roof_n\n0,1\n1,1e30\n"), HasSubstr("forces.csv:3: the force is above 1e15 N"));
}

}  // namespace
}  // namespace hybridtest
