#include "recording/run_file_writer.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>

#include <cstdlib>
#include <fstream>

#include "recording/error.hpp"
#include "recording/run_file_reader.hpp"
#include "tests/unit/recording/forked_child.hpp"
#include "tests/unit/recording/run_file_fixture.hpp"
#include "tests/unit/recording/temporary_directory.hpp"

namespace hybridtest {
namespace {

void append_rows(RunFileWriter& writer, std::size_t first, std::size_t count) {
  std::vector<double> rows;
  for (std::size_t i = first; i < first + count; ++i) {
    const auto row = example_row(i);
    rows.insert(rows.end(), row.begin(), row.end());
  }
  writer.append(0, rows);
}

bool program_runs(const std::string& command) { return std::system((command + " > /dev/null 2>&1").c_str()) == 0; }

/// Writes rows for ever, reporting how many are flushed.
void write_for_ever(const ForkedChild& child, const std::filesystem::path& path) {
  RunFileWriter writer{path, example_header(), {example_layout()}};
  // A number of rows that is no divisor of a chunk, so that chunks are always partly filled.
  for (std::size_t rows = 0;; rows += 777) {
    append_rows(writer, rows, 777);
    writer.flush();
    child.report(rows + 777);
  }
}

TEST(RunFileWriter, ControlDetectsWrongRow) {
  std::vector<double> rows;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto row = example_row(i);
    rows.insert(rows.end(), row.begin(), row.end());
  }
  EXPECT_EQ(wrong_rows(rows), 0U);
  rows[5] = 0.0;
  EXPECT_EQ(wrong_rows(rows), 1U);
}

TEST(RunFileWriter, WrittenRowsAreReadBack) {
  const TemporaryDirectory directory;
  const auto path = directory / "storey_1.h5";
  {
    RunFileWriter writer{path, example_header(), {example_layout(), {"control", {{"sample", "-"}}}}};
    append_rows(writer, 0, 10);
    writer.append(1, std::vector{5.0, 6.0});
    append_rows(writer, 10, 5000);
    const std::vector events{example_event(), Event{}};
    writer.append_events(events, std::vector<std::string>{"Grenzwert überschritten", ""});
    writer.set_dropped(1, 3);
    writer.close();
  }
  RunFileReader reader{path};
  EXPECT_EQ(reader.header(), example_header());
  ASSERT_EQ(reader.tables().size(), 2U);
  EXPECT_EQ(reader.tables()[0], example_layout());
  EXPECT_EQ(reader.row_count("steps"), 5010U);
  EXPECT_EQ(wrong_rows(reader.rows("steps", 0, 9999)), 0U);
  EXPECT_EQ(reader.column("control", "sample"), (std::vector{5.0, 6.0}));
  const auto force = reader.column("steps", "measured_force_n");
  ASSERT_EQ(force.size(), 5010U);
  EXPECT_EQ(force[5009], example_row(5009)[2]);
  const auto some = reader.rows("steps", 5008, 100);
  ASSERT_EQ(some.size(), 6U);
  EXPECT_EQ(some[0], 5008.0);

  const auto events = reader.events();
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].event, example_event());
  EXPECT_EQ(events[0].text, "Grenzwert überschritten");
  EXPECT_EQ(events[1].event, Event{});

  EXPECT_TRUE(reader.counters().closed_cleanly);
  EXPECT_FALSE(reader.counters().write_failed);
  EXPECT_EQ(reader.counters().dropped_rows(), 3U);
  EXPECT_EQ(reader.counters().tables[0], (TableCounter{"steps", 5010, 0}));
  EXPECT_EQ(reader.counters().tables[2], (TableCounter{"events", 2, 0}));
}

TEST(RunFileWriter, NotesOfTablesAreReadBackInTheirOrder) {
  const TemporaryDirectory directory;
  const auto path = directory / "storey_1.h5";
  const TableNote steps{"steps", "One row per step.", "model_time_s", 0.001};
  const TableNote control{"control", "Rows that come when they come.", "", 0.0};
  RunFileHeader header = example_header();
  header.table_notes = {control, {"absent", "Of a table that this file does not have.", "", 0.0}, steps};
  RunFileWriter{path, header, {example_layout(), {"control", {{"sample", "-"}}}, {"plain", {{"x", "m"}}}}}.close();
  EXPECT_EQ(RunFileReader{path}.header().table_notes, (std::vector{steps, control}));
}

TEST(RunFileWriter, ColumnNamesMayExceedAnOrdinaryAttribute) {
  const TemporaryDirectory directory;
  const auto path = directory / "coordinator.h5";
  // One long name makes all of them long: 1200 of 60 bytes are more than the 64 KiB of an ordinary attribute.
  TableLayout wide{"steps", {{std::string(60, 'x'), "m"}}};
  for (int i = 1; i < 1200; ++i) wide.columns.push_back({"u_" + std::to_string(i) + "_m", "m"});
  RunFileWriter{path, example_header(), {wide}}.close();
  EXPECT_EQ(RunFileReader{path}.tables().front(), wide);
}

