#include "launch/doctor_findings.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "runtime/version.hpp"

/// Both sides of every threshold of `hybridtest doctor`.
namespace hybridtest {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;
using Verdict = DoctorLine::Verdict;

std::string text_of_source(const std::string& file) {
  std::ifstream stream{std::filesystem::path{HYBRIDTEST_SOURCE_DIR} / file};
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

Scenario scenario_of(const std::string& mode, const std::vector<std::string>& more = {}) {
  std::vector<std::string> overrides{"time.mode=" + mode};
  overrides.insert(overrides.end(), more.begin(), more.end());
  return read_scenario(std::filesystem::path{HYBRIDTEST_SOURCE_DIR} / "launch/scenarios/two_storey_one_site.yaml",
                       overrides);
}

/// A link without fault.
LinkMeasurement good_link() {
  LinkMeasurement link;
  link.substructure = ParticipantId{"storey_1"};
  link.sent = link.answered = 1000;
  link.round_trip_s_min = link.round_trip_s_median = link.round_trip_s_p99 = 1e-4;
  return link;
}

DoctorLine line_of(const std::vector<DoctorLine>& lines, DoctorCode code) {
  const auto found = std::ranges::find(lines, code, &DoctorLine::code);
  EXPECT_NE(found, lines.end()) << name(code);
  return found == lines.end() ? DoctorLine{} : *found;
}

/// What is wrong comes with an advice, what is right without.
Verdict verdict_of(const DoctorLine& line) {
  EXPECT_THAT(line.text, Not(IsEmpty()));
  EXPECT_EQ(line.advice.empty(), line.verdict == Verdict::good) << line.text;
  return line.verdict;
}

Verdict verdict_of(const std::vector<DoctorLine>& lines, DoctorCode code) { return verdict_of(line_of(lines, code)); }

HeardParticipant heard_from(const std::string& id, const Scenario& scenario) {
  HeardParticipant heard;
  heard.status.id = ParticipantId{id};
  heard.status.scenario_digest = scenario.digest;
  heard.version = software_version();
  return heard;
}

NetworkHost host_named(const std::string& host) {
  NetworkHost one;
  one.participant = "storey_1";
  one.host = host;
  one.listens = PortRange{5100, 5100};
  return one;
}

TEST(DoctorFindings, NameThatDoesNotResolveIsToBeFixed) {
  EXPECT_EQ(verdict_of(judge_name(host_named("lab"), NetworkType::peers, std::nullopt)), Verdict::fix);
  EXPECT_EQ(verdict_of(judge_name(host_named("lab"), NetworkType::peers, "198.51.100.7")), Verdict::good);
}

TEST(DoctorFindings, NameOfTheLoopbackIsForOneHostAlone) {
  EXPECT_EQ(verdict_of(judge_name(host_named("lab"), NetworkType::peers, "127.0.1.1")), Verdict::fix);
  EXPECT_EQ(verdict_of(judge_name(host_named("lab"), NetworkType::one_host, "127.0.1.1")), Verdict::good);
  EXPECT_EQ(verdict_of(judge_name(host_named("127.0.0.1"), NetworkType::peers, "127.0.0.1")), Verdict::good);
  EXPECT_EQ(verdict_of(judge_name(host_named("localhost"), NetworkType::peers, "127.0.0.1")), Verdict::good);
}

TEST(DoctorFindings, AddressOfARouterIsWorthANote) {
  EXPECT_EQ(verdict_of(judge_foreign_address("coordinator", "198.51.100.7")), Verdict::note);
}

TEST(DoctorFindings, TakenPortsAreToBeFixed) {
  EXPECT_EQ(verdict_of(judge_tcp_port(5100, 0)), Verdict::good);
  EXPECT_EQ(verdict_of(judge_tcp_port(5100, EADDRINUSE)), Verdict::fix);
  EXPECT_THAT(judge_tcp_port(5100, EADDRINUSE).text, HasSubstr("TCP port 5100 cannot be used: Address already in use"));
  EXPECT_EQ(verdict_of(judge_udp_ports({7410, 7429}, 7428)), Verdict::good);
  EXPECT_THAT(judge_udp_ports({7410, 7429}, 7428).text, HasSubstr("7428 and 7429"));
  EXPECT_EQ(verdict_of(judge_udp_ports({7410, 7429}, std::nullopt)), Verdict::fix);
}

TEST(DoctorFindings, RefusedConnectionAndFirewallAreToldApart) {
  EXPECT_EQ(verdict_of(judge_connection(host_named("lab"), 0, false)), Verdict::good);
  EXPECT_THAT(judge_connection(host_named("lab"), 0, true).advice, HasSubstr("certificates"));
  const DoctorLine refused = judge_connection(host_named("lab"), ECONNREFUSED, false);
  EXPECT_EQ(verdict_of(refused), Verdict::fix);
  EXPECT_THAT(refused.advice, HasSubstr("nobody listens"));
  const DoctorLine silent = judge_connection(host_named("lab"), ETIMEDOUT, false);
  EXPECT_EQ(verdict_of(silent), Verdict::fix);
  EXPECT_THAT(silent.advice, HasSubstr("firewall"));
}

TEST(DoctorFindings, OthersMustBeThereWithTheSameVersionAndFile) {
  const Scenario scenario = scenario_of("lockstep");
  const auto judged = [&](const std::vector<HeardParticipant>& heard) {
    return judge_others(scenario, "storey_1", heard);
  };
  HeardParticipant other = heard_from("coordinator", scenario);
  for (const DoctorCode code : {DoctorCode::discovery, DoctorCode::version, DoctorCode::digest}) {
    EXPECT_EQ(verdict_of(judged({other}), code), Verdict::good) << name(code);
  }
  EXPECT_EQ(verdict_of(judged({}), DoctorCode::discovery), Verdict::fix);
  HeardParticipant silent = other;
  silent.version.clear();
  EXPECT_THAT(line_of(judged({silent}), DoctorCode::discovery).text, HasSubstr("coordinator was not heard"));
  EXPECT_EQ(verdict_of(judged({silent}), DoctorCode::discovery), Verdict::fix);
  HeardParticipant older = other;
  older.version = "0.0.1";
  EXPECT_EQ(verdict_of(judged({older}), DoctorCode::version), Verdict::fix);
  other.status.scenario_digest[0] ^= 1U;
  EXPECT_EQ(verdict_of(judged({other}), DoctorCode::digest), Verdict::fix);
}

TEST(DoctorFindings, CoordinatorLooksForEverySubstructure) {
  const Scenario scenario = scenario_of("lockstep");
  const auto lines = judge_others(scenario, "coordinator", {heard_from("storey_2", scenario)});
  EXPECT_THAT(line_of(lines, DoctorCode::discovery).text, HasSubstr("storey_1 was not found"));
  EXPECT_THAT(lines, SizeIs(4));
}

TEST(DoctorFindings, LossHasALimitForEachMode) {
  const auto verdict = [](const std::string& mode, int answered) {
    LinkMeasurement link = good_link();
    link.answered = answered;
    return verdict_of(judge_link(scenario_of(mode), link), DoctorCode::loss);
  };
  for (const std::string mode : {"lockstep", "paced"}) {
    EXPECT_EQ(verdict(mode, 950), Verdict::good) << mode;
    EXPECT_EQ(verdict(mode, 949), Verdict::fix) << mode;
  }
  EXPECT_EQ(verdict("real_time", 990), Verdict::good);
  EXPECT_EQ(verdict("real_time", 989), Verdict::fix);
}

TEST(DoctorFindings, LinkWithoutAnswersHasNoOtherFigure) {
  LinkMeasurement link = good_link();
  link.answered = 0;
  EXPECT_THAT(judge_link(scenario_of("lockstep"), link), SizeIs(1));
  link.sent = 0;
  EXPECT_THAT(judge_link(scenario_of("lockstep"), link), IsEmpty());
}

TEST(DoctorFindings, RoundTripInRealTimeFitsAsTheTestAsksFor) {
  // docs/real_time.md: 99 % must fit into `step_s` less `deadline_s`.
  const Scenario scenario = scenario_of("real_time", {"bridging={type: hold, deadline_s: 0.0004}"});
  LinkMeasurement link = good_link();
  link.round_trip_s_p99 = 0.000599;
  EXPECT_EQ(verdict_of(judge_link(scenario, link), DoctorCode::round_trip), Verdict::good);
  link.round_trip_s_p99 = 0.000601;
  EXPECT_EQ(verdict_of(judge_link(scenario, link), DoctorCode::round_trip), Verdict::fix);
  const Scenario bold = scenario_of("real_time", {"bridging={type: hold, deadline_s: 0.0004, start_anyway: true}"});
  EXPECT_EQ(verdict_of(judge_link(bold, link), DoctorCode::round_trip), Verdict::note);
}

TEST(DoctorFindings, PacedTestThatIsSlowerThanItsPaceIsNoted) {
  const Scenario scenario = scenario_of("paced", {"time.time_scale=50"});
  EXPECT_NEAR(step_period_s(scenario), 0.05, 1e-12);
  LinkMeasurement link = good_link();
  link.round_trip_s_median = 0.0499;
  EXPECT_EQ(verdict_of(judge_link(scenario, link), DoctorCode::round_trip), Verdict::good);
  link.round_trip_s_median = 0.0501;
  EXPECT_EQ(verdict_of(judge_link(scenario, link), DoctorCode::round_trip), Verdict::note);
}

TEST(DoctorFindings, LockstepHasNoLimitOfTheRoundTrip) {
  LinkMeasurement link = good_link();
  link.round_trip_s_min = link.round_trip_s_median = link.round_trip_s_p99 = 10.0;
  EXPECT_EQ(verdict_of(judge_link(scenario_of("lockstep"), link), DoctorCode::round_trip), Verdict::good);
}

TEST(DoctorFindings, ClockOffsetHasALimitInBothDirections) {
  const auto line = [](double offset_s) {
    LinkMeasurement link = good_link();
    link.clock_offset_s = offset_s;
    return line_of(judge_link(scenario_of("lockstep"), link), DoctorCode::clock_offset);
  };
  for (const double direction : {1.0, -1.0}) {
    EXPECT_EQ(verdict_of(line(direction)), Verdict::good);
    EXPECT_EQ(verdict_of(line(1.001 * direction)), Verdict::fix);
  }
  EXPECT_THAT(line(2.0).text, HasSubstr("2 s ahead of that of the coordinator"));
  EXPECT_THAT(line(-2.0).text, HasSubstr("2 s behind that of the coordinator"));
}

TEST(DoctorFindings, FiguresThatAreNotNumbersAreToBeFixed) {
  LinkMeasurement link = good_link();
  link.round_trip_s_p99 = link.clock_offset_s = std::nan("");
  const auto lines = judge_link(scenario_of("real_time"), link);
  EXPECT_EQ(verdict_of(lines, DoctorCode::round_trip), Verdict::fix);
  EXPECT_EQ(verdict_of(lines, DoctorCode::clock_offset), Verdict::fix);
}

TEST(DoctorFindings, ClockWithoutAServiceIsNoted) {
  EXPECT_EQ(verdict_of(judge_clock(true)), Verdict::good);
  EXPECT_EQ(verdict_of(judge_clock(false)), Verdict::note);
}

TEST(DoctorFindings, DiskNeedsRoomAndRate) {
  const RecordedVolume volume{.bytes = 2e6, .bytes_per_s = 1e6};
  const auto verdict = [&](double free_bytes, double rate, DoctorCode code) {
    return verdict_of(judge_disk(volume, "/runs", free_bytes, rate), code);
  };
  EXPECT_EQ(verdict(3e6, 1e9, DoctorCode::disk_room), Verdict::good);
  EXPECT_EQ(verdict(2.999e6, 1e9, DoctorCode::disk_room), Verdict::fix);
  EXPECT_EQ(verdict(1e9, 4e6, DoctorCode::disk_rate), Verdict::good);
  EXPECT_EQ(verdict(1e9, 3.999e6, DoctorCode::disk_rate), Verdict::fix);
  const auto lines = judge_disk(volume, "/runs", std::nullopt, 0.0);
  EXPECT_THAT(lines, SizeIs(1));
  EXPECT_EQ(verdict_of(lines, DoctorCode::disk_room), Verdict::fix);
  EXPECT_THAT(lines.front().text, HasSubstr("cannot write in /runs"));
}

TEST(DoctorFindings, RefusedPrivilegesAreToldByTheirErrors) {
  RealTimeRequest request;
  EXPECT_EQ(verdict_of(judge_privileges("storey_1", request, std::nullopt)), Verdict::good);
  EXPECT_EQ(verdict_of(judge_privileges("storey_1", request, RealTimeGrant{})), Verdict::good);
  for (const RealTimeGrant& grant : {RealTimeGrant{.memory_error = ENOMEM}, RealTimeGrant{.scheduling_error = EPERM},
                                     RealTimeGrant{.affinity_error = EINVAL}}) {
    request.allow_degraded = true;
    EXPECT_EQ(verdict_of(judge_privileges("storey_1", request, grant)), Verdict::note);
    request.allow_degraded = false;
    EXPECT_EQ(verdict_of(judge_privileges("storey_1", request, grant)), Verdict::fix);
  }
  EXPECT_THAT(judge_privileges("storey_1", request, RealTimeGrant{.scheduling_error = EPERM}).text,
              HasSubstr("SCHED_FIFO: Operation not permitted"));
}

/// The rows of the table of codes in the page for operators, by code.
std::map<std::string, std::string> documented_codes() {
  const std::string page = text_of_source("docs/across_hosts.md");
  const std::size_t begin = page.find("## Check every host");
  const std::string section = page.substr(begin, page.find("\n## ", begin + 1) - begin);
  std::map<std::string, std::string> rows;
  const std::regex row{R"(\n\| `([a-z_]+)` \|([^\n]*))"};
  for (auto found = std::sregex_iterator{section.begin(), section.end(), row}; found != std::sregex_iterator{};
       ++found) {
    rows[(*found)[1]] = (*found)[2];
  }
  return rows;
}

TEST(DoctorPage, ExplainsEveryCodeAndNoOther) {
  std::set<std::string> in_code;
  for (const DoctorCode code : kDoctorCodes) in_code.emplace(name(code));
  EXPECT_EQ(in_code.size(), kDoctorCodes.size());
  EXPECT_EQ(kDoctorCodes.back(), DoctorCode::real_time) << "the last enumerator; the list has all before it";
  EXPECT_EQ(kDoctorCodes.size(), static_cast<std::size_t>(DoctorCode::real_time) + 1);
  std::set<std::string> in_page;
  for (const auto& [code, row] : documented_codes()) in_page.insert(code);
  EXPECT_EQ(in_page, in_code);
}

TEST(DoctorPage, NamesTheLimits) {
  const auto rows = documented_codes();
  EXPECT_THAT(rows.at("loss"), HasSubstr(fmt::format("at most {:.3g} %, in real time {:.3g} %", 100 * kLossRatio_max,
                                                     100 * kLossRatioRealTime_max)));
  EXPECT_THAT(rows.at("clock_offset"), HasSubstr(fmt::format("by at most {:.3g} s", kClockOffset_s_max)));
  EXPECT_THAT(rows.at("disk_room"), HasSubstr(fmt::format("{:.3g} times", kSpareDisk_min)));
  EXPECT_THAT(rows.at("disk_rate"), HasSubstr(fmt::format("{:.3g} times", kSpareDiskRate_min)));
  EXPECT_THAT(rows.at("round_trip"), HasSubstr("`step_s` less `deadline_s`"));
}

/// Each line that is not `ok`, as the functions can make it.
std::vector<DoctorLine> every_complaint() {
  const Scenario scenario = scenario_of("real_time");
  const NetworkHost host = host_named("lab");
  HeardParticipant silent = heard_from("coordinator", scenario);
  silent.version.clear();
  HeardParticipant other = heard_from("coordinator", scenario);
  other.version = "0.0.1";
  other.status.scenario_digest[0] ^= 1U;
  LinkMeasurement bad = good_link();
  bad.answered = 1;
  bad.round_trip_s_median = bad.round_trip_s_p99 = bad.clock_offset_s = 1e3;
  const Scenario bold = scenario_of("real_time", {"bridging={type: hold, start_anyway: true}"});
  const RecordedVolume volume{.bytes = 1.0, .bytes_per_s = 1.0};
  std::vector<DoctorLine> lines{judge_name(host, NetworkType::peers, std::nullopt),
                                judge_name(host, NetworkType::peers, "127.0.1.1"),
                                judge_foreign_address("coordinator", "198.51.100.7"),
                                judge_tcp_port(5100, EADDRINUSE),
                                judge_udp_ports({7410, 7429}, std::nullopt),
                                judge_connection(host, ETIMEDOUT, false),
                                judge_clock(false),
                                judge_privileges("storey_1", {}, RealTimeGrant{.memory_error = ENOMEM})};
  for (const std::vector<DoctorLine>& more :
       {judge_others(scenario, "storey_1", {}), judge_others(scenario, "storey_1", {silent}),
        judge_others(scenario, "storey_1", {other}), judge_link(scenario, bad), judge_link(bold, bad),
        judge_link(scenario_of("paced"), bad), judge_disk(volume, "/runs", std::nullopt, 0.0),
        judge_disk(volume, "/runs", 0.0, 0.0)}) {
    lines.insert(lines.end(), more.begin(), more.end());
  }
  std::erase_if(lines, [](const DoctorLine& line) { return line.verdict == Verdict::good; });
  return lines;
}

TEST(DoctorPage, ExplainsEveryFinding) {
  const std::string page = text_of_source("docs/across_hosts.md");
  std::set<std::string_view> said;
  for (const DoctorLine& line : every_complaint()) {
    std::size_t matches = 0;
    for (const std::string_view words : kDoctorFindings) {
      if ((line.text + " -> " + line.advice).find(words) == std::string::npos) continue;
      said.insert(words);
      ++matches;
    }
    EXPECT_EQ(matches, 1U) << line.text << " -> " << line.advice;
  }
  for (const std::string_view words : kDoctorFindings) {
    EXPECT_TRUE(said.contains(words)) << words << ": nothing says so";
    EXPECT_THAT(page, HasSubstr(fmt::format("| `{}` |", words)));
  }
}

}  // namespace
}  // namespace hybridtest
