#pragma once

#include <array>
#include <cstddef>

namespace hybridtest::rths {

/// One step of the classical fourth-order Runge-Kutta method.
///
/// @param derivative   called as derivative(share, state, rate): fills the rate of `state` at that share
///                     of the step, 0, 1/2 or 1.
template <std::size_t Size, class Derivative>
void runge_kutta_step(std::array<double, Size>& state, double step_s, const Derivative& derivative) noexcept {
  using State = std::array<double, Size>;
  State k1, k2, k3, k4;
  const auto moved = [&](double by_s, const State& rate) {
    State place;
    for (std::size_t i = 0; i < Size; ++i) place[i] = state[i] + by_s * rate[i];
    return place;
  };
  derivative(0.0, state, k1);
  derivative(0.5, moved(0.5 * step_s, k1), k2);
  derivative(0.5, moved(0.5 * step_s, k2), k3);
  derivative(1.0, moved(step_s, k3), k4);
  for (std::size_t i = 0; i < Size; ++i) state[i] += step_s / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
}

}  // namespace hybridtest::rths
