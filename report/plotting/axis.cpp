#include "report/plotting/axis.hpp"

#include <fmt/format.h>

#include <cmath>

namespace hybridtest::plot {
namespace {

constexpr int kTicksAbout = 8;

/// 1, 2 or 5 times a power of ten, about a `parts`-th of the span.
double round_step(double span, int parts) {
  const double rough = span / parts;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= rough * 0.999) return factor * power;
  }
  return 10.0 * power;
}

std::vector<Tick> linear_ticks(double low, double high) {
  const double step = round_step(high - low, kTicksAbout);
  std::vector<Tick> ticks;
  for (double index = std::ceil(low / step - 1e-9); index * step <= high + 1e-9 * step; ++index) {
    const double value = index == 0.0 ? 0.0 : index * step;  // never -0
    ticks.push_back({value, fmt::format("{:.6g}", value)});
  }
  return ticks;
}

/// Decades; if they are few, also their double and five-fold values.
std::vector<Tick> logarithmic_ticks(double low, double high) {
  std::vector<Tick> ticks;
  const bool has_few = high - low < 2.5;
  for (double decade = std::floor(low); decade <= high; ++decade) {
    for (const double factor : {1.0, 2.0, 5.0}) {
      const double value = factor * std::pow(10.0, decade);
      const double place = std::log10(value);
      if ((factor > 1.0 && !has_few) || place < low - 1e-9 || place > high + 1e-9) continue;
      ticks.push_back({value, fmt::format("{:g}", value)});
    }
  }
  return ticks;
}

}  // namespace

Scale::Scale(const Axis& axis, double least, double most) : is_logarithmic_{axis.is_logarithmic} {
  const double low = axis.low.value_or(least);
  const double high = axis.high.value_or(most);
  low_ = is_logarithmic_ ? std::log10(low) : low;
  high_ = is_logarithmic_ ? std::log10(high) : high;
  if (!std::isfinite(low_) || !std::isfinite(high_)) {
    low_ = 0.0;
    high_ = 1.0;
  }
  if (high_ <= low_) high_ = low_ + 1.0;
  const double margin = 0.04 * (high_ - low_);
  if (!axis.low) low_ -= margin;
  if (!axis.high) high_ += margin;
}

double Scale::share(double value) const noexcept {
  return ((is_logarithmic_ ? std::log10(value) : value) - low_) / (high_ - low_);
}

std::vector<Tick> Scale::ticks() const {
  return is_logarithmic_ ? logarithmic_ticks(low_, high_) : linear_ticks(low_, high_);
}

}  // namespace hybridtest::plot
