#pragma once

#include "core/random.hpp"

namespace hybridtest {

/// A transducer that adds white Gaussian noise, one sample per reading.
class NoisySensor {
 public:
  /// @param noise    standard deviation in the unit of what is measured; not negative.
  /// @param random   a stream of its own for each channel; readings repeat with its seed.
  /// @throws ConfigError for values outside this range.
  NoisySensor(double noise, Random random);

  /// @return `value` with noise. Draws even when the noise is zero, so that a channel's noise
  ///         changes in size alone with its level.
  [[nodiscard]] double read(double value) noexcept { return value + noise_ * random_.normal(); }
  /// Begins the noise anew.
  void reset() noexcept { random_ = initial_random_; }

 private:
  double noise_;
  Random initial_random_;
  Random random_;
};

}  // namespace hybridtest
