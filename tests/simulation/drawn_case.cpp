#include "tests/simulation/drawn_case.hpp"

#include <algorithm>
#include <array>

#include "core/random.hpp"
#include "runtime/participant.hpp"

namespace hybridtest {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

/// With four heartbeats to the lease and this share of all messages lost, one lease in ten
/// thousand passes without one: beyond it a loss of the test is what was asked for.
constexpr double kHarmlessLoss = 0.03;

template <class Value, std::size_t size>
Value pick(Random& random, const std::array<Value, size>& values) {
  return values[random.below(size)];
}

milliseconds between(Random& random, std::uint64_t low_ms, std::uint64_t high_ms) {
  return milliseconds{static_cast<std::int64_t>(low_ms + random.below(high_ms - low_ms + 1))};
}

std::string seconds_text(Duration duration) { return std::to_string(to_seconds(duration)); }

std::string microseconds_text(Duration duration) {
  return std::to_string(std::chrono::duration_cast<microseconds>(duration).count());
}

}  // namespace

bool DrawnCase::is_harmless() const {
  return settings.kills.empty() && !has_long_outage && settings.network.loss <= kHarmlessLoss;
}

bool DrawnCase::is_killed(const std::string& participant) const {
  return std::ranges::find(settings.kills, participant, &SimulatedKill::participant) != settings.kills.end();
}

std::string DrawnCase::command() const {
  const simulated::NetworkConditions& network = settings.network;
  std::string text = "hybridtest simulate launch/scenarios/" + scenario + ".yaml --seed " +
                     std::to_string(settings.seed) + " --latency-us " + microseconds_text(network.latency) +
                     " --jitter-us " + microseconds_text(network.jitter) + " --loss " + std::to_string(network.loss) +
                     " --duplication " + std::to_string(network.duplication) + " --reordering " +
                     std::to_string(network.reordering);
  for (const simulated::Outage& outage : network.outages) {
    text += " --outage " + outage.participant + ":" + seconds_text(outage.begin) + ":" + seconds_text(outage.end);
  }
  for (const SimulatedKill& kill : settings.kills) text += " --kill " + kill.participant + ":" + seconds_text(kill.at);
  for (const std::string& override : overrides) text += " --set " + override;
  return text;
}

DrawnCase draw_case(std::uint64_t seed, CouplingMode mode) {
  static const std::array<std::vector<std::string>, 3> kParticipants{{
      {std::string{kCoordinatorId}, "storey_1", "storey_2"},
      {std::string{kCoordinatorId}, "first_storey_columns", "second_storey_columns"},
      {std::string{kCoordinatorId}, "isolators", "superstructure"},
  }};
  static const std::array<std::string, 3> kScenarios{"two_storey_one_site", "two_storey_two_sites",
                                                     "three_storey_base_isolated"};
  const bool is_paced = mode == CouplingMode::paced;
  Random random{seed, is_paced ? 1U : 0U};
  DrawnCase drawn;
  drawn.scenario = kScenarios[seed % kScenarios.size()];
  const auto& participants = kParticipants[seed % kScenarios.size()];

  drawn.overrides = {kPulse, std::string{"time.mode="} + (is_paced ? "paced" : "lockstep"),
                     "time.duration_s=" + pick<std::string, 4>(random, {"0.3", "0.5", "0.8", "1.0"}),
                     "excitation.scale=" + pick<std::string, 4>(random, {"0.5", "1.0", "2.0", "4.0"})};
  if (is_paced) drawn.overrides.push_back("time.time_scale=" + pick<std::string, 3>(random, {"1.0", "2.0", "5.0"}));

  drawn.settings.seed = seed;
  simulated::NetworkConditions& network = drawn.settings.network;
  network.latency = microseconds{static_cast<std::int64_t>(10 + random.below(2000))};
  network.jitter = microseconds{static_cast<std::int64_t>(random.below(3000))};
  network.loss = pick<double, 6>(random, {0.0, 0.0, 0.005, 0.01, 0.03, 0.1});
  network.duplication = pick<double, 4>(random, {0.0, 0.01, 0.1, 0.3});
  network.reordering = pick<double, 4>(random, {0.0, 0.01, 0.1, 0.3});
  const auto anybody = [&] { return participants[random.below(participants.size())]; };
  if (random.uniform() < 0.3) {
    // Shorter than a lease minus two heartbeats, which the outage can also hide.
    const Duration begin = between(random, 0, 4000);
    network.outages.push_back({anybody(), begin, begin + between(random, 50, 600)});
  }
  if (random.uniform() < 0.15) {
    const Duration begin = between(random, 0, 4000);
    network.outages.push_back({anybody(), begin, begin + between(random, 3000, 8000)});
    drawn.has_long_outage = true;
  }
  if (random.uniform() < 0.25) drawn.settings.kills.push_back({anybody(), between(random, 0, 4000)});
  return drawn;
}

}  // namespace hybridtest
