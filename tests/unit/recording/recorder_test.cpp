#include "recording/recorder.hpp"

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/resource.h>

#include "recording/recorder_thread.hpp"
#include "recording/run_file_reader.hpp"
#include "tests/unit/recording/forked_child.hpp"
#include "tests/unit/recording/run_file_fixture.hpp"
#include "tests/unit/recording/temporary_directory.hpp"

namespace hybridtest {
namespace {

TEST(Recorder, WritesRowsAndEventsOfEverySource) {
  const TemporaryDirectory directory;
  const auto path = directory / "a.h5";
  {
    Recorder recorder{path, example_header(), {{example_layout(), 100}, {{"control", {{"sample", "-"}}}, 10}}, 2};
    RowSink& steps = recorder.sink("steps");
    for (std::size_t i = 0; i < 1000; ++i) {
      steps.append(example_row(i));
      if (recorder.should_drain()) recorder.drain();
    }
    recorder.sink("control").append(std::array{7.0});
    recorder.events(0).send(example_event());
    recorder.events(1).send(Event{});
    recorder.close();
    recorder.close();
    EXPECT_FALSE(recorder.failed());
    EXPECT_EQ(recorder.error_text(), "");
    EXPECT_EQ(recorder.dropped(), 0U);
  }
  const RunFileReader reader{path};
  EXPECT_EQ(reader.row_count("steps"), 1000U);
  EXPECT_EQ(wrong_rows(reader.rows("steps", 0, 1000)), 0U);
  EXPECT_EQ(reader.column("control", "sample"), std::vector{7.0});
  ASSERT_EQ(reader.events().size(), 2U);
  EXPECT_EQ(reader.events()[0].event, example_event());
  EXPECT_EQ(reader.events()[0].text, "interlock: displacement_limit (observed 0.1234 m, limit 0.12 m)");
  EXPECT_TRUE(reader.counters().closed_cleanly);
}

TEST(Recorder, WritesDropCountsToTheFile) {
  const TemporaryDirectory directory;
  const auto path = directory / "a.h5";
  {
    Recorder recorder{path, example_header(), {{example_layout(), 16}}, 1, 4};
    for (std::size_t i = 0; i < 21; ++i) recorder.sink("steps").append(example_row(i));
    for (int i = 0; i < 6; ++i) recorder.events().send(example_event());
    recorder.drain();
    EXPECT_EQ(recorder.dropped(), 7U);
  }
  const RunFileReader reader{path};
  EXPECT_EQ(reader.counters().tables[0], (TableCounter{"steps", 16, 5}));
  EXPECT_EQ(reader.counters().tables[1], (TableCounter{"events", 4, 2}));
}

/// Appends far more than the disk takes, draining as it goes.
/// @return whether the recorder behaved as promised.
bool survives_full_disk(const std::filesystem::path& path, const std::string& reason) {
  Recorder recorder{path, example_header(), {{example_layout(), 1000}}};
  const rlimit limit{200'000, 200'000};
  if (reason == "File too large") ::setrlimit(RLIMIT_FSIZE, &limit);
  constexpr std::size_t kRows = 50'000;
  for (std::size_t i = 0; i < kRows; ++i) {
    recorder.sink("steps").append(example_row(i));
    if (recorder.should_drain()) recorder.drain();
  }
  recorder.drain();
  if (!recorder.failed() || recorder.error_text().find(reason) == std::string::npos) return false;
  recorder.close();
  const RunFileReader reader{path};
  const std::size_t kept = reader.row_count("steps");
  return kept > 0 && kept < kRows && wrong_rows(reader.rows("steps", 0, kept)) == 0 &&
         recorder.dropped() == kRows - kept && reader.counters().dropped_rows() == kRows - kept &&
         reader.counters().write_failed && !reader.counters().closed_cleanly;
}

TEST(Recorder, CountsRowsLostToFileSizeLimit) {
  const TemporaryDirectory directory;
  ForkedChild child{[&](const ForkedChild& self) {
    ::signal(SIGXFSZ, SIG_IGN);
    self.report(survives_full_disk(directory / "a.h5", "File too large") ? 1 : 2);
  }};
  EXPECT_EQ(child.hear(), 1U);
  EXPECT_EQ(child.wait(), 0);
}

TEST(Recorder, CountsRowsLostToFullDisk) {
  const TemporaryDirectory directory;
  ForkedChild child{[&](const ForkedChild& self) {
    // A file system of 256 KiB that only this child sees.
    const bool mounted = ::unshare(CLONE_NEWNS) == 0 &&
                         ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
                         ::mount("tmpfs", directory.path().c_str(), "tmpfs", 0, "size=256k") == 0;
    self.report(!mounted ? 3 : survives_full_disk(directory / "a.h5", "No space left on device") ? 1 : 2);
  }};
  const std::uint64_t answer = child.hear();
  EXPECT_EQ(child.wait(), 0);
  if (answer == 3) GTEST_SKIP() << "mounting a small file system needs root";
  EXPECT_EQ(answer, 1U);
}

TEST(RecorderThread, WritesEverythingBeforeItStops) {
  const TemporaryDirectory directory;
  const auto path = directory / "a.h5";
  Recorder recorder{path, example_header(), {{example_layout(), 100'000}}};
  RecorderThread thread{recorder};
  for (std::size_t i = 0; i < 50'000; ++i) recorder.sink("steps").append(example_row(i));
  thread.stop();
  EXPECT_EQ(recorder.dropped(), 0U);
  const RunFileReader reader{path};
  EXPECT_EQ(reader.row_count("steps"), 50'000U);
  EXPECT_EQ(wrong_rows(reader.rows("steps", 0, 50'000)), 0U);
  EXPECT_TRUE(reader.counters().closed_cleanly);
}

}  // namespace
}  // namespace hybridtest
