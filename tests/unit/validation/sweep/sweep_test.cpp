#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include "core/config_error.hpp"
#include "tests/unit/recording/temporary_directory.hpp"
#include "validation/sweep/sweep_page.hpp"
#include "validation/sweep/sweep_plan.hpp"
#include "validation/sweep/sweep_table.hpp"

namespace hybridtest {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(SweepPlan, ReadsListsAndRanges) {
  EXPECT_THAT(read_varied("a.b=1,2,three").values, ElementsAre("1", "2", "three"));
  EXPECT_EQ(read_varied("a.b=1,2").key, "a.b");
  EXPECT_THAT(read_varied("a.b=0.01..0.03/3").values, ElementsAre("0.01", "0.02", "0.03"));
  EXPECT_THAT(read_varied("a.b=1..100/3/log").values, ElementsAre("1", "10", "100"));
  EXPECT_THAT(read_varied("c={type: none},{type: x, order: 3}").values,
              ElementsAre("{type: none}", "{type: x, order: 3}"));
  EXPECT_THAT(read_varied("c=[1, 2],'a,b'").values, ElementsAre("[1, 2]", "'a,b'"));
}

TEST(SweepPlan, RefusesWhatIsNoListOfValues) {
  for (const char* text : {"a.b", "=1", "a.b=", "a.b=1,,2", "a.b=1,1", "a.b=0..1/1", "a.b=0..1/3/log"}) {
    EXPECT_THROW(static_cast<void>(read_varied(text)), ConfigError) << text;
  }
  for (const char* text : {"", "a", "5..2", "1..", "-1", "0..1000000"}) {
    EXPECT_THROW(static_cast<void>(read_seeds(text)), ConfigError) << text;
  }
  EXPECT_EQ(read_seeds("7"), std::pair(std::uint64_t{7}, std::uint64_t{7}));
  EXPECT_EQ(read_seeds("2..9"), std::pair(std::uint64_t{2}, std::uint64_t{9}));
}

SweepPlan small_plan() {
  SweepPlan plan;
  plan.scenario_file = "/tests/frame.yaml";
  plan.scenario_digest = "abc";
  plan.overrides = {"name=swept"};
  plan.varied = {{"a.delay_s", {"0.01", "0.02"}}, {"loss", {"0", "0.1", "0.2"}}, {"a.sensors.seed", {"@seed"}}};
  plan.first_seed = 5;
  plan.last_seed = 8;
  return plan;
}

TEST(SweepPlan, CasesAreEveryCombinationOnce) {
  const SweepPlan plan = small_plan();
  ASSERT_EQ(plan.case_count(), 2U * 3U * 4U);
  std::set<std::vector<std::string>> seen;
  for (std::size_t number = 1; number <= plan.case_count(); ++number) {
    const SweepCase one = plan.case_at(number);
    EXPECT_EQ(one.number, number);
    EXPECT_EQ(one.values[2], std::to_string(one.seed)) << "of the case";
    std::vector<std::string> key = one.values;
    key.push_back(std::to_string(one.seed));
    EXPECT_TRUE(seen.insert(key).second) << number;
  }
  EXPECT_EQ(plan.case_at(1).seed, 5U);
  EXPECT_EQ(plan.case_at(2).seed, 6U);
  EXPECT_EQ(plan.case_at(24).values[1], "0.2");
}

TEST(SweepPlan, NetworkConditionsBecomeOptionsOfSimulate) {
  const SweepPlan plan = small_plan();
  EXPECT_THAT(plan.arguments(plan.case_at(2), "/out/run"),
              ElementsAre("simulate", "/tests/frame.yaml", "--seed", "6", "--out", "/out/run", "--no-report", "--set",
                          "name=swept", "--set", "a.delay_s=0.01", "--loss", "0", "--set", "a.sensors.seed=6"));
}

TEST(SweepPlan, LatenciesOfSitesBecomeOptionsOfSimulate) {
  SweepPlan plan;
  plan.scenario_file = "/tests/frame.yaml";
  plan.varied = {read_varied("latency_spread=0,0.6"), read_varied("site_latency_us[far]=100..50000/2")};
  EXPECT_EQ(site_of_latency("site_latency_us[far]"), "far");
  for (const char* other : {"site_latency_us", "site_latency_us[far", "substructures[far].limits", "loss"}) {
    EXPECT_EQ(site_of_latency(other), std::nullopt) << other;
  }
  EXPECT_THAT(plan.arguments(plan.case_at(4), "/out/run"),
              ElementsAre("simulate", "/tests/frame.yaml", "--seed", "1", "--out", "/out/run", "--no-report",
                          "--latency-spread", "0.6", "--site-latency", "far:50000"));
}

TEST(SweepPlan, ReadsBackWhatItWrote) {
  const TemporaryDirectory folder;
  const SweepFiles files{folder / "sweep"};
  write_plan(small_plan(), files);
  EXPECT_EQ(read_plan(files), small_plan());
  EXPECT_THROW(static_cast<void>(read_plan({folder / "another"})), ConfigError);
  std::ofstream{files.plan()} << "{";
  EXPECT_THROW(static_cast<void>(read_plan(files)), ConfigError);
}

/// Results as `simulate` leaves them: the peak is 0.01 times the number of the case; every fourth case ended early.
class SweepResults : public testing::Test {
 protected:
  SweepResults() {
    write_plan(plan_, files_);
    for (std::size_t number = 1; number <= plan_.case_count(); ++number) {
      if (number == 3) continue;  // not done
      const bool is_early = number % 4 == 0;
      std::ofstream{files_.result(number)}
          << R"({"exit_code": )" << (is_early ? 3 : 0) << R"(, "stop_reason": ")"
          << (is_early ? "interlock" : "completed") << R"(", "data_valid": true, "completed_steps": 9,
                "model_time_s": 0.009, "wall_time_s": )"
          << 0.5 * static_cast<double>(number) << R"(, "interlocks": )"
          << (is_early ? R"([{"participant": "site", "limit_name": "force_limit"}])" : "[]") << R"(,
                "peak_displacement": [{"dof": "floor", "displacement_m": )"
          << -0.01 * static_cast<double>(number) << R"(}],
                "substructures": [{"id": "site", "peak_force": [{"dof": "floor", "force_n": 2.5e3}],
                                   "tracking": [], "energy_error": null, "exchange": null}]})";
    }
  }

  TemporaryDirectory folder_;
  SweepPlan plan_ = small_plan();
  SweepFiles files_{folder_ / "sweep"};
};

