#include <cmath>
#include <cstdio>
#include <numbers>

#include "compensation/polynomial_displacement.hpp"

// A sine through the cubic of polynomial_displacement, whose points are one delay T apart. The polynomial misses the
// target of T later by the fourth backward difference of the sine:
//
//     command(t) = A sin(w (t + T)) - 16 sin(w T / 2)^4 A sin(w (t - T))
int main() {
  const double period_s = 1.0 / 1024.0;
  const double delay_s = 20.0 * period_s;
  const double amplitude_m = 0.05;
  const double frequency_rad_per_s = 2.0 * std::numbers::pi * 3.0;
  const auto target_m = [&](double time_s) { return amplitude_m * std::sin(frequency_rad_per_s * time_s); };
  const double missed = 16.0 * std::pow(std::sin(frequency_rad_per_s * delay_s / 2.0), 4);

  // Rounds without a cast, which the warnings of hybridtest's own code, as errors, would refuse.
  const int samples = 4.0 / period_s;
  const int first_full = 3.0 * delay_s / period_s;

  hybridtest::PolynomialDisplacement compensator{{.order = 3, .delay_s = delay_s}, period_s};
  double error_m = 0.0;
  double lead_m = 0.0;
  for (int sample = 0; sample < samples; ++sample) {
    const double time_s = sample * period_s;
    const double command_m = compensator.command({.target_m = target_m(time_s)});
    if (sample < first_full) continue;
    const double expected_m = target_m(time_s + delay_s) - missed * target_m(time_s - delay_s);
    error_m = std::fmax(error_m, std::fabs(command_m - expected_m));
    lead_m = std::fmax(lead_m, std::fabs(command_m - target_m(time_s)));
  }
  std::printf("largest error %.3g m, of commands up to %.3g m ahead of the target\n", error_m, lead_m);
  // The sum of four terms of at most 0.3 m; what rounding leaves of it.
  return error_m < 1e-14 && lead_m > 0.01 ? 0 : 1;
}
