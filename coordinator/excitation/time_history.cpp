#include "coordinator/excitation/time_history.hpp"

#include <algorithm>
#include <cstddef>

namespace hybridtest {
namespace {

/// Times that are samples up to rounding count as samples, the last one too.
constexpr double kSampleRounding = 1e-9;

}  // namespace

double interpolated(std::span<const double> values, double dt_s, double start_s, double time_s) noexcept {
  if (values.empty()) return 0.0;
  const double position = (time_s - start_s) / dt_s;
  const auto last = static_cast<double>(values.size() - 1);
  // Written so that NaN counts as outside.
  if (!(position >= -kSampleRounding && position <= last + kSampleRounding)) return 0.0;
  const double inside = std::clamp(position, 0.0, last);
  const auto index = static_cast<std::size_t>(inside);
  if (index + 1 >= values.size()) return values.back();
  const double fraction = inside - static_cast<double>(index);
  return values[index] + fraction * (values[index + 1] - values[index]);
}

std::vector<double> at_steps(const std::function<double(double time_s)>& history, double step_s,
                             std::int64_t last_step) {
  std::vector<double> values;
  values.reserve(static_cast<std::size_t>(last_step) + 1);
  for (std::int64_t step = 0; step <= last_step; ++step) values.push_back(history(static_cast<double>(step) * step_s));
  return values;
}

}  // namespace hybridtest
