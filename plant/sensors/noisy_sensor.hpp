#pragma once

#include "core/random.hpp"

namespace hybridtest {

/// A transducer that adds Gaussian noise, one sample per reading: white, and coloured beside it.
class NoisySensor {
 public:
  /// Autoregressive noise of first order: between readings that are k apart its correlation is correlation^k. It is
  /// stationary from the first reading on.
  struct Coloured {
    double noise = 0.0;        // standard deviation; 0: none
    double correlation = 0.0;  // of a reading with the next one
    Random random{0};          // a stream of its own, beside that of the white part
  };

  /// @param noise    standard deviation in the unit of what is measured; not negative.
  /// @param random   a stream of its own for each channel; readings repeat with its seed.
  /// @throws ConfigError for values outside this range.
  NoisySensor(double noise, Random random);
  /// @param coloured   its noise not negative, its correlation from 0 to below 1.
  /// @throws ConfigError for values outside these ranges.
  NoisySensor(double noise, Random random, const Coloured& coloured);

  /// @return `value` with noise. Draws even when the white noise is zero, so that a channel's noise
  ///         changes in size alone with its level. Without coloured noise the reading is the white one to the last bit.
  [[nodiscard]] double read(double value) noexcept {
    const double white = value + noise_ * random_.normal();
    return coloured_.noise > 0.0 ? white + coloured_.noise * next_coloured() : white;
  }
  /// Begins the noise anew.
  void reset() noexcept;

 private:
  /// Of unit variance.
  [[nodiscard]] double next_coloured() noexcept {
    const double now = state_;
    state_ = coloured_.correlation * state_ + innovation_ * coloured_.random.normal();
    return now;
  }

  double noise_;
  Random initial_random_;
  Random random_;
  Coloured coloured_;
  Random initial_coloured_random_;
  double innovation_ = 0.0;  // standard deviation of what is new in each reading
  double state_ = 0.0;       // of the next reading
};

}  // namespace hybridtest
