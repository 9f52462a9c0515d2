#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "plant/transfer_systems/transfer_system.hpp"
#include "scenario/catalogue/part.hpp"
#include "scenario/catalogue/rig_rating.hpp"

namespace hybridtest {

struct TransferSystemReading {
  std::function<std::unique_ptr<TransferSystem>(double period_s, double delay_change_s)> make;
  double delay_s = 0.0;                     // at low frequency
  double pure_delay_s = 0.0;                // of it, without any lag
  bool has_bandwidth = false;               // linear, and as fast as a frequency of its own
  RigRating rating = {};                    // of the actuator
  double specimen_stiffness_n_per_m = 0.0;  // of a specimen that is part of it; 0: there is none
};

/// Every transfer system that a file can name.
[[nodiscard]] const std::vector<PartType<TransferSystemReading>>& transfer_systems();

[[nodiscard]] TransferSystemReading read_transfer_system(config::Section section);

}  // namespace hybridtest
