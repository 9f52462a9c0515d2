#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>

#include "tests/system/across_hosts/across_hosts_fixture.hpp"
#include "tests/system/across_hosts/ssh_server.hpp"

/// `hybridtest run --hosts` against a real OpenSSH server.
namespace hybridtest {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::Optional;

class RealSsh : public AcrossHosts {
 protected:
  RealSsh() : server_{directory() / "ssh"} {
    std::ofstream{asked_script()} << "#!/bin/sh\ntouch '" << asked().string() << "'\necho secret\n";
    std::filesystem::permissions(asked_script(), std::filesystem::perms::owner_all);
  }
  void SetUp() override {
    if (!server_.why_not().empty()) GTEST_SKIP() << server_.why_not();
  }

  [[nodiscard]] StartedProgram run(const std::string& destination, const std::string& programs,
                                   const Arguments& more = {}) const {
    const std::string hosts =
        write("hosts.yaml", "schema: hybridtest-hosts/1\nhosts:\n  storey_1: {ssh: " + destination +
                                ", programs: " + programs + ", folder: " + (directory() / "there").string() + "}\n");
    Arguments words{"PATH=" + server_.programs().string() + ":/usr/bin:/bin",
                    "SSH_ASKPASS=" + asked_script().string(),
                    "SSH_ASKPASS_REQUIRE=force",
                    program("hybridtest").string(),
                    "run",
                    shipped_scenario("two_storey_one_site").string(),
                    "--out",
                    (directory() / "run").string(),
                    "--no-report",
                    "--hosts",
                    hosts,
                    "--loopback-only",
                    "--set",
                    "name=" + test_name()};
    words.insert(words.end(), more.begin(), more.end());
    for (const std::string& word : network()) words.push_back(word);
    return {"/usr/bin/env", words, directory() / "hybridtest", {}};
  }
  static std::string programs() { return program("hybridtest").parent_path().string(); }

  /// A test that has begun, with its site at `lab`. Paced, so that it does not end before somebody ends it.
  [[nodiscard]] StartedProgram running_test() const {
    StartedProgram test = run("lab", programs(), {"--set", "time.mode=paced"});
    EXPECT_TRUE(wait_until([&] { return recorded("run").last_step("coordinator") > 100; })) << test.standard_error();
    EXPECT_EQ(words_there("/experimental_site").size(), 1U);
    return test;
  }

  /// The processes on the other side that belong to this test and have these words on their command line.
  [[nodiscard]] std::vector<pid_t> words_there(const std::string& words) const {
    std::vector<pid_t> found;
    for (const auto& entry : std::filesystem::directory_iterator{"/proc"}) {
      const std::string line = text_of(entry.path() / "cmdline");
      const bool is_ours = line.find((directory() / "there").string()) != std::string::npos;
      const std::size_t first_end = line.find('\0');
      if (is_ours && line.substr(0, first_end).ends_with(words)) {
        found.push_back(static_cast<pid_t>(std::stol(entry.path().filename().string())));
      }
    }
    return found;
  }
  /// Neither the participant nor a shell that looks after it.
  [[nodiscard]] bool nothing_is_left_there() const {
    return wait_until([&] { return words_there("experimental_site").empty() && words_there("sh").empty(); });
  }
  [[nodiscard]] std::filesystem::path asked_script() const { return directory() / "askpass"; }
  [[nodiscard]] std::filesystem::path asked() const { return directory() / "somebody_was_asked"; }
  [[nodiscard]] const SshServer& server() const { return server_; }

