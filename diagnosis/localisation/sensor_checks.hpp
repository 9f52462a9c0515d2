#pragma once

#include <optional>
#include <span>
#include <vector>

#include "diagnosis/recording.hpp"
#include "diagnosis/result/diagnosis_report.hpp"

namespace hybridtest {

/// Sensor checks of one channel.
struct ChannelCheck {
  double quantum = 0.0;         // smallest step between neighbours; 0 for a channel that never changes
  double repeated_share = 0.0;  // of samples that equal the one before
  double clipped_share = 0.0;   // of samples at the extreme values, three or more in a row
};
[[nodiscard]] ChannelCheck check_channel(std::span<const double> values);

/// Readings of a channel while the motion is at rest.
struct RestReading {
  double first = 0.0;        // mean over the first stretch at rest: the tare
  double last = 0.0;         // mean over the last one
  double drift_per_s = 0.0;  // between the two; 0 where there is one stretch
  double rms = 0.0;          // of the noise within the stretches
};
/// @param motion_m   stretches of at least 0.2 s within a thousandth of its span count as rest.
/// @return nothing without any.
[[nodiscard]] std::optional<RestReading> read_at_rest(std::span<const double> values, std::span<const double> motion_m,
                                                      double period_s);

/// Lag of the force behind the displacement: the lag with the largest correlation magnitude of their changes (dF
/// against dx), refined by a parabola through three lags. A specimen with damping or mass also leads or lags: only
/// with a stiff specimen is this the time offset of the sensors.
/// @return [s]; nothing when the best correlation is under 0.5 or lies at the end of the search of ± 50 ms.
[[nodiscard]] std::optional<double> force_lag_s(std::span<const double> displacement_m, std::span<const double> force_n,
                                                double period_s);

/// Sensor checks of the measured channels of one degree of freedom; rest and lag only where there is time.
void add_sensor_facts(const Recording& recording, std::size_t dof, report::DiagnosisReport& report);

}  // namespace hybridtest
