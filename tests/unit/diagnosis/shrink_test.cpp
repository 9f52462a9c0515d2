#include "diagnosis/verdict/shrink.hpp"

#include <gtest/gtest.h>

#include <array>

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
  shrink.variance_removed = 0.5 * (removed.low + removed.high);
  shrink.ci95 = removed;
  return shrink;
}

Verdict carried_over(Verdict verdict, const Shrink& one, const VerdictPolicy& policy = {}) {
  return verdict_carried_over(verdict, std::array{one}, policy);
}

TEST(CarryingOver, DropsCauseThatDoesNotReduceTheGap) {
  for (const Verdict verdict : {Verdict::named, Verdict::set, Verdict::partial}) {
    EXPECT_EQ(carried_over(verdict, removing({-0.4, 0.2})), Verdict::unknown);
    EXPECT_EQ(carried_over(verdict, removing({-0.4, 0.2}, 0.015)), Verdict::none) << "there is hardly a gap";
    EXPECT_EQ(carried_over(verdict, removing({0.66, 0.8})), verdict) << "it may well carry over";
    EXPECT_EQ(carried_over(verdict, removing({0.45, 0.65})), Verdict::unknown) << "of a gap ten times its floor";
    EXPECT_EQ(carried_over(verdict, removing({0.45, 0.65}, 0.018)), verdict) << "no more can be explained";
    EXPECT_EQ(carried_over(verdict, removing({0.29, 0.43}, 0.0135)), verdict) << "nor here, less than a half";
    EXPECT_EQ(carried_over(verdict, removing({0.05, 0.25}, 0.0135)), Verdict::none) << "of 45 % that can";
    EXPECT_EQ(carried_over(verdict, removing({0.97, 0.99})), verdict);
    EXPECT_EQ(carried_over(verdict, removing({-0.01, 0.01}, 0.1, 0.0005)), verdict)
        << "a stroke limit that is not reached there";
  }
  EXPECT_EQ(carried_over(Verdict::unknown, removing({-0.4, 0.2}, 0.015)), Verdict::unknown);
}

TEST(CarryingOver, DropsCauseThatActsWhereThereIsNoGap) {
  for (const Verdict verdict : {Verdict::named, Verdict::set}) {
    EXPECT_EQ(carried_over(verdict, removing({-0.2, -0.05}, 0.009)), Verdict::none)
        << "certainly further from the model";
    EXPECT_EQ(carried_over(verdict, removing({-0.2, 0.05}, 0.009)), verdict) << "control: not certainly";
  }
}

TEST(CarryingOver, PartThatLeavesMostOfTheGapIsNone) {
  const Shrink likely_more = removing({-0.13, 0.715});
  EXPECT_EQ(carried_over(Verdict::set, likely_more), Verdict::set) << "not certainly";
  EXPECT_EQ(carried_over(Verdict::partial, likely_more), Verdict::unknown);
  EXPECT_EQ(carried_over(Verdict::partial, likely_more, {.partial_leaves = 0.8}), Verdict::partial) << "allowed";
  Shrink named = likely_more;
  named.unknown_share = 0.7;
  named.nrmse_after = 0.08;
  EXPECT_EQ(carried_over(Verdict::named, named), Verdict::unknown);
}

TEST(CarryingOver, DropsCauseThatMakesTheGapLarger) {
  // One block in which the model runs away makes the interval wide.
  Shrink shrink = removing({-60.0, 0.98});
  shrink.nrmse_after = 0.12;
  EXPECT_EQ(carried_over(Verdict::set, shrink), Verdict::unknown);
  shrink.nrmse_after = 0.1004;  // by less than the floor, sqrt(0.1^2 + 0.01^2) = 0.1005
  EXPECT_EQ(carried_over(Verdict::set, shrink), Verdict::set);
}

TEST(CarryingOver, KeepsCauseOfOneChannelDespiteOtherChannel) {
  const Shrink explained = removing({0.98, 0.99});
  const Shrink not_explained = removing({0.1, 0.2});
  EXPECT_EQ(verdict_carried_over(Verdict::named, std::array{explained, not_explained}), Verdict::named);
  EXPECT_EQ(verdict_carried_over(Verdict::named, std::array{not_explained, not_explained}), Verdict::unknown);
  EXPECT_EQ(verdict_carried_over(Verdict::named, {}), Verdict::named);
}

TEST(CarryingOver, WhatStaysAboveTheFloorIsAPart) {
  const auto leaving = [](double share, double floors) {
    Shrink shrink = removing({0.9, 0.999});
    shrink.unknown_share = share;
    shrink.nrmse_after = floors * shrink.floor_nrmse;
    return shrink;
  };
  EXPECT_EQ(carried_over(Verdict::named, leaving(0.04, 1.9)), Verdict::named) << "at the floor";
  EXPECT_EQ(carried_over(Verdict::named, leaving(0.002, 2.1)), Verdict::partial) << "however large the gap was";
  EXPECT_EQ(carried_over(Verdict::named, leaving(0.002, 2.1), {.named_leaves = 0.01}), Verdict::named) << "allowed";
  EXPECT_EQ(carried_over(Verdict::named, leaving(0.02, 2.1), {.named_leaves = 0.01}), Verdict::partial);
}

/// Without noise the floor is what no model is expected to reproduce: 0.05 % of the output.
TEST(CarryingOver, ComputedSignalsHaveAFloor) {
  const auto leaving = [](double nrmse) {
    Shrink shrink = removing({0.9, 0.999}, 0.1, 0.05);
    shrink.floor_nrmse = 0.0;
    shrink.unknown_share = 0.01;
    shrink.nrmse_after = nrmse;
    return shrink;
  };
  EXPECT_EQ(carried_over(Verdict::named, leaving(0.00099)), Verdict::named);
  EXPECT_EQ(carried_over(Verdict::named, leaving(0.00101)), Verdict::partial);
}

}  // namespace
}  // namespace hybridtest
