#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "recording/run_file_reader.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/process_cost.hpp"
#include "tests/unit/recording/temporary_directory.hpp"

/// The memory of everything that touches a recording does not grow with it.
namespace hybridtest {
namespace {

/// Of a file four times as long. One column of the additional rows alone has 3.6 MB, and a row has 35.
constexpr double kGrowthMax_mb = 3.0;

/// Both longer than one block of everything that reads in blocks.
const LongRun kShort{.duration_s = 40.0};
const LongRun kLong{.duration_s = 160.0};

class MemoryGrowth : public testing::Test {
 protected:
  void SetUp() override {
    for (const auto& named : {std::pair{kShort, "short"}, std::pair{kLong, "long"}}) {
      const std::filesystem::path folder = directory_ / named.second;
      std::filesystem::create_directory(folder);
      writing_.push_back(cost_of([&] { named.first.write(folder); }));
      ASSERT_EQ(writing_.back().exit_code, 0);
    }
  }

  /// @param command   takes a run directory.
  void expect_flat(const std::function<std::vector<std::string>(const std::string& run)>& command, int exit_code = 0) {
    std::vector<double> memory_mb;
    for (const char* run : {"short", "long"}) {
      const std::vector<std::string> words = command((directory_ / run).string());
      const ProcessCost cost = cost_of_program(words);
      ASSERT_EQ(cost.exit_code, exit_code) << words[1];
      memory_mb.push_back(cost.memory_mb);
    }
    RecordProperty("short_mb", std::to_string(memory_mb[0]));
    RecordProperty("long_mb", std::to_string(memory_mb[1]));
    EXPECT_LT(memory_mb[1] - memory_mb[0], kGrowthMax_mb) << memory_mb[0] << " MB of the shorter one";
  }

  const std::string program_ = HYBRIDTEST_PROGRAM_DIR "/hybridtest";
  TemporaryDirectory directory_;
  std::vector<ProcessCost> writing_;
};

TEST_F(MemoryGrowth, RecordingHasFlatMemory) {
  EXPECT_LT(writing_[1].memory_mb - writing_[0].memory_mb, kGrowthMax_mb) << writing_[0].memory_mb;
}

TEST_F(MemoryGrowth, FileGrowsByLittleMoreThanItsValues) {
  const auto bytes = [&](const char* run) { return std::filesystem::file_size(directory_ / run / "site.h5"); };
  // Beside the control rows, the table of the steps has two values for every fourth of them.
  const double values_per_row = LongRun::kControlColumns + 2.0 / 4.0;
  const double values = static_cast<double>(kLong.control_rows() - kShort.control_rows()) * values_per_row;
  EXPECT_LT(static_cast<double>(bytes("long") - bytes("short")), 1.01 * sizeof(double) * values);
}

TEST_F(MemoryGrowth, SummaryHasFlatMemory) {
  expect_flat([&](const std::string& run) { return std::vector{program_, std::string{"summary"}, run}; });
}

TEST_F(MemoryGrowth, ReportHasFlatMemory) {
  expect_flat([&](const std::string& run) { return std::vector{program_, std::string{"report"}, run}; });
}

TEST_F(MemoryGrowth, ExportHasFlatMemory) {
  expect_flat([&](const std::string& run) {
    return std::vector{program_, std::string{"export"}, run, std::string{"--csv"}};
  });
}

/// Shows that the measurement sees whole columns in memory.
TEST_F(MemoryGrowth, WholeColumnsAreSeenToGrow) {
  std::vector<double> memory_mb;
  for (const char* name : {"short", "long"}) {
    memory_mb.push_back(cost_of([&, file = directory_ / name / "site.h5"] {
                          const RunFileReader reader{file};
                          const std::vector<double> time_s = reader.column("control", "time_s");
                          const std::vector<double> target_m = reader.column("control", "target_displacement_m_1");
                          if (time_s.size() != target_m.size()) ::_exit(1);
                        }).memory_mb);
  }
  EXPECT_GT(memory_mb[1] - memory_mb[0], kGrowthMax_mb);
}

}  // namespace
}  // namespace hybridtest
