#include "validation/studies/rths_benchmark/rths_tables.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hybridtest::rths {
namespace {

TEST(RthsTables, WritesCriteriaWithTheirColumns) {
  const std::vector<Candidate> candidates = chosen_candidates({"newmark_kinematics+pi"});
  StudyRun complete{.candidate = 0, .case_number = 2, .motion = 1, .plant = 0, .result = {}, .is_excused = false};
  complete.result.is_complete = true;
  complete.result.criteria.values = {0.25, 2, 3, 4, 5, 6, 7, 8, 9.12345};
  complete.result.peak_force_n = 4321.04;
  StudyRun lost{.candidate = 0, .case_number = 4, .motion = 2, .plant = 20, .result = {}, .is_excused = false};
  lost.result.criteria = no_criteria();
  lost.result.peak_force_n = 13400.0;
  EXPECT_EQ(
      criteria_csv(candidates, std::vector{complete, lost}),
      "compensator,case,motion,plant,J1,J2,J3,J4,J5,J6,J7,J8,J9,peak_force_n\n"
      "newmark_kinematics+pi,2,kobe,nominal,0.2500,2.0000,3.0000,4.0000,5.0000,6.0000,7.0000,8.0000,9.1235,4321.0\n"
      "newmark_kinematics+pi,4,morgan,20,nan,nan,nan,nan,nan,nan,nan,nan,nan,13400.0\n");
}

}  // namespace
}  // namespace hybridtest::rths
