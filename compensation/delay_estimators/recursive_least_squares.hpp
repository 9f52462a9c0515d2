#pragma once

#include <cstddef>

#include "compensation/delay_estimator.hpp"
#include "compensation/sample_history.hpp"
#include "core/parameters/parameter_archive.hpp"

namespace hybridtest {

/// Delay and gain by recursive least squares (the model of Wang, Wu, Bursi, Xu and Ding, Smart Struct.
/// Syst. 14, 2014: a pure delay times a gain, expanded in a Taylor series).
///
///     m(t) = g r(t - delay) = g r(t - d) - g (delay - d) r'(t - d) + …
///
/// d is the present estimate, so that what is expanded is the error of it and the series ends after its
/// first term. g and g (delay - d) follow from the least squares with forgetting of m on r(t - d) and
/// r'(t - d); from them the next d. When d moves by e, the sums move with it, r <- r - e r'.
///
/// r between two samples by the straight line, r' by a difference over two samples. Exact for a pure delay
/// up to the curvature of r between samples, with any gain; noise of the measurement leaves the estimate
/// unbiased. Frozen while the mean square of r is below that of motion_m_min, or g below a fifth: what
/// does not follow has no delay.
class RecursiveLeastSquares final : public DelayEstimator {
 public:
  struct Parameters {
    DelayLimits limits;
    double memory_s = 1.0;
    double motion_m_min = 1e-4;

    void serialize(ParameterArchive& archive) {
      archive.optional("memory_s", memory_s, kEstimatorMemory);
      archive.optional("motion_m_min", motion_m_min, kEstimatorMotion);
      limits.serialize(archive);
    }
  };

  /// @throws ConfigError for values outside their ranges.
  RecursiveLeastSquares(const Parameters& parameters, double control_period_s);

  /// g of the last sample that told something; 1 before.
  [[nodiscard]] double gain() const noexcept { return gain_; }

 private:
  void observe(const DelaySample& sample) noexcept override;
  void forget() noexcept override;
  void accumulate(const DelaySample& sample) noexcept;
  void move_expansion(double by_s) noexcept;

  Parameters parameters_;
  double keep_;
  SampleHistory references_m_;
  double expansion_s_;  // d
  double gain_ = 1.0;
  // Means with forgetting of products of r, v = r' and m.
  double rr_ = 0.0, rv_ = 0.0, vv_ = 0.0, rm_ = 0.0, vm_ = 0.0;
};

}  // namespace hybridtest
