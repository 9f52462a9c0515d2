#include "compensation/low_pass.hpp"

#include <cmath>
#include <numbers>

#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {

LowPass::LowPass(double corner_hz, double sample_period_s) {
  checked_control_period(sample_period_s);
  expect_in_range("filter_hz", corner_hz, {.low = 0.001 / sample_period_s, .high = 0.45 / sample_period_s},
                  "the filter runs at the control rate");
  const double w = std::tan(std::numbers::pi * corner_hz * sample_period_s);
  for (std::size_t i = 0; i < sections_.size(); ++i) {
    const double damping = 2.0 * std::sin(std::numbers::pi * (2.0 * static_cast<double>(i) + 1.0) / 8.0);
    const double scale = 1.0 / (1.0 + damping * w + w * w);
    sections_[i] = {w * w * scale, 2.0 * (w * w - 1.0) * scale, (1.0 - damping * w + w * w) * scale, 0.0, 0.0};
  }
}

double LowPass::filter(double value) noexcept {
  for (Section& section : sections_) {
    const double out = section.b * value + section.first;
    section.first = 2.0 * section.b * value - section.a1 * out + section.second;
    section.second = section.b * value - section.a2 * out;
    value = out;
  }
  return value;
}

void LowPass::reset() noexcept {
  for (Section& section : sections_) section.first = section.second = 0.0;
}

}  // namespace hybridtest
