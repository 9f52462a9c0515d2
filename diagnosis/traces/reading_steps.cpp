#include "diagnosis/traces/reading_steps.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <unsupported/Eigen/FFT>
#include <vector>

#include "diagnosis/localisation/reversals.hpp"
#include "diagnosis/signals/local_polynomial.hpp"

namespace hybridtest {
namespace {

/// Shorter recordings say nothing.
constexpr std::size_t kFewest = 64;
/// Bins over the span of the readings; their spectrum over four times that resolves steps to a quarter of what tells
/// neighbouring ones apart.
constexpr Eigen::Index kBins = 1 << 15;
constexpr Eigen::Index kPadded = 4 * kBins;
/// Steps in a span, at least.
constexpr double kFewestSteps = 6.0;
/// Steps are no finer than that multiple of the white noise: of a noise of half a step the coherence is 0.007.
constexpr double kStepOverNoise = 2.0;
/// Coherence of steps whose error, q / sqrt(12), is twice the noise behind the converter; with less it may as well be
/// an encoder's error that comes back with its pitch.
constexpr double kCoherent = 0.66;
/// Multiple of the coherence that a signal without steps may have by its reversals.
constexpr double kOverChance = 4.0;
/// Of the coherence of the finest step found, that of the one that is meant.
constexpr double kAsCoherent = 0.8;

/// The way between neighbouring samples, smoothed: how much each reading counts.
std::vector<double> ways_of(std::span<const double> values, double period) {
  const LocalPolynomial polynomial{widest_faithful_half_width(values), period};
  std::vector<double> ways;
  ways.reserve(values.size());
  for (const Motion& motion : polynomial.motion(values)) ways.push_back(std::abs(motion.velocity_m_per_s) * period);
  return ways;
}

struct Readings {
  std::span<const double> values;
  std::vector<double> ways;
  double first = 0.0;  // the least value
  double span = 0.0;
  double way = 0.0;  // all of them

  /// As many as would make up the way in equal parts.
  [[nodiscard]] double samples_that_count() const {
    double squares = 0.0;
    for (const double part : ways) squares += part * part;
    return way * way / squares;
  }
  [[nodiscard]] double coherence(double steps_in_span) const {
    std::complex<double> sum;
    for (std::size_t i = 0; i < values.size(); ++i) {
      sum += std::polar(ways[i], 2.0 * std::numbers::pi * steps_in_span * (values[i] - first) / span);
    }
    return std::abs(sum) / way;
  }
};

/// Coherence by quarters of a step in the span.
std::vector<double> coherences(const Readings& readings) {
  Eigen::VectorXd density = Eigen::VectorXd::Zero(kPadded);
  for (std::size_t i = 0; i < readings.values.size(); ++i) {
    const double place = (readings.values[i] - readings.first) / readings.span * static_cast<double>(kBins - 1);
    density[static_cast<Eigen::Index>(std::lround(place))] += readings.ways[i] / readings.way;
  }
  Eigen::FFT<double> transform;
  transform.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  Eigen::VectorXcd spectrum;
  transform.fwd(spectrum, density);
  std::vector<double> result(static_cast<std::size_t>(spectrum.size()));
  for (Eigen::Index i = 0; i < spectrum.size(); ++i) result[static_cast<std::size_t>(i)] = std::abs(spectrum[i]);
  return result;
}

/// The number of steps in the span, near `rough`, with the largest coherence (golden section).
double refined(const Readings& readings, double rough) {
  constexpr double kGolden = 0.6180339887498949;
  constexpr double kReach = 0.3;
  constexpr int kSections = 24;
  double low = rough - kReach;
  double high = rough + kReach;
  for (int i = 0; i < kSections; ++i) {
    const double left = high - kGolden * (high - low);
    const double right = low + kGolden * (high - low);
    if (readings.coherence(left) > readings.coherence(right)) {
      high = right;
    } else {
      low = left;
    }
  }
  return 0.5 * (low + high);
}

}  // namespace

ReadingSteps steps_of_readings(std::span<const double> values) {
  if (values.size() < kFewest) return {};
  const auto [low, high] = std::ranges::minmax_element(values);
  Readings readings{.values = values, .ways = ways_of(values, 1.0), .first = *low, .span = *high - *low};
  for (const double way : readings.ways) readings.way += way;
  if (!(readings.span > 0.0) || !(readings.way > 0.0)) return {};
  const double noise = white_noise_level(values);
  const double finest =
      std::min(0.25 * static_cast<double>(kBins), noise > 0.0 ? readings.span / (kStepOverNoise * noise) : 1e300);
  const std::vector<double> found = coherences(readings);
  constexpr double kPerStep = static_cast<double>(kPadded) / static_cast<double>(kBins - 1);
  const auto place = [&](double steps) { return static_cast<std::size_t>(std::lround(steps * kPerStep)); };
  if (finest <= kFewestSteps) return {};
  const auto begin = found.begin() + static_cast<std::ptrdiff_t>(place(kFewestSteps));
  const auto end = found.begin() + static_cast<std::ptrdiff_t>(place(finest));
  if (begin >= end) return {};
  const auto best = std::max_element(begin, end);
  const auto coarsest = std::find_if(begin, end, [best](double coherence) { return coherence >= kAsCoherent * *best; });
  const auto peak = std::max_element(coarsest, std::min(end, coarsest + 4));
  const double rough = static_cast<double>(peak - found.begin()) / kPerStep;
  // A way from one reversal to the next leaves at most q / pi.
  const double reversals = 1.0 + static_cast<double>(reversals_of(values, reversal_threshold_m(values)).size());
  const double by_chance = reversals * readings.span / (std::numbers::pi * rough * readings.way);
  // A way that few samples make up, as of a spike, keeps to some step or other: the largest of so many random sums.
  const double tried = static_cast<double>(end - begin);
  const double by_few = std::sqrt(std::log(tried + 2.0) / readings.samples_that_count());
  if (*peak < std::max(kCoherent, kOverChance * std::max(by_chance, by_few))) return {};
  const double steps = refined(readings, rough);
  ReadingSteps result{.step = readings.span / steps, .coherence = readings.coherence(steps)};
  return result.coherence < kCoherent ? ReadingSteps{} : result;
}

}  // namespace hybridtest
