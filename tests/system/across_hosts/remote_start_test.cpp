#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>

#include "tests/system/across_hosts/across_hosts_fixture.hpp"

/// `hybridtest run --hosts` with a stand-in for ssh and scp, which does on this machine what they would do on another.
namespace hybridtest {
namespace {

using ::testing::HasSubstr;
using ::testing::Optional;

class RemoteStart : public AcrossHosts {
 protected:
  RemoteStart() {
    std::filesystem::create_directories(directory() / "bin");
    std::filesystem::create_directories(home());
    const std::filesystem::path here = std::filesystem::path{HYBRIDTEST_SOURCE_DIR} / "tests/system/across_hosts";
    std::filesystem::copy_file(here / "stand_in_ssh", directory() / "bin/ssh");
    std::filesystem::copy_file(here / "stand_in_scp", directory() / "bin/scp");
  }

  [[nodiscard]] std::filesystem::path home() const { return directory() / "home"; }

  [[nodiscard]] StartedProgram run(const std::string& destination, const std::string& programs,
                                   const Arguments& more = {}, const Arguments& environment = {}) const {
    const std::string hosts =
        write("hosts.yaml", "schema: hybridtest-hosts/1\nhosts:\n  storey_1: {ssh: " + destination +
                                ", programs: " + programs + "}\n");
    Arguments words{"PATH=" + (directory() / "bin").string() + ":/usr/bin:/bin", "STAND_IN_HOME=" + home().string()};
    words.insert(words.end(), environment.begin(), environment.end());
    words.insert(words.end(), {program("hybridtest").string(), "run", shipped_scenario("two_storey_one_site").string(),
                               "--out", (directory() / "run").string(), "--no-report", "--hosts", hosts,
                               "--loopback-only", "--set", "name=" + test_name()});
    words.insert(words.end(), more.begin(), more.end());
    for (const std::string& word : network()) words.push_back(word);
    return {"/usr/bin/env", words, directory() / "hybridtest", {}};
  }
  static std::string programs() { return program("hybridtest").parent_path().string(); }

  /// The process on the other host; 0 when there is none.
  [[nodiscard]] pid_t remote_process() const {
    for (const auto& entry : std::filesystem::directory_iterator{"/proc"}) {
      const std::string words = text_of(entry.path() / "cmdline");
      const bool is_it =
          words.starts_with(programs() + "/experimental_site") && words.find(test_name()) != std::string::npos;
      if (is_it) return static_cast<pid_t>(std::stol(entry.path().filename().string()));
    }
    return 0;
  }
};

TEST_F(RemoteStart, RecordingComesBackWithTheBitsOfSimulate) {
  StartedProgram test = run("lab", programs(), {"--set", kDuration, "--set", kPatient});
  ASSERT_THAT(test.wait(), Optional(kExitCompleted)) << test.standard_error() << test.standard_output();
  EXPECT_EQ(displacement("run"), simulated());
  EXPECT_EQ(recorded("run").column("storey_1", "steps", "measured_force_n"),
            recorded("simulated").column("storey_1", "steps", "measured_force_n"));
  EXPECT_EQ(recorded("run").summary()["data_valid"], true);
  // It ran over there, on its own copy.
  const auto run_there = std::filesystem::directory_iterator { home() / "hybridtest_runs" } -> path();
  EXPECT_TRUE(std::filesystem::exists(run_there / "given/scenario.yaml"));
  EXPECT_TRUE(std::filesystem::exists(run_there / "storey_1.h5"));
}

TEST_F(RemoteStart, FailuresAreToldInWords) {
  std::filesystem::create_directories(directory() / "old");
  std::ofstream{directory() / "old/experimental_site"} << "#!/bin/sh\necho experimental_site 0.0.1\n";
  std::filesystem::permissions(directory() / "old/experimental_site", std::filesystem::perms::owner_all);
  const auto told = [&](const std::string& destination, const std::string& folder, const Arguments& environment) {
    StartedProgram test = run(destination, folder, {}, environment);
    EXPECT_THAT(test.wait(), Optional(kExitConfiguration)) << test.standard_error();
    return test.standard_error();
  };
  EXPECT_THAT(told("unreachable", programs(), {}), HasSubstr("storey_1 on unreachable: the host was not reached"));
  EXPECT_THAT(told("lab", "/nowhere", {}), HasSubstr("there is no program /nowhere/experimental_site"));
  EXPECT_THAT(told("lab", (directory() / "old").string(), {}), HasSubstr("another version: expected"));
  EXPECT_THAT(told("lab", programs(), {"STAND_IN_DAMAGE=1"}), HasSubstr("the copy of the scenario there differs"));
  std::filesystem::create_directories(directory() / "empty");
  EXPECT_THAT(told("lab", programs(), {"PATH=" + (directory() / "empty").string()}),
              HasSubstr("there is no program ssh on this host"));
  EXPECT_FALSE(std::filesystem::exists(recorded("run").file("coordinator"))) << "the test began";
}

TEST_F(RemoteStart, RemoteParticipantEndsWithTheRunThatIsKilled) {
  StartedProgram test = run("lab", programs(), {"--set", "time.mode=paced"});
  ASSERT_TRUE(wait_until([&] { return recorded("run").last_step("coordinator") > 100; })) << test.standard_error();
  const pid_t remote = remote_process();
  ASSERT_NE(remote, 0);
  ASSERT_TRUE(is_alive(remote));
  test.signal(SIGKILL);
  EXPECT_TRUE(wait_until([&] { return !is_alive(remote); }));
}

TEST_F(RemoteStart, StopReachesTheRemoteParticipant) {
  StartedProgram test = run("lab", programs(), {"--set", "time.mode=paced"});
  ASSERT_TRUE(wait_until([&] { return recorded("run").last_step("coordinator") > 100; })) << test.standard_error();
  test.signal(SIGINT);
  EXPECT_THAT(test.wait(), Optional(kExitEndedEarly)) << test.standard_error();
  EXPECT_EQ(remote_process(), 0);
  EXPECT_TRUE(std::filesystem::exists(recorded("run").file("storey_1"))) << "its recording did not come back";
}

}  // namespace
}  // namespace hybridtest