 private:
  SshServer server_;
};

TEST_F(RealSsh, RecordingComesBackWithTheBitsOfALocalRun) {
  const Arguments settings{"--set", kDuration, "--set", kPatient};
  StartedProgram test = run("lab", programs(), settings);
  ASSERT_THAT(test.wait(), Optional(kExitCompleted)) << test.standard_error() << test.standard_output();
  Arguments more = settings;
  more.emplace_back("--no-report");
  StartedProgram local = start_run(shipped_scenario("two_storey_one_site"), "local", more);
  ASSERT_THAT(local.wait(), Optional(kExitCompleted)) << local.standard_error();
  EXPECT_EQ(displacement("run").size(), 1001U);
  EXPECT_EQ(displacement("run"), displacement("local"));
  EXPECT_EQ(recorded("run").column("storey_1", "steps", "measured_force_n"),
            recorded("local").column("storey_1", "steps", "measured_force_n"));
  EXPECT_EQ(recorded("run").summary()["data_valid"], true);
  EXPECT_TRUE(nothing_is_left_there());
  // It ran over there, on its own copy.
  const auto run_there = std::filesystem::directory_iterator { directory() / "there" } -> path();
  EXPECT_TRUE(std::filesystem::exists(run_there / "given/scenario.yaml"));
  EXPECT_EQ(text_of(run_there / "storey_1.h5"), text_of(recorded("run").file("storey_1")));
}

TEST_F(RealSsh, RefusedLoginsAreToldAndNobodyIsAsked) {
  const auto told = [&](const std::string& destination, const std::string& folder) {
    StartedProgram test = run(destination, folder);
    EXPECT_THAT(test.wait(), Optional(kExitConfiguration)) << test.standard_error();
    return test.standard_error();
  };
  const std::string not_reached = ": the host was not reached by ssh without a password: ";
  EXPECT_THAT(told("nobody_there", programs()), AllOf(HasSubstr("storey_1 on nobody_there" + not_reached),
                                                      HasSubstr("Connection refused; start the ssh")));
  EXPECT_THAT(told("wrong_key", programs()), AllOf(HasSubstr("storey_1 on wrong_key" + not_reached),
                                                   HasSubstr("it does not accept your key: `ssh-copy-id wrong_key`")));
  EXPECT_THAT(told("unknown_host", programs()),
              AllOf(HasSubstr("storey_1 on unknown_host" + not_reached),
                    HasSubstr("its key is not in known_hosts: run `ssh unknown_host`")));
  EXPECT_THAT(told("changed_host", programs()),
              AllOf(HasSubstr("storey_1 on changed_host" + not_reached),
                    HasSubstr("its key is not the one of known_hosts"), Not(HasSubstr("@@"))));
  EXPECT_THAT(told("lab", "/nowhere"), HasSubstr("storey_1 on lab: there is no program /nowhere/experimental_site"));
  EXPECT_FALSE(std::filesystem::exists(asked())) << "somebody was asked for a password";
  EXPECT_FALSE(std::filesystem::exists(recorded("run").file("coordinator"))) << "the test began";
  EXPECT_TRUE(nothing_is_left_there());
}

TEST_F(RealSsh, KilledRemoteParticipantEndsTheTestInWords) {
  StartedProgram test = running_test();
  for (const pid_t site : words_there("/experimental_site")) send_signal(site, SIGKILL);
  EXPECT_THAT(test.wait(), Optional(kExitEndedEarly)) << test.standard_error();
  EXPECT_THAT(test.standard_error(), HasSubstr("storey_1: killed by signal 9 (Killed)"));
  EXPECT_EQ(recorded("run").summary()["stop_reason"], "participant_lost");
  EXPECT_TRUE(nothing_is_left_there());
}

TEST_F(RealSsh, CutConnectionEndsTheTestAndLeavesNoOrphan) {
  StartedProgram test = running_test();
  server().cut_connections();
  EXPECT_THAT(test.wait(), Optional(kExitEndedEarly)) << test.standard_error();
  EXPECT_THAT(test.standard_error(), HasSubstr("storey_1: the ssh connection to lab was lost, so it was told to stop"));
  EXPECT_EQ(recorded("run").summary()["stop_reason"], "participant_lost");
  EXPECT_TRUE(nothing_is_left_there());
  EXPECT_TRUE(std::filesystem::exists(recorded("run").file("storey_1"))) << "its recording did not come back";
}

TEST_F(RealSsh, KilledRunLeavesNoOrphanThere) {
  StartedProgram test = running_test();
  test.signal(SIGKILL);
  EXPECT_TRUE(nothing_is_left_there());
}

}  // namespace
}  // namespace hybridtest
