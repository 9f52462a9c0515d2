#include "diagnosis/verdict/sensor_facts.hpp"

#include <array>

#include "diagnosis/localisation/sensor_checks.hpp"

namespace hybridtest {

void add_sensor_facts(const Recording& recording, std::size_t dof, report::DiagnosisReport& report) {
  struct Sensor {
    Channel channel;
    std::string_view unit;
  };
  constexpr std::array kSensors{Sensor{Channel::measured_displacement, "m"},
                                Sensor{Channel::measured_acceleration, "m/s2"}, Sensor{Channel::measured_force, "N"}};
  const DofRecording& channels = recording.dofs[dof];
  const std::vector<double>& motion_m = channels.has(Channel::command_displacement)
                                            ? channels.of(Channel::command_displacement)
                                            : channels.of(Channel::measured_displacement);
  for (const Sensor& sensor : kSensors) {
    if (!channels.has(sensor.channel)) continue;
    const std::vector<double>& values = channels.of(sensor.channel);
    const ChannelCheck check = check_channel(values);
    report::SensorFacts facts{.recording = recording.file,
                              .column = std::string{column_name(sensor.channel)},
                              .unit = std::string{sensor.unit},
                              .quantum = check.quantum,
                              .repeated_share = check.repeated_share,
                              .clipped_share = check.clipped_share};
    if (const auto rest = read_at_rest(values, motion_m, recording.sample_period_s)) {
      facts.at_rest = report::RestFacts{rest->first, rest->last, rest->drift_per_s, rest->rms};
    }
    if (sensor.channel == Channel::measured_force && channels.has(Channel::measured_displacement)) {
      facts.lag_s = force_lag_s(channels.of(Channel::measured_displacement), values, recording.sample_period_s);
    }
    report.sensors.push_back(std::move(facts));
  }
}

}  // namespace hybridtest
