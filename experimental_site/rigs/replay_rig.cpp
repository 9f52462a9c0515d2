#include "experimental_site/rigs/replay_rig.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/config_error.hpp"

namespace hybridtest {
namespace {

RecordedMeasurement checked_record(RecordedMeasurement record) {
  const std::size_t rows = record.time_s.size();
  if (rows == 0 || record.displacement_m.size() != rows || record.force_n.size() != rows) {
    throw ConfigError{"a record of " + std::to_string(rows) + " times, " +
                      std::to_string(record.displacement_m.size()) + " displacements and " +
                      std::to_string(record.force_n.size()) +
                      " forces; expected the same number of each, at least one"};
  }
  const auto width = record.displacement_m.front().size();
  for (std::size_t row = 0; row < rows; ++row) {
    const std::string where = "row " + std::to_string(row + 1) + " of the record: ";
    const SiteVector& displacement_m = record.displacement_m[row];
    const SiteVector& force_n = record.force_n[row];
    if (width < 1 || displacement_m.size() != width || force_n.size() != width) {
      throw ConfigError{where + "the number of actuators differs from that of row 1"};
    }
    if (!std::isfinite(record.time_s[row]) || !displacement_m.allFinite() || !force_n.allFinite()) {
      throw ConfigError{where + "a number that is not finite"};
    }
    if (row > 0 && !(record.time_s[row] > record.time_s[row - 1])) {
      throw ConfigError{where + "its time is not later than that of the previous row"};
    }
  }
  return record;
}

}  // namespace

ReplayRig::ReplayRig(RecordedMeasurement record, AtEnd at_end)
    : record_{checked_record(std::move(record))},
      at_end_{at_end},
      present_{record_.displacement_m.front(), record_.force_n.front()} {}

void ReplayRig::connect() {
  row_ = 0;
  present_ = {record_.displacement_m.front(), record_.force_n.front()};
  phase_ = Phase::connected;
}

void ReplayRig::arm() {
  // One atomic step, so that it does not undo a stop_motion() from another thread.
  Phase expected = Phase::connected;
  if (phase_.compare_exchange_strong(expected, Phase::armed) || expected == Phase::armed) return;
  throw std::runtime_error{
      "the replay rig cannot be armed: it is not connected, or it was stopped after that; "
      "connect it again"};
}

RigStatus ReplayRig::exchange(const ActuatorCommand& command, RigFeedback& feedback) noexcept {
  const Phase phase = phase_;
  const auto fits = [this](const SiteVector& vector) { return vector.size() == present_.force_n.size(); };
  if (phase == Phase::disconnected || !fits(command.displacement_m) || !command.displacement_m.allFinite() ||
      !fits(feedback.displacement_m) || !fits(feedback.force_n)) {
    fault_ = phase == Phase::disconnected ? RigFault::not_connected : RigFault::invalid_command;
    return RigStatus::fault;
  }
  fault_ = RigFault::end_of_recording;
  const bool has_record = phase != Phase::armed || move_to(record_.time_s.front() + command.time_s);
  feedback.displacement_m = present_.displacement_m;
  feedback.force_n = present_.force_n;
  return has_record || at_end_ == AtEnd::hold ? RigStatus::healthy : RigStatus::fault;
}

bool ReplayRig::move_to(double time_s) noexcept {
  const std::vector<double>& times = record_.time_s;
  // A control period passes one or two rows, so the search is short. Time never decreases here.
  while (row_ + 1 < times.size() && times[row_ + 1] <= time_s) ++row_;
  if (row_ + 1 == times.size()) {
    present_.displacement_m = record_.displacement_m.back();
    present_.force_n = record_.force_n.back();
    return time_s <= times.back();
  }
  const double share = std::clamp((time_s - times[row_]) / (times[row_ + 1] - times[row_]), 0.0, 1.0);
  present_.displacement_m = (1.0 - share) * record_.displacement_m[row_] + share * record_.displacement_m[row_ + 1];
  present_.force_n = (1.0 - share) * record_.force_n[row_] + share * record_.force_n[row_ + 1];
  return true;
}

}  // namespace hybridtest
