#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <map>
#include <string>
#include <thread>
#include <utility>

#include "report/live/http_library.hpp"
#include "tests/support/recording_checks.hpp"
#include "tests/support/system_fixture.hpp"

/// Running tests, watched through the web server as a page does.
namespace hybridtest {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Optional;
using namespace std::chrono_literals;

/// At the wall's time, for as long as a test needs.
const Arguments kWatchedLong{"--set", "time={mode: paced, step_s: 0.001, duration_s: 600.0}"};

class Watch : public SystemTest {
 protected:
  /// A page: asks for what is new and keeps the values by signal and time.
  class Page {
   public:
    Page(const std::string& address, std::string test) : client_{address}, test_{std::move(test)} {
      client_.set_keep_alive(true);
    }

    [[nodiscard]] json tests() {
      const auto answer = client_.Get("/api/tests");
      return answer && answer->status == 200 ? json::parse(answer->body) : json{};
    }
    /// The newest answer; null when there is none.
    json ask() {
      const auto answer = client_.Get("/api/tests/" + test_ + "?since=" + cursor_.dump());
      if (!answer || answer->status != 200) return {};
      json news = json::parse(answer->body);
      cursor_ = news["cursor"];
      for (const json& signal : news["signals"]) {
        auto& values = values_[signal["participant"].get<std::string>() + " " + signal["name"].get<std::string>() +
                               " " + signal["subject"].get<std::string>()];
        for (std::size_t i = 0; i < signal["t"].size(); ++i) {
          if (!signal["last"][i].is_null()) values[signal["t"][i]] = signal["last"][i];
        }
      }
      return news;
    }
    [[nodiscard]] bool reaches(const std::string& phase) {
      return wait_until([&] {
        const json news = ask();
        return !news.is_null() && news["test"]["phase"] == phase;
      });
    }
    [[nodiscard]] bool reaches_step(int step) {
      return wait_until([&] {
        const json news = ask();
        return !news.is_null() && news["test"]["step"].is_number() && news["test"]["step"] >= step;
      });
    }
    [[nodiscard]] std::string state(const std::string& participant) {
      const json news = ask();
      if (news.is_null()) return "";
      for (const json& one : news["participants"]) {
        if (one["id"] == participant) return one["state"];
      }
      return "";
    }
    int control(const std::string& verb, const std::string& token) {
      const auto answer =
          client_.Post("/api/tests/" + test_ + "/control", httplib::Headers{{"Authorization", "Bearer " + token}},
                       json{{"verb", verb}}.dump(), "application/json");
      return answer ? answer->status : 0;
    }
    /// By model time.
    [[nodiscard]] const std::map<double, double>& values(const std::string& signal) { return values_[signal]; }

   private:
    httplib::Client client_;
    std::string test_;
    json cursor_ = 0;
    std::map<std::string, std::map<double, double>> values_;
  };

  [[nodiscard]] StartedProgram start_watch(const std::string& output, const Arguments& more = {}) const {
    Arguments arguments{"watch"};
    std::ranges::copy(more, std::back_inserter(arguments));
    std::ranges::copy(network(), std::back_inserter(arguments));
    arguments.emplace_back("--loopback-only");
    return start_hybridtest(arguments, output);
  }
  /// The address that was printed, without the token; the token.
  static std::pair<std::string, std::string> address_in(const std::function<std::string()>& text) {
    std::string found;
    EXPECT_TRUE(wait_until([&] {
      const std::string all = text();
      const std::size_t begin = all.find("http://");
      if (begin == std::string::npos || all.find('\n', begin) == std::string::npos) return false;
      found = all.substr(begin, all.find('\n', begin) - begin);
      return true;
    })) << text();
    const std::size_t end = found.find("/#token=");
    if (end == std::string::npos) return {found.substr(0, found.rfind('/')), ""};
    return {found.substr(0, end), found.substr(end + std::strlen("/#token="))};
  }
  static std::string address_of(const StartedProgram& watch) {
    return address_in([&] { return watch.standard_output(); }).first;
  }

