#include "validation/studies/rths_benchmark/criteria.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace hybridtest::rths {
namespace {

constexpr std::size_t kLags = 50;

std::vector<double> difference(std::span<const double> a, std::span<const double> b) {
  std::vector<double> result(a.begin(), a.end());
  for (std::size_t i = 0; i < result.size(); ++i) result[i] -= b[i];
  return result;
}

}  // namespace

double standard_deviation(std::span<const double> values) {
  const auto count = static_cast<double>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / count;
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return std::sqrt(squares / count);
}

double largest_magnitude(std::span<const double> values) {
  double largest = 0.0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

double deviation_error_percent(std::span<const double> values, std::span<const double> of) {
  return 100.0 * standard_deviation(difference(values, of)) / standard_deviation(of);
}

double peak_error_percent(std::span<const double> values, std::span<const double> of) {
  return 100.0 * largest_magnitude(difference(values, of)) / largest_magnitude(of);
}

double correlation_lag_s(std::span<const double> follower, std::span<const double> leader, double period_s) {
  std::size_t best = 0;
  double largest = -std::numeric_limits<double>::infinity();
  for (std::size_t lag = 0; lag < std::min(kLags, leader.size()); ++lag) {
    const double correlation = std::inner_product(leader.begin(), leader.end() - static_cast<std::ptrdiff_t>(lag),
                                                  follower.begin() + static_cast<std::ptrdiff_t>(lag), 0.0);
    if (correlation > largest) {
      largest = correlation;
      best = lag;
    }
  }
  return static_cast<double>(best) * period_s;
}

double fitted_delay_s(std::span<const double> follower, std::span<const double> leader, double period_s) {
  double error_rate = 0.0;
  double rate_rate = 0.0;
  for (std::size_t i = 1; i + 1 < leader.size(); ++i) {
    const double rate = (leader[i + 1] - leader[i - 1]) / (2.0 * period_s);
    error_rate += (follower[i] - leader[i]) * rate;
    rate_rate += rate * rate;
  }
  return -error_rate / rate_rate;
}

Criteria evaluate_criteria(const TestSignals& test, const ReferenceSignals& reference, double period_s) {
  return {{1e3 * correlation_lag_s(test.measured_m, test.target_m, period_s),
           deviation_error_percent(test.measured_m, test.target_m), peak_error_percent(test.measured_m, test.target_m),
           deviation_error_percent(test.measured_m, reference.floor_1_m),
           peak_error_percent(test.measured_m, reference.floor_1_m),
           deviation_error_percent(test.floor_2_m, reference.floor_2_m),
           deviation_error_percent(test.floor_3_m, reference.floor_3_m),
           peak_error_percent(test.floor_2_m, reference.floor_2_m),
           peak_error_percent(test.floor_3_m, reference.floor_3_m)}};
}

Criteria no_criteria() noexcept {
  Criteria criteria;
  criteria.values.fill(std::numeric_limits<double>::quiet_NaN());
  return criteria;
}

}  // namespace hybridtest::rths
