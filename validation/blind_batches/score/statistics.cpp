#include "validation/blind_batches/score/statistics.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/random.hpp"

namespace hybridtest::blind {
namespace {

constexpr double kNormal95 = 1.959963984540054;
constexpr std::size_t kDraws = 2000;
constexpr std::uint64_t kSeed = 1;
constexpr std::size_t kBins = 10;

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

}  // namespace

std::optional<Estimate> proportion(std::size_t successes, std::size_t trials) {
  if (trials == 0) return {};
  const auto n = static_cast<double>(trials);
  const double share = static_cast<double>(successes) / n;
  const double z2 = kNormal95 * kNormal95;
  const double centre = (share + z2 / (2.0 * n)) / (1.0 + z2 / n);
  const double half = kNormal95 / (1.0 + z2 / n) * std::sqrt(share * (1.0 - share) / n + z2 / (4.0 * n * n));
  return Estimate{share, std::max(0.0, centre - half), std::min(1.0, centre + half), trials};
}

std::optional<Estimate> bootstrap(std::size_t count, const Statistic& statistic) {
  if (count == 0) return {};
  std::vector<std::size_t> drawn(count);
  std::iota(drawn.begin(), drawn.end(), 0U);
  const double value = statistic(drawn);
  Random random{kSeed};
  std::vector<double> values(kDraws);
  for (double& of_draw : values) {
    for (std::size_t& index : drawn) index = random.below(count);
    of_draw = statistic(drawn);
  }
  std::ranges::sort(values);
  return Estimate{value, values[kDraws / 40], values[kDraws - 1 - kDraws / 40], count};
}

std::optional<Estimate> mean(const std::vector<double>& values) {
  return bootstrap(values.size(), [&](const std::vector<std::size_t>& drawn) {
    double sum = 0.0;
    for (const std::size_t i : drawn) sum += values[i];
    return sum / static_cast<double>(drawn.size());
  });
}

std::optional<Estimate> median(const std::vector<double>& values) {
  return bootstrap(values.size(), [&](const std::vector<std::size_t>& drawn) {
    std::vector<double> chosen;
    chosen.reserve(drawn.size());
    for (const std::size_t i : drawn) chosen.push_back(values[i]);
    return median_of(std::move(chosen));
  });
}

std::optional<Estimate> calibration_error(const std::vector<Forecast>& forecasts) {
  return bootstrap(forecasts.size(), [&](const std::vector<std::size_t>& drawn) {
    std::array<double, kBins> excess{};  // probabilities less what came true, per bin
    for (const std::size_t i : drawn) {
      const auto bin = static_cast<std::size_t>(forecasts[i].probability * static_cast<double>(kBins));
      excess[std::min(bin, kBins - 1)] += forecasts[i].probability - (forecasts[i].came_true ? 1.0 : 0.0);
    }
    double sum = 0.0;
    for (const double of_bin : excess) sum += std::abs(of_bin);
    return sum / static_cast<double>(drawn.size());
  });
}

}  // namespace hybridtest::blind
