#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "transport/simulated/simulated_network.hpp"

namespace hybridtest::simulated {

/// Latencies of sites that are spread over the internet: log-normal, so that few are very near and few are very far.
/// The same seed gives the same latencies; a site more at the end changes none of the others.
/// @param median   of the sites, one way.
/// @param spread   standard deviation of the natural logarithm of the latency; not negative.
[[nodiscard]] std::vector<SiteLatency> draw_site_latencies(std::uint64_t seed, const std::vector<std::string>& sites,
                                                           Duration median, double spread);

}  // namespace hybridtest::simulated
