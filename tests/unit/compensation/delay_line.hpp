#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace hybridtest {

/// An actuator that does what it was told, late: the commands joined by straight lines.
class DelayLine {
 public:
  DelayLine(double delay_s, double period_s)
      : age_{delay_s / period_s}, samples_(static_cast<std::size_t>(age_) + 3, 0.0) {}

  /// @return the displacement at the instant of the command.
  double advance(double command_m) {
    newest_ = (newest_ + 1) % samples_.size();
    samples_[newest_] = command_m;
    const auto whole = static_cast<std::size_t>(age_);
    const double part = age_ - static_cast<double>(whole);
    return (1.0 - part) * at(whole) + part * at(whole + 1);
  }

 private:
  [[nodiscard]] double at(std::size_t age) const {
    return samples_[(newest_ + samples_.size() - age) % samples_.size()];
  }

  double age_;
  std::vector<double> samples_;
  std::size_t newest_ = 0;
};

}  // namespace hybridtest