TEST(RunFileWriter, UnknownColumnOrTableIsAnError) {
  const TemporaryDirectory directory;
  const auto path = directory / "a.h5";
  RunFileWriter{path, example_header(), {example_layout()}}.close();
  const RunFileReader reader{path};
  EXPECT_THROW((void)reader.column("steps", "nothing"), RecordingError);
  EXPECT_THROW((void)reader.rows("nothing", 0, 1), RecordingError);
  EXPECT_TRUE(reader.column("steps", "step").empty());
  EXPECT_EQ(reader.row_count("nothing"), 0U);
}

TEST(RunFileWriter, RejectsInvalidTables) {
  const TemporaryDirectory directory;
  const std::vector<Column> column{{"a", ""}};
  const std::vector<std::vector<TableLayout>> refused{{{"", column}},
                                                      {{"steps", {}}},
                                                      {{"events", column}},
                                                      {{"steps", column}, {"steps", column}},
                                                      {{"a/b", column}},
                                                      {{"a", {{"", ""}}}},
                                                      {{"state", column}},
                                                      {{"a", {{"b", ""}, {"b", ""}}}},
                                                      {{std::string(64, 'a'), column}}};
  for (const auto& tables : refused) {
    EXPECT_THROW(RunFileWriter(directory / "a.h5", example_header(), tables), RecordingError);
  }
}

TEST(RunFileWriter, ReportsWhyFileCannotBeCreated) {
  try {
    const RunFileWriter writer{"/nowhere/at/all.h5", example_header(), {example_layout()}};
    FAIL();
  } catch (const RecordingError& error) {
    EXPECT_NE(std::string{error.what()}.find("/nowhere/at/all.h5"), std::string::npos);
    EXPECT_NE(std::string{error.what()}.find("No such file"), std::string::npos) << error.what();
  }
}

TEST(RunFileWriter, ReaderRejectsOtherFiles) {
  const TemporaryDirectory directory;
  std::ofstream{directory / "a.h5"} << "not HDF5";
  EXPECT_THROW(RunFileReader{directory / "a.h5"}, RecordingError);
  EXPECT_THROW(repair(directory / "a.h5"), RecordingError);
  EXPECT_THROW(RunFileReader{directory / "absent.h5"}, RecordingError);
}

TEST(RunFileWriter, AnotherProcessReadsTheFileWhileItGrows) {
  const TemporaryDirectory directory;
  const auto path = directory / "a.h5";
  ForkedChild child{[&](const ForkedChild& self) {
    RunFileWriter writer{path, example_header(), {example_layout()}};
    for (std::size_t rows = 0; rows < 20'000; rows += 5000) {
      append_rows(writer, rows, 5000);
      writer.flush();
      self.report(rows + 5000);
      self.await_word();
    }
  }};
  ASSERT_EQ(child.hear(), 5000U);
  RunFileReader reader{path};
  for (std::size_t rows = 5000; rows <= 20'000; rows += 5000) {
    EXPECT_EQ(reader.row_count("steps"), rows);
    EXPECT_EQ(wrong_rows(reader.rows("steps", 0, rows)), 0U);
    EXPECT_FALSE(reader.counters().closed_cleanly);
    child.say_word();
    if (rows < 20'000) {
      ASSERT_EQ(child.hear(), rows + 5000);
      reader.refresh();
    }
  }
  EXPECT_EQ(child.wait(), 0);
  reader.refresh();
  EXPECT_TRUE(reader.counters().closed_cleanly);
}

TEST(RunFileWriter, KilledWriterKeepsRowsUpToLastFlush) {
  // A kill at several stages: small file, several chunks, index blocks of the dataset allocated.
  for (const int flushes : {1, 3, 20, 150}) {
    const TemporaryDirectory directory;
    const auto path = directory / "a.h5";
    ForkedChild child{[&](const ForkedChild& self) { write_for_ever(self, path); }};
    std::uint64_t flushed = 0;
    for (int i = 0; i < flushes; ++i) flushed = child.hear();
    child.kill_now();
    while (const std::uint64_t more = child.hear()) flushed = more;
    ASSERT_GT(flushed, 0U);

    {
      const RunFileReader reader{path};
      EXPECT_GE(reader.row_count("steps"), flushed);
      EXPECT_EQ(wrong_rows(reader.rows("steps", 0, reader.row_count("steps"))), 0U);
      EXPECT_FALSE(reader.counters().closed_cleanly);
    }
    EXPECT_TRUE(repair(path));
    EXPECT_FALSE(repair(path)) << "nothing is left to repair";
    const RunFileReader reader{path};
    EXPECT_GE(reader.row_count("steps"), flushed);
    EXPECT_EQ(wrong_rows(reader.rows("steps", 0, reader.row_count("steps"))), 0U);
    EXPECT_FALSE(reader.counters().closed_cleanly) << "repairing must not hide the kill";
  }
}

