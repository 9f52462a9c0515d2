#include "report/run_report/time_histogram.hpp"

#include <algorithm>
#include <cmath>

#include "report/run_report/tuning.hpp"

namespace hybridtest::run_report {
namespace {

constexpr int kBins = kBinsPerDecade * kDecades;

double begin_of_bin(std::size_t bin) {
  return kShortest_us * std::pow(10.0, static_cast<double>(bin) / kBinsPerDecade);
}

}  // namespace

TimeHistogram::TimeHistogram() : counts_(kBins, 0.0) {}

void TimeHistogram::add(double time_us, double count) {
  if (!std::isfinite(time_us) || !(count > 0.0)) return;
  const double place = kBinsPerDecade * std::log10(std::max(time_us, kShortest_us) / kShortest_us);
  counts_[static_cast<std::size_t>(std::clamp(place, 0.0, kBins - 1.0))] += count;
  count_ += count;
}

TimeHistogram::Outline TimeHistogram::outline() const {
  Outline outline;
  const auto is_used = [](double count) { return count > 0.0; };
  const auto first = std::ranges::find_if(counts_, is_used);
  if (first == counts_.end()) return outline;
  const auto last = std::find_if(counts_.rbegin(), counts_.rend(), is_used).base();
  const auto begin = static_cast<std::size_t>(first - counts_.begin());
  const auto end = static_cast<std::size_t>(last - counts_.begin());
  const auto corner = [&](double time_us, double percent) {
    outline.time_us.push_back(time_us);
    outline.percent.push_back(percent);
  };
  corner(begin_of_bin(begin), 0.0);
  for (std::size_t bin = begin; bin < end; ++bin) {
    corner(begin_of_bin(bin), 100.0 * counts_[bin] / count_);
    corner(begin_of_bin(bin + 1), 100.0 * counts_[bin] / count_);
  }
  corner(begin_of_bin(end), 0.0);
  return outline;
}

}  // namespace hybridtest::run_report
