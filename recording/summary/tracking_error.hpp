#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/signal/frequency_evaluation.hpp"
#include "recording/summary/ranked_values.hpp"

namespace hybridtest {

/// The tracking error of an actuator over a whole test, without the return to zero after it.
struct TrackingError {
  std::string dof;
  double rms_m = 0.0;                        // of measured − target
  double peak_m = 0.0;                       // largest magnitude of measured − target
  std::optional<double> rms_relative;        // [-] of the target's root mean square; none at rest
  std::optional<double> amplitude;           // [-] frequency evaluation index
  std::optional<double> equivalent_delay_s;  // [s] positive when the actuator is behind
  std::optional<double> equivalent_frequency_hz;
  std::size_t samples = 0;  // pairs compared; those that are not finite are left out
};

/// The usual interval of time stamps: the median. Handed over in passes, as RankedValues.
class UsualInterval {
 public:
  UsualInterval();

  void add(double time_s);
  bool end_pass();
  /// After the last pass; nothing with fewer than two time stamps, or one that is not finite.
  [[nodiscard]] std::optional<double> result() const;

 private:
  RankedValues intervals_;
  std::optional<double> last_s_;
  bool is_finite_ = true;
};

/// Follows the longest stretch of finite samples with even spacing, whose delay it evaluates. A stretch of more samples
/// than kBlock is evaluated in blocks, so that memory does not grow with it.
class StretchEvaluation {
 public:
  /// Samples in one transform: 31 s at 4 kHz as a whole.
  static constexpr std::size_t kBlock = 131'072;

  explicit StretchEvaluation(double period_s) : period_s_{period_s} {}

  void add(double time_s, double target_m, double measured_m);
  [[nodiscard]] std::optional<FrequencyEvaluation> result();

 private:
  struct Stretch {
    std::size_t count = 0;
    std::vector<double> target_m{};  // of the block that is not in the sum yet
    std::vector<double> measured_m{};
    std::optional<FrequencyEvaluationSum> sum{};  // of the blocks before
  };

  void end_stretch();
  void end_block();

  double period_s_;
  double last_time_s_ = 0.0;
  Stretch current_;
  Stretch best_;
};

/// Evaluates the tracking of one degree of freedom without keeping its signals: the samples are handed over in two
/// passes, of which the second needs their usual interval.
class TrackingSearch {
 public:
  explicit TrackingSearch(std::string dof) { error_.dof = std::move(dof); }

  void add_error(double target_m, double measured_m);
  /// After the first pass. @param period_s   as UsualInterval found it; nothing: there is no second pass.
  void begin_delay(std::optional<double> period_s);
  void add_delay(double time_s, double target_m, double measured_m);
  /// Nothing without a pair of finite values.
  [[nodiscard]] std::optional<TrackingError> result();

 private:
  TrackingError error_;
  double error_squares_ = 0.0;
  double target_squares_ = 0.0;
  std::optional<StretchEvaluation> stretch_;
};

/// @param time_s, target_m, measured_m   of equal size, in the order recorded. The delay comes from
///        the longest stretch with even spacing (see evaluate_tracking_frequency()), the errors from
///        all pairs of finite values.
/// @return nothing without any such pair.
[[nodiscard]] std::optional<TrackingError> evaluate_tracking(std::string dof, std::span<const double> time_s,
                                                             std::span<const double> target_m,
                                                             std::span<const double> measured_m);

}  // namespace hybridtest
