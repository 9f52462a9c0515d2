#pragma once

#include <cstddef>
#include <filesystem>

namespace hybridtest {

/// A recorded test that takes as long as wanted: the coordinator's file and that of a site with 32 signals in every
/// control period. Written by the recorder as a site writes, in drains of 50 ms of the test, but as fast as the disk
/// is.
struct LongRun {
  static constexpr int kDofs = 8;
  static constexpr int kSignals = 4 * kDofs;  // target, command, measured displacement and force
  /// Of a control row: beside the signals sample, time and model time.
  static constexpr int kControlColumns = kSignals + 3;
  static constexpr double kDelay_s = 0.0125;  // of the measured displacement

  double control_rate_hz = 4096.0;
  double step_rate_hz = 1024.0;
  double duration_s = 10.0;

  [[nodiscard]] std::size_t control_rows() const { return static_cast<std::size_t>(duration_s * control_rate_hz); }
  [[nodiscard]] std::size_t step_rows() const { return static_cast<std::size_t>(duration_s * step_rate_hz); }
  /// Into an existing directory.
  void write(const std::filesystem::path& directory) const;
};

}  // namespace hybridtest
