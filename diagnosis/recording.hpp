#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hybridtest {

/// A signal of one degree of freedom of a site, in the order of the signal flow.
enum class Channel : std::uint8_t {
  sent_displacement,      // [m] by the coordinator
  target_displacement,    // [m] at the site, after the network
  command_displacement,   // [m] to the actuator, after the compensator
  measured_displacement,  // [m]
  measured_acceleration,  // [m/s2]
  measured_force,         // [N] positive when it resists a positive displacement
};
inline constexpr std::size_t kChannels = static_cast<std::size_t>(Channel::measured_force) + 1;

/// Name of the column: `measured_force_n`.
[[nodiscard]] std::string_view column_name(Channel channel) noexcept;

/// The channels that were recorded of one degree of freedom; those that were not are empty.
struct DofRecording {
  std::array<std::vector<double>, kChannels> samples;

  [[nodiscard]] const std::vector<double>& of(Channel channel) const noexcept {
    return samples[static_cast<std::size_t>(channel)];
  }
  [[nodiscard]] std::vector<double>& of(Channel channel) noexcept { return samples[static_cast<std::size_t>(channel)]; }
  [[nodiscard]] bool has(Channel channel) const noexcept { return !of(channel).empty(); }
};

/// What was recorded beside the motion of a site: the current of a damper, a temperature. It belongs to all of its
/// degrees of freedom, in any unit.
struct RecordedChannel {
  std::string name;  // `current_a`; its column is `input_current_a`
  std::vector<double> samples;
};
inline constexpr std::string_view kInputPrefix = "input_";

/// The stamps that number the rows of a file, time or steps.
struct RowStamps {
  std::string column;  // `time_s` or `step`
  double first = 0.0;
  double last = 0.0;
  double largest_interval = 0.0;
};

enum class RecordingRole : std::uint8_t { fit, held_out };

/// A recording that has passed the intake's checks: finite, and evenly sampled without gaps or without any time.
///
/// A quasi-static recording has no time: the points of a slow test in their order. Path takes the place of time.
/// `sample_period_s` is then nominal: as if the test passed one cycle over its whole range per second, at a constant
/// rate of points. Nothing depends on a time base that someone invented for such a test.
struct Recording {
  std::string file;    // as the user named it
  std::string sha256;  // of the file, hexadecimal
  RecordingRole role = RecordingRole::fit;
  bool is_quasi_static = false;
  double sample_period_s = 0.0;
  std::size_t samples = 0;
  std::optional<RowStamps> stamps{};  // none where rows have neither time nor step
  std::size_t first_row = 1;          // row number of the first sample in findings: its line in a CSV file
  std::vector<DofRecording> dofs;
  std::vector<RecordedChannel> inputs{};  // in the order of their names

  [[nodiscard]] bool has_input(std::string_view name) const noexcept;
};

}  // namespace hybridtest
