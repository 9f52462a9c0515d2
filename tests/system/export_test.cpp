#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/system_fixture.hpp"

/// `hybridtest export` writes what was recorded, to the last bit.
namespace hybridtest {
namespace {

using ::testing::Optional;

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream stream{line};
  for (std::string field; std::getline(stream, field, ',');) fields.push_back(field);
  return fields;
}

class Export : public SystemTest {
 protected:
  static void expect_same(const RunFileReader& file, const TableLayout& table, const std::filesystem::path& csv) {
    std::ifstream stream{csv};
    ASSERT_TRUE(stream.is_open()) << csv;
    std::string line;
    ASSERT_TRUE(std::getline(stream, line)) << csv;
    std::vector<std::string> names;
    for (const Column& column : table.columns) names.push_back(column.name);
    EXPECT_EQ(split(line), names) << csv;

    const std::vector<double> recorded_rows = file.rows(table.name, 0, file.row_count(table.name));
    std::size_t position = 0;
    while (std::getline(stream, line)) {
      for (const std::string& field : split(line)) {
        double value = 0.0;
        const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
        ASSERT_TRUE(error == std::errc{} && end == field.data() + field.size()) << csv << ": " << field;
        ASSERT_LT(position, recorded_rows.size()) << csv;
        const double expected = recorded_rows[position++];
        ASSERT_TRUE(value == expected || (std::isnan(value) && std::isnan(expected))) << csv << ": " << field;
      }
    }
    EXPECT_EQ(position, recorded_rows.size()) << csv;
    EXPECT_GT(position, 0U) << csv;
  }
};

TEST_F(Export, CsvReadsBackToTheRecordedValues) {
  StartedProgram run = start_simulate(shipped_scenario("two_storey_one_site"), "run", {"--set", "time.duration_s=1"});
  ASSERT_THAT(run.wait(), Optional(kExitCompleted)) << run.standard_error();
  StartedProgram exported = start_hybridtest({"export", (directory() / "run").string(), "--csv"}, "export");
  ASSERT_THAT(exported.wait(), Optional(kExitCompleted)) << exported.standard_error();

  std::size_t tables = 0;
  for (const char* participant : {"coordinator", "storey_1", "storey_2"}) {
    const RunFileReader file = recorded("run").open(participant);
    for (const TableLayout& table : file.tables()) {
      const std::filesystem::path csv =
          directory() / "run" / "csv" / (std::string{participant} + "." + table.name + ".csv");
      EXPECT_THAT(exported.standard_output(), ::testing::HasSubstr(csv.string()));
      expect_same(file, table, csv);
      ++tables;
    }
    EXPECT_TRUE(std::filesystem::exists(directory() / "run" / "csv" / (std::string{participant} + ".events.csv")));
  }
  EXPECT_EQ(tables, 9U);  // steps, exchanges, clocks, test, ground_motions, response_spectra; steps, control; steps
}

}  // namespace
}  // namespace hybridtest
