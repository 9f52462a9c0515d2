#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "compensation/compensator.hpp"
#include "compensation/low_pass.hpp"
#include "compensation/polynomial_extrapolation.hpp"
#include "compensation/sample_history.hpp"
#include "core/parameters/parameter_archive.hpp"

namespace hybridtest {

/// Two-stage adaptive compensation (Wang, Ning, Xu, Zhou and Wu, Mech. Syst. Signal Process. 133, 2019;
/// tested by Wang, Yan, Ning and Wu, Shock and Vibration, 2020): a polynomial extrapolation makes up for
/// the larger, known part of the delay, an adaptive discrete model of the transfer system for the rest.
///
///     coarse   p(k) = extrapolation of third order of the target by the coarse delay d
///     fine     command(k) = theta' (p(k), p(k-m), p(k-2m))
///
///     theta by recursive least squares with forgetting of u(k-d) = theta' (x_m(k), x_m(k-m), x_m(k-2m)),
///
/// u the commands sent, x_m the measurement. With theta = (1, 0, 0), at first, the polynomial alone; the
/// identity if d is zero besides.
///
/// Interpretation: the papers' text was not at hand, only their abstracts, which name the two stages.
/// Number and spacing m of the terms (neighbouring samples at a kilohertz tell nothing apart above the
/// sensor noise), the low-pass on both signals of the fit and the adaptation's settings are ours.
class TwoStageAdaptive final : public Compensator {
 public:
  struct Parameters {
    double coarse_delay_s = 0.020;  // d
    double term_spacing_s = 0.010;  // m
    double memory_s = 5.0;
    double filter_hz = 20.0;
    double equation_error_m = 3e-6;
    double theta_deviation = 0.3;
    double theta_max = 3.0;

    void serialize(ParameterArchive& archive) {
      constexpr const char* kSpan = "the motion is a polynomial for no longer";
      archive.required("coarse_delay_s", coarse_delay_s,
                       {kZeroToOne, "of the polynomial of the first stage; 0: no first stage", kSpan});
      archive.optional("term_spacing_s", term_spacing_s,
                       {{.low = 0.0, .high = 1.0, .low_open = true},
                        "of the three terms of the discrete model",
                        kSpan,
                        "1 control period to 1"});
      archive.optional("memory_s", memory_s,
                       {{.low = 0.1, .high = 1000.0}, "of the least squares", "it holds some cycles of the structure"});
      archive.optional("filter_hz", filter_hz, kFilterHz);
      archive.optional("equation_error_m", equation_error_m,
                       {{.low = 1e-12, .high = 1.0},
                        "of the filtered signals, standard deviation",
                        "the least squares divide by its square"});
      archive.optional("theta_deviation", theta_deviation,
                       {{.low = 0.0, .high = 10.0, .low_open = true},
                        "of each coefficient at first, from (1, 0, 0)",
                        "without doubt of the first coefficients nothing is learnt"});
      archive.optional("theta_max", theta_max,
                       {{.low = 1.0, .high = 100.0}, "bound of each coefficient", "the first coefficient starts at 1"});
    }
  };

  /// @throws ConfigError for values outside their ranges.
  TwoStageAdaptive(const Parameters& parameters, double control_period_s);

  [[nodiscard]] double command(const CompensatorInput& input) noexcept override;
  void reset() noexcept override;

  [[nodiscard]] const Eigen::Vector3d& theta() const noexcept { return theta_; }

 private:
  void learn(double measured_displacement_m) noexcept;

  Parameters parameters_;
  std::size_t delay_;  // control periods
  std::size_t spacing_;
  double keep_;
  double error_variance_m2_;
  PolynomialExtrapolation extrapolation_;
  LowPass measured_filter_;
  LowPass command_filter_;
  SampleHistory extrapolated_m_;
  SampleHistory measured_m_;  // filtered, as the next
  SampleHistory sent_m_;
  Eigen::Vector3d theta_;
  Eigen::Matrix3d covariance_;
  double held_measurement_m_ = 0.0;
  double last_sent_m_ = 0.0;
};

}  // namespace hybridtest
