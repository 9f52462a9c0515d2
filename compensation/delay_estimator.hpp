#pragma once

#include "core/parameters/parameter_archive.hpp"

namespace hybridtest {

/// One control sample, one degree of freedom. Both of the same instant.
struct DelaySample {
  double reference_m = 0.0;              // [m] what the actuator was told, see DelayEstimator
  double measured_displacement_m = 0.0;  // [m]
};

/// Rules that estimators share.
inline constexpr ParameterRule kEstimatorMemory{
    {.low = 0.01, .high = 100.0}, "of the window", "it holds a cycle of the structure or more"};
inline constexpr ParameterRule kEstimatorMotion{{.low = 1e-9, .high = 1.0},
                                                "root mean square of the motion below which nothing is learnt",
                                                "a delay learnt from sensor noise is noise"};

/// Bounds of an estimate, and how fast it may move.
struct DelayLimits {
  double initial_delay_s = 0.020;
  double delay_s_min = 0.0;
  double delay_s_max = 0.100;
  double rate_s_per_s_max = 0.02;

  void serialize(ParameterArchive& archive) {
    constexpr const char* kMachine = "no transfer system of a hybrid test is later than a second";
    archive.required(
        "initial_delay_s", initial_delay_s,
        {kZeroToOne, "of the transfer system, until it is measured", kMachine, "`delay_s_min` to `delay_s_max`"});
    archive.optional("delay_s_min", delay_s_min,
                     {kZeroToOne, "bound of the estimate", "nothing answers before it is told"});
    archive.optional("delay_s_max", delay_s_max,
                     {{.low = 0.0, .high = 1.0, .low_open = true},
                      "bound of the estimate",
                      kMachine,
                      "more than `delay_s_min`, at most 1"});
    archive.optional("rate_s_per_s_max", rate_s_per_s_max,
                     {{.low = 0.0, .high = 1000.0, .low_open = true},
                      "change of the estimate",
                      "the estimate has to move, and without a limit it would jump"});
  }
};

/// Tells how late a transfer system is, from what it was told and what it did, sample by sample.
///
/// The delay is that of the measured displacement behind the reference. With the command that was sent
/// as reference it is the transfer system's own, whatever compensates for it (EstimatedDelayCompensation
/// does that); with the target as reference it is what is left of it.
///
/// To it is added the network latency, where one is measured: the sum is the delay of the whole loop.
/// The sum is bounded, moves no faster than its rate, and stays where it is while the motion is too
/// small to tell. Sub-sample resolution; no allocation per sample.
class DelayEstimator {
 public:
  virtual ~DelayEstimator() = default;

  /// Takes one sample; samples with a non-finite value tell nothing.
  /// @return the delay [s] of the whole loop, as delay_s().
  double estimate(const DelaySample& sample) noexcept;

  /// What the network adds to the loop, there and back, as newest measured. Zero at first.
  /// @param latency_s   [s] negative or non-finite values are ignored.
  void set_network_latency(double latency_s) noexcept;

  /// The delay [s] of the whole loop.
  [[nodiscard]] double delay_s() const noexcept { return delay_s_; }
  [[nodiscard]] const DelayLimits& limits() const noexcept { return limits_; }
  /// Back to what it was when new; the network latency is forgotten too.
  void reset() noexcept;

 protected:
  /// @throws ConfigError for limits or a period outside their ranges.
  DelayEstimator(const DelayLimits& limits, double control_period_s);

  /// What the estimator believes of the transfer system, network not included.
  void believe(double delay_s) noexcept { believed_s_ = delay_s; }
  [[nodiscard]] double believed_s() const noexcept { return believed_s_; }
  [[nodiscard]] double control_period_s() const noexcept { return control_period_s_; }

 private:
  /// One finite sample. Calls believe() when it tells something.
  virtual void observe(const DelaySample& sample) noexcept = 0;
  virtual void forget() noexcept = 0;

  DelayLimits limits_;
  double control_period_s_;
  double believed_s_;
  double network_latency_s_ = 0.0;
  double delay_s_;
};

}  // namespace hybridtest