TEST_F(SweepResults, TableHasARowPerCaseAndNothingOfTheMachine) {
  const SweepTable table = read_results(plan_, files_);
  EXPECT_EQ(table.rows.size(), 24U);
  EXPECT_EQ(table.done, 23U);
  EXPECT_THAT(to_csv(table), Not(HasSubstr("wall_time")));
  EXPECT_EQ(table.rows[6][table.column("case")], "7");
  EXPECT_EQ(number_of(table.rows[6][table.column("peak_displacement_floor_m")]), -0.07);
  EXPECT_EQ(table.rows[7][table.column("interlock")], "site force_limit");
  EXPECT_EQ(table.rows[2][table.column("exit_code")], "") << "not done";
  EXPECT_EQ(table.rows[0][table.column("peak_force_site_floor_n")], "2500");
  EXPECT_THROW(static_cast<void>(table.column("peak")), ConfigError);
}

TEST_F(SweepResults, CsvQuotesValuesWithCommas) {
  plan_.varied[0].values = {"{type: x, order: 3}", "0.02"};
  EXPECT_THAT(to_csv(read_results(plan_, files_)), HasSubstr("\n1,5,\"{type: x, order: 3}\",0,5,0,completed"));
}

TEST_F(SweepResults, CaseThatDidNotRunIsARowWithItsExitCode) {
  std::ofstream{files_.result(3)} << R"({"exit_code": 2, "stop_reason": "not_run", "why": "no such key"})";
  const SweepTable table = read_results(plan_, files_);
  EXPECT_EQ(table.rows[2][table.column("stop_reason")], "not_run");
  EXPECT_EQ(table.rows[2][table.column("peak_displacement_floor_m")], "");
}

TEST_F(SweepResults, ResultThatIsCutNamesItsFile) {
  std::ofstream{files_.result(3)} << "{";
  try {
    static_cast<void>(read_results(plan_, files_));
    FAIL() << "a cut result was read";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("000003.json"));
  }
}

TEST_F(SweepResults, PageCountsCasesOverTheValues) {
  const SweepTable table = read_results(plan_, files_);
  const std::string page = sweep_page(plan_, table, {{"peak_displacement_floor_m", 0.12}});
  EXPECT_THAT(page, HasSubstr("24 cases of frame.yaml, 23 of them done; 17 completed their test"));
  for (const char* part : {"Fragility over a.delay_s", "Fragility over loss", "Results over loss", "Distributions",
                           "peak_displacement_floor_m above 0.12", "95 % interval"}) {
    EXPECT_THAT(page, HasSubstr(part));
  }
  EXPECT_THAT(page, Not(HasSubstr("Fragility over a.sensors.seed")));
  EXPECT_THROW(static_cast<void>(sweep_page(plan_, table, {{"peak", 1.0}})), ConfigError);
}

// Newcombe (1998), Two-sided confidence intervals for the single proportion, table I, method 3 (Wilson).
TEST(SweepShare, IntervalsAreThoseOfThePublishedTable) {
  const Share a = share_of(81, 263);
  EXPECT_NEAR(a.low, 0.2553, 5e-5);
  EXPECT_NEAR(a.high, 0.3662, 5e-5);
  const Share b = share_of(15, 148);
  EXPECT_NEAR(b.low, 0.0624, 5e-5);
  EXPECT_NEAR(b.high, 0.1605, 5e-5);
  const Share c = share_of(0, 20);
  EXPECT_EQ(c.low, 0.0);
  EXPECT_NEAR(c.high, 0.1611, 5e-5);
  const Share d = share_of(1, 29);
  EXPECT_NEAR(d.low, 0.0061, 5e-5);
  EXPECT_NEAR(d.high, 0.1718, 5e-5);
}

TEST(SweepShare, ExceedancesAreColumnAndLimit) {
  EXPECT_EQ(read_exceedance("peak_m=0.1").column, "peak_m");
  EXPECT_EQ(read_exceedance("peak_m=0.1").limit, 0.1);
  for (const char* text : {"peak_m", "=0.1", "peak_m=", "peak_m=x"}) {
    EXPECT_THROW(static_cast<void>(read_exceedance(text)), ConfigError) << text;
  }
}

}  // namespace
}  // namespace hybridtest
