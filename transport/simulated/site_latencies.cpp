#include "transport/simulated/site_latencies.hpp"

#include <cmath>

#include "core/random.hpp"

namespace hybridtest::simulated {

std::vector<SiteLatency> draw_site_latencies(std::uint64_t seed, const std::vector<std::string>& sites, Duration median,
                                             double spread) {
  Random random{seed, 0x7369746573};
  std::vector<SiteLatency> latencies;
  for (const std::string& site : sites) {
    latencies.push_back({site, from_seconds(to_seconds(median) * std::exp(spread * random.normal()))});
  }
  return latencies;
}

}  // namespace hybridtest::simulated
