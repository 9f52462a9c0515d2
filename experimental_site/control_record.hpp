#pragma once

#include <cstdint>
#include <vector>

#include "core/faults.hpp"
#include "core/interface_vector.hpp"
#include "core/records.hpp"

namespace hybridtest {

/// The recorded values of one control period.
struct ControlSample {
  std::int64_t sample = 0;
  double time_s = 0.0;        // since arming
  double model_time_s = 0.0;  // along the path
  const SiteVector& target_displacement_m;
  const SiteVector& command_displacement_m;
  const SiteVector& measured_displacement_m;
  const SiteVector& measured_force_n;
  const SiteVector& compensated_force_n;
  double energy_error_j = 0.0;
  double tracking_lag_sine = 0.0;  // see TrackingIndicator
  FaultFlags faults = FaultFlags::none;
  // What the interlocks judge besides, see InterlockUse.
  const SiteVector& target_velocity_m_per_s;
  double energy_error_ratio = 0.0;
  double command_age_s = 0.0;    // 0 while no command is expected
  bool follows_targets = false;  // else the tracking is not judged
};

/// The table `control` of a site: one row per control period. append() does not allocate.
class ControlRecord {
 public:
  ControlRecord(int dofs, RowSink& sink);

  void append(const ControlSample& sample) noexcept;

  [[nodiscard]] static TableLayout layout(int dofs);

 private:
  RowSink& sink_;
  std::vector<double> row_;
};

}  // namespace hybridtest
