#include "diagnosis/localisation/band_shares.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace hybridtest {
namespace {

/// Lines of the spectrum that the first band holds; below them nothing can be told apart.
constexpr double kLinesOfFirstBand = 3.0;

void accumulate(BandShare& band, const Spectra& spectra, std::size_t line, double& coherent) {
  const double power = spectra.output[line] * spectra.resolution_hz;
  band.share += power;
  coherent += power * spectra.coherence(line);
}

}  // namespace

std::vector<BandShare> gap_over_frequency(const GapSignals& signals, const Spectra& spectra) {
  const double whole = std::accumulate(spectra.output.begin(), spectra.output.end(), 0.0) * spectra.resolution_hz;
  const double output = mean_square(signals.measured);
  const double half_rate_hz = spectra.frequency_hz(spectra.output.size() - 1);
  std::vector<BandShare> bands;
  double low_hz = 0.0;
  double high_hz = kLinesOfFirstBand * spectra.resolution_hz;
  std::size_t line = 0;
  while (line < spectra.output.size()) {
    BandShare band{.low_hz = low_hz, .high_hz = std::min(high_hz, half_rate_hz)};
    double coherent = 0.0;
    for (; line < spectra.output.size() && (spectra.frequency_hz(line) < high_hz || high_hz >= half_rate_hz); ++line) {
      accumulate(band, spectra, line, coherent);
    }
    band.coherence = band.share > 0.0 ? coherent / band.share : 0.0;
    band.nrmse = output > 0.0 ? std::sqrt(band.share / output) : 0.0;
    band.share = whole > 0.0 ? band.share / whole : 0.0;
    bands.push_back(band);
    low_hz = high_hz;
    high_hz *= std::numbers::sqrt2;
  }
  return bands;
}

std::vector<BandShare> bands_holding(const std::vector<BandShare>& bands, double share) {
  std::vector<std::size_t> order(bands.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::ranges::greater{}, [&](std::size_t i) { return bands[i].share; });
  double held = 0.0;
  std::size_t kept = 0;
  while (kept < order.size() && held < share && bands[order[kept]].share > 0.0) held += bands[order[kept++]].share;
  order.resize(kept);
  std::ranges::sort(order);
  std::vector<BandShare> joined;
  for (const std::size_t i : order) {
    const BandShare& next = bands[i];
    if (joined.empty() || joined.back().high_hz != next.low_hz) {
      joined.push_back(next);
      continue;
    }
    BandShare& last = joined.back();
    last.coherence = (last.coherence * last.share + next.coherence * next.share) / (last.share + next.share);
    last.nrmse = std::hypot(last.nrmse, next.nrmse);
    last.high_hz = next.high_hz;
    last.share += next.share;
  }
  return joined;
}

}  // namespace hybridtest
