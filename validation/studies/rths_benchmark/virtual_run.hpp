#pragma once

#include <cstdint>
#include <vector>

#include "compensation/force_compensator.hpp"
#include "compensation/transfer_system_model.hpp"
#include "coordinator/excitation/ground_motion.hpp"
#include "validation/studies/rths_benchmark/control_path.hpp"
#include "validation/studies/rths_benchmark/criteria.hpp"
#include "validation/studies/rths_benchmark/reference.hpp"

namespace hybridtest::rths {

/// One run of the benchmark.
struct VirtualTest {
  int case_number = 1;
  const GroundMotion& motion;  // scaled
  const Reference& reference;
  TransferSystemModel plant;
  bool has_sensor_noise = true;
  std::uint64_t noise_seed = 0;
  std::uint64_t noise_stream = 0;
  /// Samples of 4096 Hz from one exchange to the next: 4 couples at 1024 Hz. Numerical part and plant still move in
  /// steps of 4096 Hz, with force and command held.
  int samples_per_exchange = 1;
};

/// What one run gave.
struct TestResult {
  Criteria criteria;
  double peak_force_n = 0.0;
  bool is_complete = false;            // false: ended past a multiple of the force limit
  double noise_floor_percent = 0.0;    // sensor noise over the deviation of this run's x_n1
  double true_tracking_percent = 0.0;  // J2 of the displacement without sensor noise
  double true_delay_s = 0.0;           // of the displacement without sensor noise

  [[nodiscard]] bool reaches_force_limit() const noexcept { return peak_force_n >= kForceLimitN; }
};

/// The signals of a run, for plots.
struct TestHistory {
  std::vector<double> target_m;
  std::vector<double> true_m;
  std::vector<double> measured_m;
  std::vector<double> floor_2_m;
  std::vector<double> floor_3_m;
};

/// Runs numerical part, control path and plant against each other. In each exchange, in this order: sensors
/// are read; the force of the exchange before, corrected by `force_compensator`, acts on the numerical part
/// over the whole period; the control path answers; plant and numerical part move on. Ends early when the
/// actuator's force is not finite or passes kHopelessShare of its limit.
///
/// The numerical part is the full frame less this plant's own specimen, so that the whole structure is the
/// reference's for every plant.
/// @param path, force_compensator   made for the period of an exchange.
/// @param history   may be nullptr.
[[nodiscard]] TestResult run_virtual_test(const VirtualTest& test, ControlPath& path,
                                          ForceCompensator& force_compensator, TestHistory* history = nullptr);

}  // namespace hybridtest::rths
