#include "diagnosis/recording.hpp"

#include <algorithm>

namespace hybridtest {

std::string_view column_name(Channel channel) noexcept {
  switch (channel) {
    case Channel::sent_displacement: return "sent_displacement_m";
    case Channel::target_displacement: return "target_displacement_m";
    case Channel::command_displacement: return "command_displacement_m";
    case Channel::measured_displacement: return "measured_displacement_m";
    case Channel::measured_acceleration: return "measured_acceleration_m_per_s2";
    case Channel::measured_force: return "measured_force_n";
  }
  return "";
}

bool Recording::has_input(std::string_view name) const noexcept {
  return std::ranges::find(inputs, name, &RecordedChannel::name) != inputs.end();
}

}  // namespace hybridtest
