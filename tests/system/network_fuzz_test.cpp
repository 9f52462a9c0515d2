#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "tests/support/packet_fuzzer.hpp"
#include "tests/support/recording_checks.hpp"
#include "tests/support/system_fixture.hpp"

/// Whole tests on a network on which somebody sends what nobody should send. HYBRIDTEST_FUZZ_SECONDS makes them longer.
namespace hybridtest {
namespace {

using ::testing::Optional;

class NetworkFuzz : public SystemTest {
 protected:
  void SetUp() override {
    if (const std::string why = PacketFuzzer::why_not(); !why.empty()) GTEST_SKIP() << why;
  }
  [[nodiscard]] static std::string seconds() {
    const char* asked = std::getenv("HYBRIDTEST_FUZZ_SECONDS");
    return asked == nullptr ? "3" : asked;
  }
  [[nodiscard]] int domain() const { return std::stoi(network().back()); }
  [[nodiscard]] static std::chrono::seconds patience() { return std::chrono::seconds{60 + std::stoi(seconds())}; }

  /// The test goes on as if nobody were there.
  void expect_unharmed(PacketFuzzer::Kind kind) const {
    StartedProgram alone = start_simulate(shipped_scenario("two_storey_one_site"), "alone",
                                          {"--set", "time.mode=lockstep", "--set", "time.duration_s=" + seconds()});
    ASSERT_THAT(alone.wait(), Optional(kExitCompleted)) << alone.standard_error();
    const PacketFuzzer fuzzer{domain(), 1, kind};
    StartedProgram run =
        start_run(shipped_scenario("two_storey_one_site"), "run", {"--set", "time.duration_s=" + seconds()});
    ASSERT_THAT(run.wait(patience()), Optional(kExitCompleted)) << run.standard_error();
    EXPECT_GT(fuzzer.sent(), 1000U);
    EXPECT_EQ(recorded("run").column("coordinator", "steps", "displacement_floor_2_m"),
              recorded("alone").column("coordinator", "steps", "displacement_floor_2_m"));
  }
};

TEST_F(NetworkFuzz, NoiseChangesNoBit) { expect_unharmed(PacketFuzzer::Kind::noise); }

TEST_F(NetworkFuzz, MalformedPacketsChangeNoBit) { expect_unharmed(PacketFuzzer::Kind::malformed_packets); }

TEST_F(NetworkFuzz, CutPacketsChangeNoBit) { expect_unharmed(PacketFuzzer::Kind::cut_packets); }

}  // namespace
}  // namespace hybridtest
