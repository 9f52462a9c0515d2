#include "diagnosis/verdict/carrying_over.hpp"

#include <gtest/gtest.h>

namespace hybridtest {
namespace {

using report::Interval;
using report::Shrink;
using report::Verdict;

Shrink removing(Interval removed, double before = 0.1, double changed = 0.08) {
  Shrink shrink;
  shrink.nrmse_before = before;
  shrink.floor_nrmse = 0.01;
  shrink.changed_nrmse = changed;
  shrink.ci95 = removed;
  return shrink;
}

TEST(CarryingOver, ACauseThatSurelyLeavesTheGapIsNotNamed) {
  for (const Verdict verdict : {Verdict::named, Verdict::set, Verdict::partial}) {
    EXPECT_EQ(verdict_carried_over(verdict, removing({-0.4, 0.2})), Verdict::unknown);
    EXPECT_EQ(verdict_carried_over(verdict, removing({-0.4, 0.2}, 0.015)), Verdict::none) << "there is hardly a gap";
    EXPECT_EQ(verdict_carried_over(verdict, removing({-0.4, 0.6})), verdict) << "it may well carry over";
    EXPECT_EQ(verdict_carried_over(verdict, removing({0.97, 0.99})), verdict);
    EXPECT_EQ(verdict_carried_over(verdict, removing({-0.01, 0.01}, 0.1, 0.0005)), verdict)
        << "a stroke limit that is not reached there";
  }
  EXPECT_EQ(verdict_carried_over(Verdict::unknown, removing({-0.4, 0.2}, 0.015)), Verdict::unknown);
}

}  // namespace
}  // namespace hybridtest
