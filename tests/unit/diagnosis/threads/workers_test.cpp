#include "diagnosis/workers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace hybridtest {
namespace {

using testing::Each;

TEST(Workers, RunEachPieceOfWorkOnce) {
  for (const std::size_t threads : {0, 1, 2, 5}) {
    const Workers workers{threads};
    for (const std::size_t count : {0, 1, 2, 100}) {
      std::vector<int> runs(count);
      workers.for_each(count, [&](std::size_t i) { ++runs[i]; });
      EXPECT_THAT(runs, Each(1)) << threads << " threads, " << count << " pieces";
    }
  }
}

TEST(Workers, OneIsTheCallingThread) {
  for (const Workers& workers : {Workers{}, Workers{1}}) {
    workers.for_each(
        3, [caller = std::this_thread::get_id()](std::size_t) { EXPECT_EQ(std::this_thread::get_id(), caller); });
  }
}

TEST(Workers, RunWorkWithinWork) {
  const Workers workers{3};
  std::vector<std::vector<int>> runs(7, std::vector<int>(11));
  workers.for_each(runs.size(),
                   [&](std::size_t i) { workers.for_each(runs[i].size(), [&](std::size_t j) { ++runs[i][j]; }); });
  for (const std::vector<int>& inner : runs) EXPECT_THAT(inner, Each(1));
}

// Without help the work never ends: whichever thread does the long piece, the other one has nothing to do.
TEST(Workers, OneWithNothingToDoHelpsWithWorkWithinWork) {
  const Workers workers{2};
  workers.for_each(2, [&](std::size_t i) {
    if (i == 0) return;
    const std::thread::id own = std::this_thread::get_id();
    std::atomic<bool> is_helped = false;
    while (!is_helped) {
      workers.for_each(2, [&](std::size_t) {
        if (std::this_thread::get_id() != own) is_helped = true;
      });
    }
  });
}

TEST(Workers, ThrowWhatTheFirstPieceThrowsWhenTheOthersAreDone) {
  const Workers workers{3};
  std::vector<int> runs(20);
  try {
    workers.for_each(runs.size(), [&](std::size_t i) {
      ++runs[i];
      if (i >= 4) throw std::runtime_error{std::to_string(i)};
    });
    FAIL() << "nothing was thrown";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "4");
  }
  EXPECT_THAT(runs, Each(1));
}

}  // namespace
}  // namespace hybridtest