TEST(RunFileWriter, OtherToolsOpenAKilledFileAfterRepairOnly) {
  if (!program_runs("h5dump --version")) GTEST_SKIP() << "h5dump (Debian: hdf5-tools) is not installed";
  const TemporaryDirectory directory;
  const auto path = directory / "a.h5";
  ForkedChild child{[&](const ForkedChild& self) { write_for_ever(self, path); }};
  for (int i = 0; i < 30; ++i) (void)child.hear();
  child.kill_now();
  EXPECT_FALSE(program_runs("h5dump -H " + path.string())) << "control: the kill left its mark";
  EXPECT_TRUE(repair(path));
  EXPECT_TRUE(program_runs("h5dump -H " + path.string()));
  EXPECT_TRUE(program_runs("h5dump " + path.string())) << "every row is readable";
}

TEST(RunFileWriter, OpenFileIsNeitherRepairedNorReplaced) {
  const TemporaryDirectory directory;
  const auto path = directory / "a.h5";
  ForkedChild child{[&](const ForkedChild& self) {
    RunFileWriter writer{path, example_header(), {example_layout()}};
    append_rows(writer, 0, 100);
    writer.flush();
    self.report(1);
    self.await_word();
    append_rows(writer, 100, 100);
  }};
  ASSERT_EQ(child.hear(), 1U);
  EXPECT_THROW(repair(path), RecordingError);
  EXPECT_THROW(RunFileWriter(path, example_header(), {example_layout()}), RecordingError);
  child.say_word();
  EXPECT_EQ(child.wait(), 0);
  const RunFileReader reader{path};
  EXPECT_EQ(reader.row_count("steps"), 200U);
  EXPECT_EQ(wrong_rows(reader.rows("steps", 0, 200)), 0U);
  EXPECT_TRUE(reader.counters().closed_cleanly);
}

/// Writes until the file system refuses, which a limit on the size of files brings about.
/// @return rows flushed before, or nothing when writing did not fail as it must.
std::uint64_t write_until_refused(const std::filesystem::path& path, rlim_t bytes_max) {
  ::signal(SIGXFSZ, SIG_IGN);
  RunFileWriter writer{path, example_header(), {example_layout()}};
  const rlimit limit{bytes_max, bytes_max};
  ::setrlimit(RLIMIT_FSIZE, &limit);
  for (std::size_t rows = 0; rows < 1'000'000; rows += 500) {
    try {
      append_rows(writer, rows, 500);
      writer.flush();
    } catch (const RecordingError&) {
      const std::uint64_t flushed = writer.rows_flushed(0);
      writer.set_dropped(0, rows + 500 - flushed);
      bool refused_again = false;
      try {
        append_rows(writer, 0, 1);
      } catch (const RecordingError&) {
        refused_again = true;
      }
      return writer.failed() && refused_again ? flushed : 0;
    }
  }
  return 0;
}

TEST(RunFileWriter, FullDiskKeepsRowsUpToLastFlush) {
  for (const rlim_t bytes_max : {20'000U, 60'000U, 100'001U, 500'000U}) {
    const TemporaryDirectory directory;
    const auto path = directory / "a.h5";
    ForkedChild child{[&](const ForkedChild& self) {
      const std::uint64_t flushed = write_until_refused(path, bytes_max);
      // The file opens in the process that failed to write it, too.
      const RunFileReader reader{path};
      self.report(reader.row_count("steps") == flushed ? flushed + 1 : 0);
    }};
    const std::uint64_t answer = child.hear();
    ASSERT_EQ(child.wait(), 0);
    ASSERT_GT(answer, 0U) << "the child failed at " << bytes_max;
    const std::uint64_t flushed = answer - 1;
    EXPECT_LE(std::filesystem::file_size(path), bytes_max);
    for (const bool repaired : {false, true}) {
      if (repaired) {
        EXPECT_TRUE(repair(path));
      }
      const RunFileReader reader{path};
      EXPECT_EQ(reader.row_count("steps"), flushed);
      EXPECT_EQ(wrong_rows(reader.rows("steps", 0, flushed)), 0U);
      EXPECT_TRUE(reader.counters().write_failed);
      EXPECT_FALSE(reader.counters().closed_cleanly);
      EXPECT_GT(reader.counters().dropped_rows(), 0U);
    }
  }
}

}  // namespace
}  // namespace hybridtest
