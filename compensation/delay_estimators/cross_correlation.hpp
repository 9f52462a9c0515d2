#pragma once

#include <cstddef>
#include <vector>

#include "compensation/delay_estimator.hpp"
#include "compensation/sample_history.hpp"
#include "core/parameters/parameter_archive.hpp"

namespace hybridtest {

/// Delay at which reference and measurement are most alike.
///
///     C(l) = sum of w r(t - l T) m(t),   E(l) = sum of w r(t - l T)^2,   l from the lower to the upper bound
///     likeness(l) = C(l)^2 / E(l), largest at the delay
///
/// over a window w that fades with a memory instead of ending, w = exp(-age / memory): the sums then
/// follow by recursion, without subtraction whose rounding would add up. By the inequality of Cauchy and
/// Schwarz the likeness is largest at the delay for a pure delay with any gain. Where between two lags,
/// follows from the parabola through the largest and those a few milliseconds on either side, whose width
/// h keeps noise small; the fading of the window across it makes the estimate late by some h^2 / (4 memory),
/// 4 microseconds as it is set here. Lags are compared anew every few milliseconds.
///
/// Frozen while the mean square of r in the window is below that of motion_m_min.
class CrossCorrelation final : public DelayEstimator {
 public:
  struct Parameters {
    DelayLimits limits;
    double memory_s = 1.0;
    double parabola_half_s = 0.004;
    double comparison_period_s = 0.005;
    double motion_m_min = 1e-4;

    void serialize(ParameterArchive& archive) {
      archive.optional("memory_s", memory_s, kEstimatorMemory);
      archive.optional("parabola_half_s", parabola_half_s,
                       {{.low = 0.0, .high = 0.1, .low_open = true},
                        "from the middle of the parabola to its ends, rounded to control periods",
                        "the correlation is a parabola no further from its peak",
                        "1 control period to 0.1"});
      archive.optional("comparison_period_s", comparison_period_s,
                       {{.low = 0.0, .high = 1.0, .low_open = true},
                        "from one comparison of the lags to the next, rounded to control periods",
                        "the delay changes within it",
                        "1 control period to 1"});
      archive.optional("motion_m_min", motion_m_min, kEstimatorMotion);
      limits.serialize(archive);
    }
  };

  /// @throws ConfigError for values outside their ranges.
  CrossCorrelation(const Parameters& parameters, double control_period_s);

 private:
  void observe(const DelaySample& sample) noexcept override;
  void forget() noexcept override;
  void accumulate(double reference_m, double measured_m) noexcept;
  void compare() noexcept;
  [[nodiscard]] double likeness(std::size_t index) const noexcept;

  Parameters parameters_;
  double keep_;
  std::size_t half_;        // samples from the middle of the parabola to its ends
  std::size_t comparison_;  // samples between comparisons
  // Lag index i stands for a delay of i - half_ samples: the measurement is held back by half_, so that the
  // parabola has both its ends for a delay of zero as well.
  std::size_t lags_;
  SampleHistory measured_m_;
  std::vector<double> references_m_;  // a ring written twice, so that the last lags_ samples stand in one row
  std::size_t newest_ = 0;
  std::vector<double> correlations_m2_;  // C by lag index
  std::vector<double> energies_m2_;      // E by lag index
  std::size_t since_comparison_ = 0;
};

}  // namespace hybridtest
