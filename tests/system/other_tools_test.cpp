#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>

#include "tests/support/system_fixture.hpp"

/// What tools of other people get: the examples of docs/examples on a run that was just made, and the list of runs.
namespace hybridtest {
namespace {

using testing::HasSubstr;
using testing::Optional;

constexpr const char* kPython = "/usr/bin/python3";

std::string content(const std::filesystem::path& file) {
  std::ifstream stream{file};
  return {std::istreambuf_iterator<char>{stream}, {}};
}

std::filesystem::path example(const char* name) {
  return std::filesystem::path{HYBRIDTEST_SOURCE_DIR} / "docs" / "examples" / name;
}

class OtherTools : public SystemTest {
 protected:
  void simulate(const std::string& run) {
    StartedProgram program =
        start_simulate(shipped_scenario("two_storey_one_site"), run, {"--set", "time.duration_s=1"});
    ASSERT_THAT(program.wait(), Optional(kExitCompleted)) << program.standard_error();
  }
  void run_python(const Arguments& arguments, std::string& printed) {
    StartedProgram program{kPython, arguments, directory() / "python"};
    ASSERT_THAT(program.wait(), Optional(0)) << program.standard_error();
    printed = program.standard_output();
  }
  static bool python_has(const std::string& modules) {
    return std::system((std::string{kPython} + " -c 'import " + modules + "' 2>/dev/null").c_str()) == 0;
  }
};

TEST_F(OtherTools, PythonExamplePlotsWhatWasRecorded) {
  if (!python_has("h5py, matplotlib")) GTEST_SKIP() << "python3-h5py or python3-matplotlib is not installed";
  simulate("run");
  const std::filesystem::path figure = directory() / "figure.png";
  std::string printed;
  run_python({example("plot_run.py").string(), recorded("run").file("storey_1").string(), "control", figure.string()},
             printed);
  EXPECT_GT(std::filesystem::file_size(figure), 10'000U);

  const RunFileReader file = recorded("run").open("storey_1");
  EXPECT_THAT(printed, HasSubstr(std::to_string(file.row_count("control")) + " rows at "));
  EXPECT_THAT(printed, HasSubstr("t0 " + file.header().t0_utc));
  const std::vector<double> force = file.column("control", "measured_force_n");
  std::smatch found;
  ASSERT_TRUE(std::regex_search(printed, found, std::regex{R"(measured_force_n \[N\]: (\S+) to (\S+))"})) << printed;
  EXPECT_NEAR(std::stod(found[1]), *std::ranges::min_element(force), 1e-4);
  EXPECT_NEAR(std::stod(found[2]), *std::ranges::max_element(force), 1e-4);
}

TEST_F(OtherTools, EveryTableHasNamesUnitsAndDescription) {
  if (!python_has("h5py")) GTEST_SKIP() << "python3-h5py is not installed";
  simulate("run");
  for (const char* participant : {"coordinator", "storey_1", "storey_2"}) {
    std::string printed;
    run_python({"-c",
                "import h5py, json, sys\n"
                "text = lambda value: value.decode() if isinstance(value, bytes) else value\n"
                "with h5py.File(sys.argv[1], 'r') as run:\n"
                "    rows = {name: {key: [text(v) for v in value] if getattr(value, 'ndim', 0) else text(value)\n"
                "                   for key, value in table.attrs.items()} for name, table in run.items()}\n"
                "    members = {name: list(table.dtype.names) for name, table in run.items()}\n"
                "    print(json.dumps([rows, members, float(run.attrs['t0_unix_s']), text(run.attrs['t0_utc']),\n"
                "                      float(run.attrs['model_time_step_s'])]))\n",
                recorded("run").file(participant).string()},
               printed);
    const nlohmann::json json = nlohmann::json::parse(printed);
    for (const auto& [table, attributes] : json.at(0).items()) {
      EXPECT_GT(attributes.at("description").get<std::string>().size(), 20U) << participant << " " << table;
      EXPECT_EQ(attributes.at("column_names"), json.at(1).at(table)) << participant << " " << table;
      EXPECT_EQ(attributes.at("units").size(), json.at(1).at(table).size()) << participant << " " << table;
      if (!attributes.contains("sample_rate_hz")) continue;
      EXPECT_NEAR(attributes.at("sample_rate_hz").get<double>() * attributes.at("sample_interval_s").get<double>(), 1.0,
                  1e-12);
      // The rate is that of the rows: their times differ by the interval.
      const std::vector<double> time_s =
          recorded("run").column(participant, table, attributes.at("time_column").get<std::string>());
      ASSERT_GT(time_s.size(), 100U);
      for (std::size_t i = 1; i < time_s.size(); ++i) {
        ASSERT_NEAR(time_s[i] - time_s[i - 1], attributes.at("sample_interval_s").get<double>(), 1e-9)
            << participant << " " << table << " row " << i;
      }
    }
    EXPECT_TRUE(json.at(0).at("steps").contains("sample_rate_hz")) << participant;
    EXPECT_GT(json.at(2).get<double>(), 1.7e9);
    EXPECT_EQ(json.at(3).get<std::string>().size(), std::string{"2026-11-22T10:15:00.123456Z"}.size());
    EXPECT_EQ(json.at(4).get<double>(), 0.001);
  }
}

TEST_F(OtherTools, MatlabExampleNamesWhatIsInTheFile) {
  simulate("run");
  const RunFileReader file = recorded("run").open("storey_1");
  const std::string text = content(example("plot_run.m"));
  EXPECT_THAT(text, HasSubstr("'storey_1.h5'"));
  // Structure fields are columns of the table that was read.
  const std::regex field{R"(control\.([a-z_]+))"};
  std::set<std::string> columns;
  for (std::sregex_iterator it{text.begin(), text.end(), field}, end; it != end; ++it) columns.insert((*it)[1]);
  EXPECT_GE(columns.size(), 4U);
  for (const std::string& column : columns) EXPECT_TRUE(file.has_column("control", column)) << column;

  if (!python_has("h5py")) GTEST_SKIP() << "python3-h5py is not installed: attributes are not looked up";
  const std::regex attribute{R"(h5readatt\(file, '([^']+)', '([^']+)'\))"};
  int attributes = 0;
  for (std::sregex_iterator it{text.begin(), text.end(), attribute}, end; it != end; ++it, ++attributes) {
    std::string printed;
    run_python({"-c", "import h5py, sys; print(sys.argv[3] in h5py.File(sys.argv[1], 'r')[sys.argv[2]].attrs)",
                file.path().string(), (*it)[1], (*it)[2]},
               printed);
    EXPECT_EQ(printed, "True\n") << (*it)[2];
  }
  EXPECT_EQ(attributes, 5);
}

TEST_F(OtherTools, RunsListsWhatTheSummarySays) {
  std::filesystem::create_directories(directory() / "runs");
  simulate("runs/one");
  std::filesystem::create_directories(directory() / "runs" / "broken");
  std::ofstream{directory() / "runs" / "broken" / "coordinator.h5"} << "no recording";
  StartedProgram list = start_hybridtest({"runs", (directory() / "runs").string(), "--json", "--page"}, "list");
  ASSERT_THAT(list.wait(), Optional(kExitCompleted)) << list.standard_error();

  const nlohmann::json runs = nlohmann::json::parse(list.standard_output()).at("runs");
  ASSERT_EQ(runs.size(), 2U);
  const nlohmann::json summary = recorded("runs/one").summary();
  const nlohmann::json& one = runs.at(0).at("fault").is_null() ? runs.at(0) : runs.at(1);
  const nlohmann::json& broken = runs.at(0).at("fault").is_null() ? runs.at(1) : runs.at(0);
  EXPECT_EQ(one.at("scenario"), test_name());
  EXPECT_EQ(one.at("verdict"), summary.at("verdict"));
  EXPECT_EQ(one.at("peak_displacement"), summary.at("peak_displacement"));
  EXPECT_THAT(broken.at("fault").get<std::string>(), HasSubstr("no readable run file"));

  const std::string page = content(directory() / "runs" / "index.html");
  EXPECT_THAT(page, HasSubstr("href=\"./one/report.html\""));
  EXPECT_THAT(page, HasSubstr("2 runs, newest first; 1 did not"));
}

}  // namespace
}  // namespace hybridtest
