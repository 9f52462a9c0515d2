#include "validation/studies/rths_benchmark/plant.hpp"

#include "core/random.hpp"
#include "validation/studies/rths_benchmark/constants.hpp"
#include "validation/studies/rths_benchmark/runge_kutta.hpp"

namespace hybridtest::rths {

TransferSystemModel plant_parameters(int index, std::uint64_t seed) {
  TransferSystemModel parameters;
  if (index == 0) return parameters;
  Random random{seed, static_cast<std::uint64_t>(index)};
  parameters.stiffness_n_per_m += 5e4 * random.normal();
  parameters.beta1_per_s += 3.3 * random.normal();
  parameters.beta2_per_s2 += 3.3e3 * random.normal();
  parameters.a3_per_s += 1.3 * random.normal();
  return parameters;
}

void Plant::step(double command_m) noexcept {
  const TransferSystemModel& p = parameters_;
  runge_kutta_step(state_, kPeriodS, [&](double, const auto& at, auto& rate) {
    const auto [z, z_rate, force_n, x_m, x_rate] = at;
    rate[0] = z_rate;
    rate[1] = p.a1beta0_n_per_m_s3 * (p.gain * command_m - x_m) - p.beta1_per_s * z_rate - p.beta2_per_s2 * z;
    rate[2] = z - p.a2_n_per_m * x_rate - p.a3_per_s * force_n;
    rate[3] = x_rate;
    rate[4] = (force_n - p.damping_n_s_per_m * x_rate - p.stiffness_n_per_m * x_m) / p.mass_kg;
  });
}

}  // namespace hybridtest::rths
