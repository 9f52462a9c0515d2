#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/system/across_hosts/across_hosts_fixture.hpp"

/// `hybridtest doctor` of three participants at the same time.
namespace hybridtest {
namespace {

using ::testing::HasSubstr;
using ::testing::Optional;

class Doctor : public AcrossHosts {
 protected:
  [[nodiscard]] StartedProgram examine(const std::string& id, Arguments more = {}) const {
    Arguments arguments = network();
    arguments.insert(arguments.end(), {"--loopback-only", "--measure", "0.5", "--json", "--out", directory().string()});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return start("hybridtest", id, arguments);
  }

  /// The lines of this code that begin with the text, as `verdict: text -> advice`.
  static std::vector<std::string> lines_of(const StartedProgram& doctor, const std::string& code) {
    std::vector<std::string> lines;
    const auto report = nlohmann::json::parse(doctor.standard_output(), nullptr, false);
    if (report.is_discarded()) return {"no JSON: " + doctor.standard_output() + doctor.standard_error()};
    for (const auto& line : report["checks"]) {
      if (line["code"] != code) continue;
      lines.push_back(line["verdict"].get<std::string>() + ": " + line["text"].get<std::string>() + " -> " +
                      line["advice"].get<std::string>());
    }
    return lines;
  }

  /// Every code is explained in the page for operators.
  static void expect_documented(const StartedProgram& doctor) {
    const std::string page = text_of(std::filesystem::path{HYBRIDTEST_SOURCE_DIR} / "docs/across_hosts.md");
    for (const auto& line : nlohmann::json::parse(doctor.standard_output())["checks"]) {
      const std::string code = line["code"];
      EXPECT_THAT(page, HasSubstr("| `" + code + "` |"));
    }
  }
};

using ::testing::Contains;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::SizeIs;
using ::testing::StartsWith;

TEST_F(Doctor, ThreeHostsFindEachOtherReady) {
  StartedProgram site = examine("storey_1");
  StartedProgram numerical = examine("storey_2");
  StartedProgram coordinator = examine("coordinator");
  ASSERT_THAT(coordinator.wait(), Optional(kExitCompleted)) << coordinator.standard_output();
  EXPECT_THAT(site.wait(), Optional(kExitCompleted)) << site.standard_output();
  EXPECT_THAT(numerical.wait(), Optional(kExitCompleted)) << numerical.standard_output();
  const auto report = nlohmann::json::parse(coordinator.standard_output());
  EXPECT_TRUE(report["ready"]);
  ASSERT_EQ(report["links"].size(), 2U);
  for (const auto& link : report["links"]) {
    EXPECT_EQ(link["sent"], 100);
    EXPECT_GT(link["round_trip_s_min"], 0.0);
    // One host has one clock. The offset of a process is drawn from it once, to some microseconds.
    EXPECT_LE(std::abs(link["clock_offset_s"].get<double>()), link["clock_uncertainty_s"].get<double>() + 1e-4);
  }
  EXPECT_THAT(lines_of(coordinator, "digest"), Each(StartsWith("ok: ")));
  // The substructure was told what the coordinator measured.
  EXPECT_THAT(lines_of(site, "round_trip"), SizeIs(1));
  EXPECT_THAT(lines_of(site, "clock_offset"), Each(HasSubstr("storey_1: its clock")));
  expect_documented(coordinator);
  expect_documented(site);
}

TEST_F(Doctor, AnotherScenarioIsToldToBothSides) {
  StartedProgram site = examine("storey_1", {"--set", "excitation.scale=0.5"});
  StartedProgram numerical = examine("storey_2");
  StartedProgram coordinator = examine("coordinator");
  EXPECT_THAT(coordinator.wait(), Optional(kExitConfiguration));
  EXPECT_THAT(site.wait(), Optional(kExitConfiguration));
  EXPECT_THAT(numerical.wait(), Optional(kExitCompleted)) << numerical.standard_output();
  EXPECT_THAT(lines_of(coordinator, "digest"), Contains(HasSubstr("fix: storey_1 has another scenario")));
  EXPECT_THAT(lines_of(coordinator, "digest"), Contains(HasSubstr("ok: storey_2 has the same scenario")));
  EXPECT_THAT(lines_of(site, "digest"), Contains(HasSubstr("fix: coordinator has another scenario")));
}

TEST_F(Doctor, MissingParticipantsAreNamed) {
  StartedProgram coordinator = examine("coordinator", {"--wait", "2"});
  EXPECT_THAT(coordinator.wait(), Optional(kExitConfiguration));
  EXPECT_THAT(lines_of(coordinator, "discovery"), SizeIs(2));
  EXPECT_THAT(lines_of(coordinator, "discovery"), Each(HasSubstr("was not found")));
}

TEST_F(Doctor, ConnectionThatNobodyAcceptsIsTold) {
  const Arguments profile{
      "--network",
      write("tcp.yaml", "schema: hybridtest-network/1\ntype: tcp\nhosts: {coordinator: {host: 127.0.0.1, listens: " +
                            std::to_string(free_port()) + "}, storey_1: {}}\n")};
  Arguments arguments{"--wait", "1", "--json", "--out", directory().string()};
  arguments.insert(arguments.end(), profile.begin(), profile.end());
  StartedProgram site = start("hybridtest", "storey_1", arguments);
  EXPECT_THAT(site.wait(), Optional(kExitConfiguration));
  EXPECT_THAT(lines_of(site, "connection"), ElementsAre(HasSubstr("Connection refused -> nobody listens there now")));
  expect_documented(site);
}

TEST_F(Doctor, WrongNameAndTakenPortAreToldBeforeTheNetwork) {
  const int port = free_port();
  StartedProgram server =
      start("coordinator", "coordinator",
            with_profile("type: tcp\nhosts: {coordinator: {host: 127.0.0.1, listens: " + std::to_string(port) +
                         "}, storey_1: {}, storey_2: {}}\n"));
  const std::string listens = "127.0.0.1, listens: " + std::to_string(port);
  const Arguments profile{
      "--network", write("wrong.yaml", "schema: hybridtest-network/1\ntype: tcp\nhosts: {coordinator: {host: " +
                                           listens + "}, storey_1: {host: no.such.host.invalid, listens: 5}}\n")};
  std::optional<StartedProgram> doctor;
  ASSERT_TRUE(wait_until([&] {
    doctor.emplace(examine("coordinator", profile));
    static_cast<void>(doctor->wait());
    return !lines_of(*doctor, "port").empty() && lines_of(*doctor, "port").front().starts_with("fix: ");
  })) << doctor->standard_output();
  EXPECT_THAT(lines_of(*doctor, "port"), Each(HasSubstr("TCP port " + std::to_string(port))));
  EXPECT_THAT(lines_of(*doctor, "host_name"), Contains(HasSubstr("fix: storey_1: host no.such.host.invalid")));
  EXPECT_THAT(doctor->wait(), Optional(kExitConfiguration));
  expect_documented(*doctor);
}

TEST_F(Doctor, UnknownParticipantIsRefused) {
  StartedProgram doctor = examine("storey_7");
  EXPECT_THAT(doctor.wait(), Optional(kExitConfiguration));
  EXPECT_THAT(doctor.standard_error(), HasSubstr("expected one of coordinator, storey_1, storey_2"));
}

}  // namespace
}  // namespace hybridtest
