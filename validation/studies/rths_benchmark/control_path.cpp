#include "validation/studies/rths_benchmark/control_path.hpp"

#include "validation/studies/rths_benchmark/constants.hpp"
#include "validation/studies/rths_benchmark/converter.hpp"

namespace hybridtest::rths {
namespace {

constexpr double kProportionalGain = 2.0;
constexpr double kIntegralGainPerS = 95.0;

// Lead (b1 s + b0)/(s + b0), by Tustin n0 + n1 z^-1 over 1 + d1 z^-1.
constexpr double kB1 = 50.83163360273612;
constexpr double kB0 = 8570.397339444286;
constexpr double kW = 2.0 * kSampleRateHz;
constexpr double kN0 = (kB1 * kW + kB0) / (kW + kB0);
constexpr double kN1 = (kB0 - kB1 * kW) / (kW + kB0);
constexpr double kD1 = (kB0 - kW) / (kW + kB0);

}  // namespace

double ReleasedLoop::command(double input_m, double measured_displacement_m) noexcept {
  const double error_m = quantised(saturated(input_m - measured_displacement_m));
  integral_ += kIntegralGainPerS * 0.5 * kPeriodS * (error_m + error_m_);
  error_m_ = error_m;
  return saturated(quantised(kProportionalGain * error_m + integral_));
}

double ReleasedController::command(const ControlSample& sample) noexcept {
  const double input_m = quantised(saturated(sample.target_m));
  output_m_ = kN0 * input_m + kN1 * input_m_ - kD1 * output_m_;
  input_m_ = input_m;
  return loop_.command(saturated(quantised(output_m_)), sample.measured_displacement_m);
}

double CompensatedPath::command(const ControlSample& sample) noexcept {
  const double command_m =
      compensator_->command({sample.target_m, sample.target_velocity_m_per_s, sample.target_acceleration_m_per_s2,
                             quantised(saturated(sample.previous_displacement_m)), sample.previous_force_n});
  const double sent_m = saturated(quantised(command_m));
  return arrangement_ == Arrangement::straight ? sent_m : loop_.command(sent_m, sample.measured_displacement_m);
}

}  // namespace hybridtest::rths
