#include "transport/simulated/site_latencies.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace hybridtest::simulated {
namespace {

using std::chrono::milliseconds;

std::vector<std::string> named_sites(int count) {
  std::vector<std::string> sites;
  for (int i = 1; i <= count; ++i) sites.push_back("site_" + std::to_string(i));
  return sites;
}

std::vector<double> sorted_ms(const std::vector<SiteLatency>& latencies) {
  std::vector<double> values;
  for (const SiteLatency& one : latencies) values.push_back(to_seconds(one.latency) * 1e3);
  std::ranges::sort(values);
  return values;
}

/// Quantiles of the log-normal distribution: median x exp(spread x z), z from tables of the normal distribution
/// (Abramowitz and Stegun, table 26.5). The standard error of a quantile of n draws is sqrt(p (1 - p) / n) over the
/// density there; five of them.
TEST(SiteLatencies, AreLogNormal) {
  constexpr int kSites = 20'000;
  constexpr double kMedian_ms = 60.0;
  constexpr double kSpread = 0.6;
  struct Quantile {
    double share;
    double z;
    double density;
  };
  const std::vector<double> drawn = sorted_ms(draw_site_latencies(3, named_sites(kSites), milliseconds{60}, kSpread));
  for (const Quantile& one :
       {Quantile{0.05, -1.64485, 0.10314}, Quantile{0.25, -0.67449, 0.31778}, Quantile{0.5, 0.0, 0.39894},
        Quantile{0.95, 1.64485, 0.10314}, Quantile{0.99, 2.32635, 0.02665}}) {
    const double found = std::log(drawn[static_cast<std::size_t>(one.share * kSites)] / kMedian_ms) / kSpread;
    const double error = std::sqrt(one.share * (1.0 - one.share) / kSites) / one.density;
    EXPECT_NEAR(found, one.z, 5.0 * error) << one.share;
  }
}

TEST(SiteLatencies, DependOnTheSeedAndNotOnFurtherSites) {
  const auto few = draw_site_latencies(1, named_sites(10), milliseconds{60}, 0.6);
  const auto many = draw_site_latencies(1, named_sites(1000), milliseconds{60}, 0.6);
  const auto others = draw_site_latencies(2, named_sites(10), milliseconds{60}, 0.6);
  for (std::size_t i = 0; i < few.size(); ++i) {
    EXPECT_EQ(few[i].participant, many[i].participant);
    EXPECT_EQ(few[i].latency, many[i].latency);
    EXPECT_NE(few[i].latency, others[i].latency);
  }
}

TEST(SiteLatencies, AreTheMedianWithoutSpread) {
  for (const SiteLatency& one : draw_site_latencies(1, named_sites(10), milliseconds{60}, 0.0)) {
    EXPECT_EQ(one.latency, milliseconds{60});
  }
}

}  // namespace
}  // namespace hybridtest::simulated
