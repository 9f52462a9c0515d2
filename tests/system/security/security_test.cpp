#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <ctime>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "tests/support/packet_fuzzer.hpp"
#include "tests/support/system_fixture.hpp"
#include "tests/system/security/intruder.hpp"

/// Live intruders in real tests: with credentials they are kept out and the result is that without them; without
/// credentials the same intruders do get in.
namespace hybridtest {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Optional;

std::string utc_in(std::chrono::seconds time) {
  const std::time_t then = std::time(nullptr) + time.count();
  std::tm parts{};
  gmtime_r(&then, &parts);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text.data();
}

class Security : public SystemTest {
 protected:
  const std::filesystem::path scenario_ = shipped_scenario("two_storey_one_site");
  // A busy machine is no intruder.
  const Arguments short_{"--set", "time.duration_s=2",
                         "--set", "timeouts={discovery_s: 120, liveliness_lease_s: 30}",
                         "--set", "substructures[storey_1].limits.command_age_s=60"};
  // For intruders who do get in: at full speed the test may be over before they have discovered it.
  const Arguments paced_{"--set", "time.mode=paced", "--set", "time.duration_s=10"};

  /// Runs launch/security/make_credentials for this test into a folder.
  void make_credentials(const std::string& folder, const Arguments& more = {}) {
    Arguments arguments{scenario_.string(),    "--out",        (directory_of(folder)).string(), "--set",
                        "name=" + test_name(), "--hybridtest", program("hybridtest").string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    StartedProgram script{std::filesystem::path{HYBRIDTEST_SOURCE_DIR} / "launch/security/make_credentials", arguments,
                          directory() / ("make_" + folder + std::to_string(made_++))};
    ASSERT_THAT(script.wait(), Optional(0)) << script.standard_error();
  }
  [[nodiscard]] std::filesystem::path directory_of(const std::string& folder) const { return directory() / folder; }

  /// Of somebody in this process who joins the test on this machine.
  [[nodiscard]] fast_dds::FastDdsSettings joining(const std::string& credentials = {}) const {
    fast_dds::FastDdsSettings settings;
    settings.domain = static_cast<std::uint32_t>(std::stoi(network().back()));
    settings.loopback_only = true;
    settings.is_observer = true;
    if (!credentials.empty()) settings.credentials = directory() / credentials;
    return settings;
  }
  [[nodiscard]] Arguments unsecured(const Arguments& more) const {
    Arguments arguments = short_;
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  [[nodiscard]] Arguments secured(const Arguments& more) const {
    Arguments arguments = unsecured({"--credentials", directory_of("true").string()});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }

  void expect_same_as_simulated(const std::string& run) {
    StartedProgram simulated = start_simulate(scenario_, "simulated", short_);
    ASSERT_THAT(simulated.wait(), Optional(kExitCompleted)) << simulated.standard_error();
    for (const char* column : {"displacement_floor_1_m", "displacement_floor_2_m", "restoring_force_floor_1_n"}) {
      EXPECT_EQ(recorded(run).column(kCoordinatorId, "steps", column),
                recorded("simulated").column(kCoordinatorId, "steps", column));
    }
  }

 private:
  int made_ = 0;
};

TEST_F(Security, DoctorLooksAtLinksWithCredentials) {
  make_credentials("true");
  std::vector<StartedProgram> doctors;
  for (const std::string& id : {std::string{"storey_1"}, std::string{"storey_2"}, std::string{kCoordinatorId}}) {
    Arguments arguments{"doctor",
                        scenario_.string(),
                        "--id",
                        id,
                        "--set",
                        "name=" + test_name(),
                        "--loopback-only",
                        "--measure",
                        "0.5",
                        "--out",
                        directory().string(),
                        "--credentials",
                        (directory_of("true") / id).string()};
    for (const std::string& argument : network()) arguments.push_back(argument);
    doctors.push_back(start_hybridtest(arguments, "doctor_" + id));
  }
  for (StartedProgram& doctor : doctors) {
    EXPECT_THAT(doctor.wait(), Optional(kExitCompleted)) << doctor.standard_output() << doctor.standard_error();
  }
}

TEST_F(Security, IntrudersAreKeptOutAndTheTestGoesOn) {
  make_credentials("true", {"--observer", "bob"});
  // As whoever asks for credentials may also do it: another authority with the same names.
  make_credentials("false", {"--operator", "bob"});
  // A genuine coordinator whose certificate has expired.
  std::filesystem::copy(directory_of("true"), directory_of("expired"), std::filesystem::copy_options::recursive);
  make_credentials("expired", {"--renew", "--expires", utc_in(std::chrono::seconds{8})});
  const std::time_t expired = std::time(nullptr) + 9;
  // Genuine identity of an observer, with home-made permissions of an operator.
  std::filesystem::copy(directory_of("true") / "bob", directory_of("promoted"));
  for (const char* file : {"permissions_ca.pem", "governance.p7s", "permissions.p7s"}) {
    std::filesystem::copy_file(directory_of("false") / "bob" / file, directory_of("promoted") / file,
                               std::filesystem::copy_options::overwrite_existing);
  }

  std::map<std::string, std::unique_ptr<Intruder>> intruders;
  const IntruderMeans everything{.stops = true, .commands = true, .forges_storey_2 = true};
  const IntruderMeans of_a_coordinator{.stops = true, .commands = true};
  const auto intrude = [&](const std::string& who, const std::string& credentials, IntruderMeans means) {
    // A site hears the coordinator alone; with the observer's it learns who the other site is.
    const std::string ears = who == "another site" ? "true/bob" : credentials;
    intruders[who] = std::make_unique<Intruder>(joining(credentials), joining(ears), test_name(), means);
  };
  intrude("expired certificate", "expired/coordinator", of_a_coordinator);
  intrude("no certificate", {}, everything);
  intrude("wrong authority", "false/coordinator", of_a_coordinator);
  intrude("home-made permissions", "promoted", {.stops = true});
  intrude("another site", "true/storey_1", {.forges_storey_2 = true});
  ASSERT_TRUE(wait_until([&] { return std::time(nullptr) > expired; }));

  // The test waits for storey_2 until all intruders have had their chance.
  StartedProgram run = start_run(scenario_, "run", secured({"--remote", "storey_2", "--loopback-only"}));
  const Intruder& insider = *intruders["another site"];
  ASSERT_TRUE(wait_until([&] { return insider.heard() > 1; })) << run.standard_error();
  std::map<std::string, std::uint64_t> before;
  for (const auto& [who, intruder] : intruders) before[who] = intruder->attempts();
  ASSERT_TRUE(wait_until([&] {
    return std::ranges::all_of(intruders,
                               [&](const auto& one) { return one.second->attempts() > before[one.first] + 100; });
  }));
  Arguments of_storey_2 = short_;
  of_storey_2.insert(of_storey_2.end(), {"--credentials", (directory_of("true") / "storey_2").string()});
  StartedProgram storey_2 =
      start_participant("numerical_substructure", "storey_2", scenario_, "run_of_storey_2", of_storey_2);
  ASSERT_THAT(run.wait(), Optional(kExitCompleted)) << run.standard_error();
  ASSERT_THAT(storey_2.wait(), Optional(kExitCompleted)) << storey_2.standard_error();
  EXPECT_TRUE(insider.has_moved());
  for (const auto& [who, intruder] : intruders) {
    if (intruder.get() == &insider) continue;
    EXPECT_EQ(intruder->heard(), 0U) << who << " discovered the test";
  }
  EXPECT_EQ(recorded("run").summary()["completed_steps"], 2000);
  EXPECT_EQ(recorded("run").summary()["data_valid"], true);
  expect_same_as_simulated("run");
}

/// Over TCP discovery and messages share a connection and a filter.
TEST_F(Security, OverTcpThePacketFilterAdmitsTheTestItself) {
  make_credentials("true");
  const std::filesystem::path profile = directory() / "network.yaml";
  std::ofstream{profile}
      << "schema: hybridtest-network/1\ntype: tcp\nhosts:\n  coordinator: {host: 127.0.0.1, listens: "
      << 20'000 + std::stoi(network().back()) << "}\n  storey_1: {}\n  storey_2: {}\n";
  StartedProgram run = start_run(scenario_, "run", secured({"--network", profile.string()}));
  ASSERT_THAT(run.wait(), Optional(kExitCompleted)) << run.standard_error();
  const nlohmann::json participants = recorded("run").summary()["participants"];
  ASSERT_EQ(participants.size(), 3U);
  for (const nlohmann::json& one : participants) {
    for (const char* kind : {"harmful", "in_plain_text", "announcements"}) {
      EXPECT_EQ(one["refused_packets"][kind], 0) << one["participant"] << ' ' << kind;
    }
  }
  expect_same_as_simulated("run");
}

TEST_F(Security, WithoutCredentialsAStrangerStopsTheTest) {
  const Intruder stranger{joining(), joining(), test_name(), {.stops = true}};
  StartedProgram run = start_run(scenario_, "run", unsecured(paced_));
  EXPECT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  EXPECT_GT(stranger.heard(), 0U);
}

TEST_F(Security, StolenKeyThatHasNotExpiredGetsIn) {
  make_credentials("true");
  const Intruder thief{joining("true/coordinator"), joining("true/coordinator"), test_name(), {.stops = true}};
  StartedProgram run = start_run(scenario_, "run", secured(paced_));
  EXPECT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();
  EXPECT_GT(thief.heard(), 0U);
}

TEST_F(Security, WithoutCredentialsAnotherSiteForgesAForce) {
  const Intruder other_site{joining(), joining(), test_name(), {.forges_storey_2 = true}};
  ASSERT_TRUE(wait_until([&] { return other_site.has_moved(); }));
  StartedProgram run = start_run(scenario_, "run", unsecured(paced_));
  ASSERT_TRUE(run.wait());
  StartedProgram simulated = start_simulate(scenario_, "simulated", unsecured(paced_));
  ASSERT_THAT(simulated.wait(), Optional(kExitCompleted));
  EXPECT_NE(recorded("run").column(kCoordinatorId, "steps", "displacement_floor_2_m"),
            recorded("simulated").column(kCoordinatorId, "steps", "displacement_floor_2_m"));
}

/// Somebody without credentials who reads all packets of a test with credentials, and sends others. Forgery.* shows
/// that Fast DDS alone takes some of them in.
class SecurityFuzz : public Security {
 protected:
  void SetUp() override {
    if (const std::string why = PacketFuzzer::why_not(); !why.empty()) GTEST_SKIP() << why;
  }
  void expect_unharmed(PacketFuzzer::Kind kind) {
    make_credentials("true");
    const PacketFuzzer fuzzer{std::stoi(network().back()), 1, kind};
    StartedProgram run = start_run(scenario_, "run", secured({}));
    ASSERT_THAT(run.wait(), Optional(kExitCompleted)) << run.standard_error();
    EXPECT_GT(fuzzer.sent(), 1000U);
    EXPECT_EQ(recorded("run").summary()["data_valid"], true);
    expect_same_as_simulated("run");
  }
};

TEST_F(SecurityFuzz, NoiseChangesNoBit) { expect_unharmed(PacketFuzzer::Kind::noise); }

TEST_F(SecurityFuzz, CutPacketsChangeNoBit) { expect_unharmed(PacketFuzzer::Kind::cut_packets); }

TEST_F(SecurityFuzz, AlteredPacketsChangeNoBit) { expect_unharmed(PacketFuzzer::Kind::altered_packets); }

TEST_F(SecurityFuzz, PacketsInAnotherOrderChangeNoBit) { expect_unharmed(PacketFuzzer::Kind::disordered_packets); }

TEST_F(SecurityFuzz, ForgedPacketsChangeNoBit) { expect_unharmed(PacketFuzzer::Kind::forged_packets); }

TEST_F(Security, OperatorStopsTheTestAndObserverMayNot) {
  make_credentials("true", {"--operator", "alice", "--observer", "bob"});
  StartedProgram run =
      start_run(scenario_, "run",
                secured({"--set", "time.mode=paced", "--set", "time.step_s=0.01", "--set", "time.duration_s=30"}));
  ASSERT_TRUE(has_recorded("run", kCoordinatorId, 10.0)) << run.standard_error();
  const auto stop_as = [&](const std::string& who) {
    Arguments arguments{"emergency-stop", test_name(), "--credentials", (directory_of("true") / who).string()};
    std::ranges::copy(network(), std::back_inserter(arguments));
    return start_hybridtest(arguments, "stop_" + who);
  };
  StartedProgram bob = stop_as("bob");
  EXPECT_THAT(bob.wait(), Optional(kExitConfiguration));
  EXPECT_THAT(bob.standard_error(), HasSubstr("these credentials do not permit to write 'hybridtest/4/test_control'"));
  EXPECT_TRUE(run.is_running());
  StartedProgram alice = stop_as("alice");
  // A coordinator that obeyed at once may have left before the tool discovered it.
  EXPECT_THAT(alice.wait(), AnyOf(Optional(kExitCompleted), Optional(kExitEndedEarly))) << alice.standard_error();
  EXPECT_THAT(run.wait(), Optional(kExitEndedEarly)) << run.standard_error();

  // No key in anything that was written.
  std::set<std::string> secrets;
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator{directory_of("true")}) {
    const std::string extension = entry.path().extension();
    if (extension != ".key" && entry.path().filename() != "private_key.pem") continue;
    struct stat status {};
    ASSERT_EQ(::stat(entry.path().c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777U, 0600U) << entry.path();
    std::istringstream key{text_of(entry.path())};
    for (std::string line; std::getline(key, line);) {
      if (line.find("-----") == std::string::npos) secrets.insert(line);
    }
  }
  ASSERT_GE(secrets.size(), 7U);
  for (const auto& entry : std::filesystem::recursive_directory_iterator{directory()}) {
    if (!entry.is_regular_file() || entry.path().string().starts_with(directory_of("true").string())) continue;
    ++files;
    const std::string text = text_of(entry.path());
    for (const std::string& secret : secrets) EXPECT_EQ(text.find(secret), std::string::npos) << entry.path();
  }
  EXPECT_GE(files, 5U);
}

TEST_F(Security, UnusableCredentialsAreToldBeforeJoining) {
  make_credentials("true", {"--operator", "alice"});
  make_credentials("false");
  const auto site_says = [&](const std::filesystem::path& folder) {
    StartedProgram site =
        start_participant("experimental_site", "storey_1", scenario_, "site", {"--credentials", folder.string()});
    EXPECT_THAT(site.wait(), Optional(kExitConfiguration));
    EXPECT_FALSE(std::filesystem::exists(directory() / "site"));
    return site.standard_error();
  };
  EXPECT_THAT(site_says(directory_of("true") / "storey_2"), HasSubstr("these are the credentials of 'storey_2'"));
  EXPECT_THAT(site_says(directory_of("true")), HasSubstr("names the folder of one participant"));

  const std::filesystem::path spoilt = directory_of("true") / "storey_1";
  const auto with = [&](const char* file, const std::filesystem::path& other) {
    const std::string kept = text_of(spoilt / file);
    std::ofstream{spoilt / file} << text_of(other);
    std::string said = site_says(spoilt);
    std::ofstream{spoilt / file} << kept;
    return said;
  };
  EXPECT_THAT(with("certificate.pem", directory_of("false") / "storey_1/certificate.pem"),
              HasSubstr("was not issued by identity_ca.pem"));
  EXPECT_THAT(with("private_key.pem", directory_of("true") / "alice/private_key.pem"),
              HasSubstr("is not the key of certificate.pem"));
  EXPECT_THAT(with("permissions.p7s", directory_of("false") / "storey_1/permissions.p7s"),
              HasSubstr("was not signed by permissions_ca.pem"));
  EXPECT_THAT(with("private_key.pem", scenario_), HasSubstr("is not a private key"));
  ASSERT_EQ(::chmod((spoilt / "private_key.pem").c_str(), 0644), 0);
  EXPECT_THAT(site_says(spoilt), HasSubstr("run chmod 600"));
  make_credentials("true", {"--renew", "--expires", utc_in(std::chrono::seconds{-3600})});
  EXPECT_THAT(site_says(spoilt), HasSubstr("the certificate expired on"));
}

TEST_F(Security, MakingAgainKeepsTheAuthoritiesAndAddsPeople) {
  make_credentials("true");
  const std::string authority = text_of(directory_of("true") / "storey_1/identity_ca.pem");
  const std::string key = text_of(directory_of("true") / "storey_1/private_key.pem");
  make_credentials("true", {"--operator", "alice"});
  EXPECT_EQ(text_of(directory_of("true") / "alice/identity_ca.pem"), authority);
  EXPECT_EQ(text_of(directory_of("true") / "storey_1/private_key.pem"), key);
  EXPECT_FALSE(authority.empty());
}

}  // namespace
}  // namespace hybridtest