  void expect_same_values(Page& page, const std::string& signal, const std::string& participant,
                          const std::string& table, const std::string& column) const {
    const std::vector<double> times_s = recorded("run").column(participant, table, "model_time_s");
    const std::vector<double> recorded_values = recorded("run").column(participant, table, column);
    std::size_t compared = 0;
    for (const auto& [time_s, shown] : page.values(signal)) {
      // Several rows of a site have one model time while the test stands still.
      const auto first = std::ranges::lower_bound(times_s, time_s - 1e-6);
      const auto last = std::ranges::upper_bound(times_s, time_s + 1e-6);
      const bool is_recorded = std::any_of(
          recorded_values.begin() + (first - times_s.begin()), recorded_values.begin() + (last - times_s.begin()),
          [shown = shown](double value) { return std::abs(shown - value) <= 1e-6 * std::abs(value); });
      ASSERT_TRUE(is_recorded) << signal << ": " << shown << " at " << time_s << " s";
      ++compared;
    }
    EXPECT_GT(compared, 100U) << signal;
  }
};

TEST_F(Watch, PageShowsWhatIsRecordedWithinASecond) {
  StartedProgram run = start_run(shipped_scenario("two_storey_one_site"), "run", kWatchedLong);
  StartedProgram watch = start_watch("watch", {test_name()});
  Page page{address_of(watch), test_name()};
  ASSERT_TRUE(page.reaches_step(2000)) << run.standard_error() << watch.standard_error();
  // The page is at most a second behind the file, which its writer flushes ten times a second.
  const double recorded_step = recorded("run").last_step("coordinator");
  const json news = page.ask();
  EXPECT_EQ(news["test"]["phase"], "running");
  EXPECT_GE(news["test"]["step"].get<double>(), recorded_step - 1000.0);
  EXPECT_GT(news["test"]["steps_per_second"], 0.0);
  EXPECT_NEAR(news["test"]["model_time_s"], 1e-3 * news["test"]["step"].get<double>(), 1e-9);
  EXPECT_GE(page.values("coordinator displacement floor_1").rbegin()->first, 1e-3 * recorded_step - 1.0);
  EXPECT_GE(news["interlocks"].size(), 3U);
  run.signal(SIGINT);
  ASSERT_TRUE(page.reaches("stopped"));
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  EXPECT_EQ(page.ask()["test"]["stop_reason"], "interrupted");
  expect_same_values(page, "coordinator displacement floor_1", "coordinator", "steps", "displacement_floor_1_m");
  expect_same_values(page, "storey_1 measured_displacement floor_1", "storey_1", "control", "measured_displacement_m");
  expect_same_values(page, "storey_1 force floor_1", "storey_1", "control", "measured_force_n");
}

TEST_F(Watch, ControlsDoWhatTheySayAndNeedTheToken) {
  Arguments more = kWatchedLong;
  more.insert(more.end(), {"--watch", "--allow-control"});
  StartedProgram run = start_run(shipped_scenario("two_storey_one_site"), "run", more);
  const auto [address, token] = address_in([&] { return run.standard_error(); });
  Page page{address, test_name()};
  ASSERT_TRUE(page.reaches_step(500)) << run.standard_error();
  EXPECT_EQ(page.control("emergency_stop", "wrong"), 401);
  EXPECT_EQ(page.control("pause", token), 202);
  EXPECT_TRUE(page.reaches("paused"));
  EXPECT_EQ(page.control("resume", token), 202);
  EXPECT_TRUE(page.reaches("running"));
  EXPECT_EQ(page.control("emergency_stop", token), 202);
  EXPECT_TRUE(page.reaches("stopped"));
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  EXPECT_EQ(recorded("run").summary()["stop_reason"], "emergency_stop");
  // The page of a test that is over stays readable.
  EXPECT_EQ(page.ask()["test"]["stop_reason"], "emergency_stop");
  // The token is in no file.
  for (const auto& entry : std::filesystem::directory_iterator{directory() / "run"}) {
    EXPECT_EQ(text_of(entry.path()).find(token), std::string::npos) << entry.path();
  }
}

TEST_F(Watch, TestThatWaitsForALinkIsShownAsHeld) {
  Arguments more = kWatchedLong;
  more.insert(more.end(), {"--set", "timeouts={liveliness_lease_s: 1, link_s: 60}"});
  StartedProgram run = start_run(shipped_scenario("two_storey_one_site"), "run", more);
  StartedProgram watch = start_watch("watch", {test_name()});
  Page page{address_of(watch), test_name()};
  ASSERT_TRUE(page.reaches_step(500)) << run.standard_error();
  const pid_t site = participant_of(run, "storey_1");
  ASSERT_NE(site, 0);
  ASSERT_TRUE(send_signal(site, SIGSTOP));  // it is there and nobody hears it, as behind a link that is down
  ASSERT_TRUE(page.reaches("held")) << run.standard_error();
  EXPECT_EQ(page.state("storey_1"), "not heard by the coordinator, which waits for its link");
  const json held = page.ask();
  EXPECT_THAT(held["test"]["verdict"].get<std::string>(), HasSubstr("Held: nothing from 'storey_1' for"));
  EXPECT_THAT(held["test"]["verdict"].get<std::string>(), HasSubstr("waiting up to 60 s for its link"));
  ASSERT_TRUE(send_signal(site, SIGCONT));
  ASSERT_TRUE(page.reaches("running")) << run.standard_error();
  EXPECT_EQ(page.state("storey_1"), "running");
  EXPECT_TRUE(page.reaches_step(held["test"]["step"].get<int>() + 100));
  run.signal(SIGINT);
  EXPECT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
}

TEST_F(Watch, KilledSiteIsSeenWithinTheLease) {
  constexpr auto kLease = 2s;
  StartedProgram run = start_run(shipped_scenario("two_storey_one_site"), "run", kWatchedLong);
  StartedProgram watch = start_watch("watch", {test_name()});
  Page page{address_of(watch), test_name()};
  ASSERT_TRUE(page.reaches_step(500)) << run.standard_error();
  const pid_t site = participant_of(run, "storey_1");
  ASSERT_NE(site, 0);
  ASSERT_TRUE(send_signal(site, SIGKILL));
  const auto killed = std::chrono::steady_clock::now();
  ASSERT_TRUE(wait_until([&] { return page.state("storey_1") == "lost"; }));
  const auto seen = std::chrono::steady_clock::now() - killed;
  std::cout << "seen after " << std::chrono::duration<double>(seen).count() << " s\n";
  EXPECT_LT(seen, kLease + 1s);
  ASSERT_TRUE(page.reaches("stopped"));
  EXPECT_EQ(page.ask()["test"]["stop_reason"], "participant_lost");
  ASSERT_THAT(run.wait(), Optional(kExitEndedEarly));
}

TEST_F(Watch, StoppedAndKilledObserversLeaveNoTrace) {
  const Arguments duration{"--set", "time.duration_s=6"};
  const std::filesystem::path scenario = shipped_scenario("two_storey_one_site");
  StartedProgram simulated = start_simulate(scenario, "simulated", duration);
  ASSERT_THAT(simulated.wait(), Optional(kExitCompleted)) << simulated.standard_error();
  StartedProgram stopped = start_watch("stopped", {test_name()});
  StartedProgram killed = start_watch("killed", {test_name()});
  static_cast<void>(address_of(stopped));
  static_cast<void>(address_of(killed));
  StartedProgram run = start_run(scenario, "run", duration);
  ASSERT_TRUE(wait_until([&] { return run.standard_error().find("test started") != std::string::npos; }));
  stopped.signal(SIGSTOP);  // reads nothing while the whole test runs
  killed.signal(SIGKILL);
  ASSERT_THAT(run.wait(), Optional(kExitCompleted)) << run.standard_error();
  stopped.signal(SIGKILL);

  for (const char* column : {"displacement_floor_1_m", "displacement_floor_2_m", "restoring_force_floor_1_n"}) {
    const std::vector<double> watched = recorded("run").column("coordinator", "steps", column);
    const std::vector<double> alone = recorded("simulated").column("coordinator", "steps", column);
    ASSERT_EQ(watched.size(), alone.size());
    EXPECT_EQ(std::memcmp(watched.data(), alone.data(), watched.size() * sizeof(double)), 0) << column;
  }
  const json summary = recorded("run").summary();
  EXPECT_EQ(summary["data_valid"], true) << summary["data_faults"];
  for (const char* participant : {"coordinator", "storey_1", "storey_2"}) {
    EXPECT_TRUE(recorded("run").open(participant).counters().closed_cleanly) << participant;
  }
}

TEST_F(Watch, FindsAllTestsAndTellsThemApart) {
  const std::filesystem::path scenario = shipped_scenario("two_storey_one_site");
  Arguments other = kWatchedLong;
  other.insert(other.end(), {"--set", "name=" + test_name() + ".other"});
  StartedProgram watch = start_watch("watch");
  StartedProgram one = start_run(scenario, "one", kWatchedLong);
  StartedProgram two = start_run(scenario, "two", other);
  const std::string address = address_of(watch);
  Page first{address, test_name()};
  Page second{address, test_name() + ".other"};
  ASSERT_TRUE(first.reaches_step(200)) << watch.standard_error();
  ASSERT_TRUE(second.reaches_step(200)) << watch.standard_error();
  EXPECT_EQ(first.tests()["tests"].size(), 2U);
  EXPECT_EQ(first.tests()["control"], false);
  EXPECT_EQ(first.control("stop", ""), 403);
  two.signal(SIGINT);
  ASSERT_TRUE(second.reaches("stopped"));
  EXPECT_EQ(first.ask()["test"]["phase"], "running");
  one.signal(SIGINT);
  ASSERT_THAT(one.wait(), Optional(kExitEndedEarly));
  ASSERT_THAT(two.wait(), Optional(kExitEndedEarly));
  watch.signal(SIGINT);
  EXPECT_THAT(watch.wait(), Optional(kExitCompleted));
}

TEST_F(Watch, PageOfAKilledRunShowsItsEndAndLeaves) {
  Arguments more = kWatchedLong;
  more.emplace_back("--watch");
  StartedProgram run = start_run(shipped_scenario("two_storey_one_site"), "run", more);
  Page page{address_in([&] { return run.standard_error(); }).first, test_name()};
  ASSERT_TRUE(page.reaches_step(200)) << run.standard_error();
  const pid_t watch = run.child({"watch", test_name()});
  ASSERT_NE(watch, 0);
  run.signal(SIGKILL);
  ASSERT_THAT(run.wait(), Optional(128 + SIGKILL));
  EXPECT_TRUE(page.reaches("stopped"));
  EXPECT_TRUE(is_alive(watch));
  // Nobody asks any more: it leaves after a minute.
  EXPECT_TRUE(wait_until([&] { return !is_alive(watch); }, 90s));
  if (is_alive(watch)) send_signal(watch, SIGKILL);
}

TEST_F(Watch, RefusesWrongOptionsInOneLine) {
  StartedProgram port = start_watch("port", {"--port", "70000"});
  EXPECT_THAT(port.wait(), Optional(kExitConfiguration));
  EXPECT_THAT(port.standard_error(), HasSubstr("--port"));
  StartedProgram name = start_watch("name", {"a*b"});
  EXPECT_THAT(name.wait(), Optional(kExitConfiguration));
  EXPECT_THAT(name.standard_error(), HasSubstr("test name 'a*b'"));
  StartedProgram address = start_watch("address", {"--address", "203.0.113.1"});
  EXPECT_THAT(address.wait(), Optional(kExitConfiguration));
  EXPECT_THAT(address.standard_error(), HasSubstr("203.0.113.1"));
}

}  // namespace
}  // namespace hybridtest
