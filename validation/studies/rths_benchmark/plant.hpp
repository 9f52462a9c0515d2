#pragma once

#include <array>
#include <cstdint>

#include "compensation/transfer_system_model.hpp"

namespace hybridtest::rths {

/// The parameters of plant `index`: nominal for 0; otherwise k, beta1, beta2 and a3 with normally distributed
/// deviations of the benchmark. They depend only on index and seed.
[[nodiscard]] TransferSystemModel plant_parameters(int index, std::uint64_t seed);

/// The servo-hydraulic actuator of the benchmark with its specimen, initially at rest:
///
///     z'' + beta1 z' + beta2 z = a1beta0 (gain u - x),   F' + a3 F = z - a2 x',   m x'' + c x' + k x = F
class Plant {
 public:
  explicit Plant(const TransferSystemModel& parameters) noexcept : parameters_{parameters} {}

  /// Advances by one sample period, with the command held.
  void step(double command_m) noexcept;

  [[nodiscard]] double displacement_m() const noexcept { return state_[TransferSystemModel::kDisplacement]; }
  [[nodiscard]] double force_n() const noexcept { return state_[TransferSystemModel::kForce]; }

 private:
  TransferSystemModel parameters_;
  std::array<double, TransferSystemModel::kStates> state_{};
};

}  // namespace hybridtest::rths
