#pragma once

#include <array>
#include <cstddef>

#include "compensation/delay_estimator.hpp"
#include "compensation/sample_history.hpp"
#include "core/parameters/parameter_archive.hpp"

namespace hybridtest {

/// Delay from zero crossings, where the motion is fastest and time is told best (after Darby, Williams
/// and Blakeborough, J. Eng. Mech. 128, 2002; Ahmadizadeh, Mosqueda and Reinhorn, Earthquake Engng
/// Struct. Dyn. 37, 2008).
///
/// Reference r and measurement m are averaged over the same short window. Each time the average of one
/// passes zero, the instant follows from the straight line through the two samples about it. Of the
/// crossings of r in the same direction, within the bounds of the delay and a quarter of their range
/// beyond, the one counts that makes the delay nearest to the present one:
///
///     delay <- delay + weight (t_m - t_r - delay)
///
/// A crossing counts where it is faster than slope_min and the signal has been further than motion_min
/// from zero since the crossing before it, which one made by noise has not.
///
/// Exact for a pure delay up to the curvature of the motion between two samples. An offset between the
/// sensors moves crossings up and down oppositely, and averages out.
///
/// Interpretation: Darby corrects by the synchronisation error at every sample, weighted with velocity;
/// Ahmadizadeh et al. divide it by the slope. Both are most certain at the crossings; that only those
/// count here, and as times, makes large delays no less exact than small ones.
class ZeroCrossingSlope final : public DelayEstimator {
 public:
  struct Parameters {
    DelayLimits limits;
    double average_s = 0.004;
    double slope_m_per_s_min = 0.005;
    double motion_m_min = 1e-4;
    double crossing_weight = 0.3;

    void serialize(ParameterArchive& archive) {
      archive.optional("average_s", average_s,
                       {kZeroToOne, "window of the averages, rounded to control periods",
                        "a longer average has no fast motion left"});
      archive.optional("slope_m_per_s_min", slope_m_per_s_min,
                       {{.low = 0.0, .high = 100.0, .low_open = true},
                        "slower crossings do not count",
                        "a crossing without slope tells no time"});
      archive.optional(
          "motion_m_min", motion_m_min,
          {kEstimatorMotion.range, "smaller swings between crossings do not count", kEstimatorMotion.reason});
      archive.optional("crossing_weight", crossing_weight,
                       {{.low = 0.0, .high = 1.0, .low_open = true},
                        "of a new crossing",
                        "a crossing counts for something and for no more than itself"});
      limits.serialize(archive);
    }
  };

  /// @throws ConfigError for values outside their ranges.
  ZeroCrossingSlope(const Parameters& parameters, double control_period_s);

 private:
  // Moving average of a signal, and where it last passed zero.
  struct Channel {
    explicit Channel(std::size_t window) : samples(window) {}
    /// @return whether the average has passed zero since the sample before, in a way that counts.
    bool advance(double value, double period_s, double swing_m_min) noexcept;
    void reset() noexcept;

    SampleHistory samples;
    double average_m = 0.0;
    double swing_m = 0.0;  // furthest from zero since the last crossing
    double slope_m_per_s = 0.0;
    double fraction = 0.0;  // of a period, from the crossing to the newest sample
    bool has_average = false;
  };
  struct Crossing {
    double age_periods = 0.0;
    bool is_rising = false;
  };

  void observe(const DelaySample& sample) noexcept override;
  void forget() noexcept override;
  void remember_reference_crossing() noexcept;
  void compare_measured_crossing() noexcept;

  static constexpr std::size_t kCrossings = 16;

  double slope_m_per_s_min_;
  double motion_m_min_;
  double crossing_weight_;
  Channel reference_;
  Channel measured_;
  std::array<Crossing, kCrossings> crossings_{};  // of the reference, a ring
  std::size_t next_ = 0;
  std::size_t known_ = 0;
};

}  // namespace hybridtest
