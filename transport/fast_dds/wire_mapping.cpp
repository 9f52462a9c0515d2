#include "transport/fast_dds/wire_mapping.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

#include "core/assert.hpp"

namespace hybridtest::fast_dds {
namespace {

template <class Array>
constexpr std::size_t kSize = std::tuple_size_v<std::remove_cvref_t<Array>>;
static_assert(kSize<decltype(wire::TestAnnouncement{}.substructures())> == kMaxSubstructures);
static_assert(wire::Name::max_size == ParticipantId::kCapacity);

static_assert(kSize<decltype(wire::DisplacementCommand{}.points())> == kCommandPoints);

using Values = std::vector<double>;

// --- checks

bool is_time(double model_time_s) noexcept { return std::isfinite(model_time_s) && model_time_s >= 0.0; }

/// Of readings of a clock that starts with its process: a century, so that no difference of two leaves the range.
bool are_readings(std::initializer_list<Duration> readings) noexcept {
  constexpr Duration kLongest = std::chrono::hours{24 * 36'525};
  return std::ranges::all_of(readings, [&](Duration one) { return one >= -kLongest && one <= kLongest; });
}

bool is_step(Step step) noexcept { return step >= kNoStep; }

bool is_substructure(std::uint16_t index) noexcept { return index < kMaxSubstructures; }

template <class Enum>
bool to_enum(std::uint8_t number, Enum last, Enum& value) noexcept {
  if (number > static_cast<std::uint8_t>(last)) return false;
  value = static_cast<Enum>(number);
  return true;
}

bool to_reason(std::uint8_t number, StopReason& reason) noexcept {
  reason = static_cast<StopReason>(number);
  return name(reason) != "unknown";
}

bool to_code(std::uint16_t number, EventCode& code) noexcept {
  code = static_cast<EventCode>(number);
  return name(code) != "unknown";
}

// A bit is known when it has a name.
std::uint32_t known_faults() noexcept {
  std::uint32_t known = 0;
  for (std::uint32_t bit = 1; bit != 0; bit <<= 1U) {
    if (name(static_cast<FaultFlags>(bit)) != "several") known |= bit;
  }
  return known;
}

bool to_faults(std::uint32_t bits, FaultFlags& faults) noexcept {
  static const std::uint32_t known = known_faults();
  faults = static_cast<FaultFlags>(bits);
  return (bits & ~known) == 0;
}

bool to_flags(std::uint32_t bits, MeasurementFlags& flags) noexcept {
  constexpr MeasurementFlags kKnown = MeasurementFlags::extrapolated | MeasurementFlags::held |
                                      MeasurementFlags::saturated | MeasurementFlags::late |
                                      MeasurementFlags::repeated | MeasurementFlags::bridged | MeasurementFlags::missed;
  flags = static_cast<MeasurementFlags>(bits);
  return (bits & ~static_cast<std::uint32_t>(kKnown)) == 0;
}

/// What a command is for, on the wire.
constexpr std::uint8_t kStep = 0;
constexpr std::uint8_t kTrial = 1;
constexpr std::uint8_t kRehearsal = 2;

std::uint8_t purpose_of(const DisplacementCommand& command) noexcept {
  if (command.is_rehearsal) return kRehearsal;
  return command.is_trial ? kTrial : kStep;
}

// --- parts

void encode_values(const InterfaceVector& vector, Values& values) { values.assign(vector.begin(), vector.end()); }

bool decode_values(const Values& values, InterfaceVector& vector) {
  if (values.size() > kMaxInterfaceDofs) return false;
  vector = Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
  return true;
}

template <std::size_t Capacity>
void encode_text(const FixedText<Capacity>& text, eprosima::fastrtps::fixed_string<Capacity>& field) {
  std::array<char, Capacity + 1> terminated{};
  std::copy_n(text.view().data(), text.view().size(), terminated.data());
  field = terminated.data();
}

template <std::size_t Capacity>
FixedText<Capacity> decode_text(const eprosima::fastrtps::fixed_string<Capacity>& field) noexcept {
  return FixedText<Capacity>{std::string_view{field.c_str(), field.size()}};
}

void encode_point(const CommandPoint& point, wire::CommandPoint& sample) {
  sample.step(point.step);
  sample.model_time_s(point.model_time_s);
  encode_values(point.displacement_m, sample.displacement_m());
  encode_values(point.velocity_m_per_s, sample.velocity_m_per_s());
  encode_values(point.acceleration_m_per_s2, sample.acceleration_m_per_s2());
}

bool decode_point(const wire::CommandPoint& sample, CommandPoint& point) {
  point.step = sample.step();
  point.model_time_s = sample.model_time_s();
  return is_step(point.step) && is_time(point.model_time_s) &&
         decode_values(sample.displacement_m(), point.displacement_m) &&
         decode_values(sample.velocity_m_per_s(), point.velocity_m_per_s) &&
         decode_values(sample.acceleration_m_per_s2(), point.acceleration_m_per_s2);
}

}  // namespace

// --- test_announcement

void encode(const TestAnnouncement& message, wire::TestAnnouncement& sample) {
  encode_text(message.test_name, sample.test_name());
  sample.coordinator(message.coordinator);
  sample.succeeds(message.succeeds);
  sample.scenario_digest() = message.scenario_digest;
  sample.mode(static_cast<std::uint8_t>(message.mode));
  sample.step_s(message.step_s);
  sample.duration_s(message.duration_s);
  sample.time_scale(message.time_scale);
  // A test with more is refused before it announces itself.
  const std::size_t count = std::min(message.substructures.size(), sample.substructures().size());
  sample.substructure_count(static_cast<std::uint16_t>(count));
  for (std::size_t i = 0; i < sample.substructures().size(); ++i) {
    const SubstructureAnnouncement from = i < count ? message.substructures[i] : SubstructureAnnouncement{};
    wire::SubstructureAnnouncement& to = sample.substructures()[i];
    encode_text(from.id, to.id());
    to.role(static_cast<std::uint8_t>(from.role));
    to.interface_dofs(from.interface_dofs);
  }
}

bool decode(const wire::TestAnnouncement& sample, TestAnnouncement& message) noexcept {
  message.test_name = decode_text(sample.test_name());
  message.coordinator = sample.coordinator();
  message.succeeds = sample.succeeds();
  message.scenario_digest = sample.scenario_digest();
  message.step_s = sample.step_s();
  message.duration_s = sample.duration_s();
  message.time_scale = sample.time_scale();
  if (!to_enum(sample.mode(), CouplingMode::real_time, message.mode)) return false;
  if (!is_time(message.step_s) || !is_time(message.duration_s) || !is_time(message.time_scale)) return false;
  if (sample.substructure_count() > kMaxSubstructures) return false;
  message.substructures.resize(sample.substructures().size());
  for (std::size_t i = 0; i < message.substructures.size(); ++i) {
    const wire::SubstructureAnnouncement& from = sample.substructures()[i];
    SubstructureAnnouncement& to = message.substructures[i];
    to.id = decode_text(from.id());
    to.interface_dofs = from.interface_dofs();
    if (!to_enum(from.role(), Role::operator_tool, to.role) || to.interface_dofs > kMaxInterfaceDofs) return false;
  }
  message.substructures.resize(sample.substructure_count());
  return true;
}

// --- participant_status

void encode(const ParticipantStatus& message, wire::ParticipantStatus& sample) {
  encode_text(message.id, sample.id());
  sample.role(static_cast<std::uint8_t>(message.role));
  sample.incarnation(message.incarnation);
  sample.state(static_cast<std::uint8_t>(message.state));
  sample.scenario_digest() = message.scenario_digest;
  sample.last_step(message.last_step);
  sample.faults(static_cast<std::uint32_t>(message.faults));
  sample.clock_ns(message.clock.count());
}

bool decode(const wire::ParticipantStatus& sample, ParticipantStatus& message) noexcept {
  message.id = decode_text(sample.id());
  message.incarnation = sample.incarnation();
  message.scenario_digest = sample.scenario_digest();
  message.last_step = sample.last_step();
  message.clock = Duration{sample.clock_ns()};
  return to_enum(sample.role(), Role::operator_tool, message.role) &&
         to_enum(sample.state(), LifecycleState::waiting, message.state) && is_step(message.last_step) &&
         are_readings({message.clock}) && to_faults(sample.faults(), message.faults);
}

// --- displacement_command

void encode(const DisplacementCommand& message, wire::DisplacementCommand& sample) {
  sample.substructure(message.substructure);
  sample.attempt(message.attempt);
  sample.iteration(message.iteration);
  sample.purpose(purpose_of(message));
  sample.coordinator(message.coordinator);
  sample.send_time_ns(message.send_time.count());
  sample.point_count(message.point_count);
  // Those not in use stay empty: of a wide interface they would make the message four times as large.
  static const CommandPoint kEmpty;
  for (std::size_t i = 0; i < message.points.size(); ++i) {
    encode_point(i < message.point_count ? message.points[i] : kEmpty, sample.points()[i]);
  }
}

bool decode(const wire::DisplacementCommand& sample, DisplacementCommand& message) {
  message.substructure = sample.substructure();
  message.attempt = sample.attempt();
  message.iteration = sample.iteration();
  if (sample.purpose() > kRehearsal) return false;
  message.is_trial = sample.purpose() == kTrial;
  message.is_rehearsal = sample.purpose() == kRehearsal;
  message.coordinator = sample.coordinator();
  message.send_time = Duration{sample.send_time_ns()};
  if (!is_substructure(message.substructure) || !are_readings({message.send_time})) return false;
  message.point_count = sample.point_count();
  if (message.point_count < 1 || message.point_count > kCommandPoints) return false;
  for (std::size_t i = 0; i < message.points.size(); ++i) {
    if (!decode_point(sample.points()[i], message.points[i])) return false;
  }
  return true;
}

// --- force_measurement

void encode(const ForceMeasurement& message, wire::ForceMeasurement& sample) {
  sample.substructure(message.substructure);
  sample.flags(static_cast<std::uint32_t>(message.flags));
  sample.sender(message.sender);
  sample.step(message.step);
  sample.iteration(message.iteration);
  sample.model_time_s(message.model_time_s);
  sample.receive_time_ns(message.receive_time.count());
  sample.send_time_ns(message.send_time.count());
  sample.command_send_time_ns(message.command_send_time.count());
  encode_values(message.imposed_displacement_m, sample.imposed_displacement_m());
  encode_values(message.measured_displacement_m, sample.measured_displacement_m());
  encode_values(message.force_n, sample.force_n());
}

bool decode(const wire::ForceMeasurement& sample, ForceMeasurement& message) {
  message.substructure = sample.substructure();
  message.sender = sample.sender();
  message.step = sample.step();
  message.iteration = sample.iteration();
  message.model_time_s = sample.model_time_s();
  message.receive_time = Duration{sample.receive_time_ns()};
  message.send_time = Duration{sample.send_time_ns()};
  message.command_send_time = Duration{sample.command_send_time_ns()};
  return are_readings({message.receive_time, message.send_time, message.command_send_time}) &&
         is_substructure(message.substructure) && is_step(message.step) && is_time(message.model_time_s) &&
         to_flags(sample.flags(), message.flags) &&
         decode_values(sample.imposed_displacement_m(), message.imposed_displacement_m) &&
         decode_values(sample.measured_displacement_m(), message.measured_displacement_m) &&
         decode_values(sample.force_n(), message.force_n);
}

// --- test_control

void encode(const TestControl& message, wire::TestControl& sample) noexcept {
  sample.verb(static_cast<std::uint8_t>(message.verb));
  sample.sender(message.sender);
  sample.sender_role(static_cast<std::uint8_t>(message.sender_role));
  sample.reason(static_cast<std::uint8_t>(message.reason));
}

bool decode(const wire::TestControl& sample, TestControl& message) noexcept {
  message.sender = sample.sender();
  return to_enum(sample.verb(), ControlVerb::emergency_stop, message.verb) &&
         to_enum(sample.sender_role(), Role::operator_tool, message.sender_role) &&
         to_reason(sample.reason(), message.reason);
}

// --- event

void encode(const Event& message, wire::Event& sample) {
  encode_text(message.source, sample.source());
  sample.incarnation(message.incarnation);
  sample.severity(static_cast<std::uint8_t>(message.severity));
  sample.code(static_cast<std::uint16_t>(message.code));
  sample.step(message.step);
  sample.model_time_s(message.model_time_s);
  encode_text(message.subject, sample.subject());
  sample.values() = message.values;
  sample.clock_ns(message.clock.count());
}

bool decode(const wire::Event& sample, Event& message) noexcept {
  message.source = decode_text(sample.source());
  message.incarnation = sample.incarnation();
  message.step = sample.step();
  message.model_time_s = sample.model_time_s();
  message.subject = decode_text(sample.subject());
  message.values = sample.values();
  message.clock = Duration{sample.clock_ns()};
  return to_enum(sample.severity(), Severity::fault, message.severity) && to_code(sample.code(), message.code) &&
         is_step(message.step) && is_time(message.model_time_s) && are_readings({message.clock});
}

// --- signal_block

namespace {

/// A text and the end of its line. A text does not go over several lines.
template <std::size_t Capacity>
void add_line(const FixedText<Capacity>& text, std::string& lines) {
  const auto begin = lines.insert(lines.end(), text.view().begin(), text.view().end());
  std::replace(begin, lines.end(), '\n', ' ');
  lines += '\n';
}

/// Takes the first line off. @return false without one, and for one that is too long.
template <std::size_t Capacity>
bool take_line(std::string_view& lines, FixedText<Capacity>& text) noexcept {
  const auto end = lines.find('\n');
  if (end > Capacity) return false;  // as npos is
  text = FixedText<Capacity>{lines.substr(0, end)};
  lines.remove_prefix(end + 1);
  return true;
}

template <std::size_t Capacity>
std::string_view view_of(const eprosima::fastrtps::fixed_string<Capacity>& field) noexcept {
  return {field.c_str(), field.size()};
}

}  // namespace

void encode(const SignalBlock& message, wire::SignalBlock& sample) {
  encode_text(message.participant, sample.participant());
  encode_text(message.group, sample.group());
  sample.part(message.part);
  sample.incarnation(message.incarnation);
  sample.sequence_number(message.sequence);
  sample.model_time_s(message.model_time_s);
  const std::size_t count = message.signals.size();
  HYBRIDTEST_ASSERT(count <= kMaxLiveSignals && message.model_time_s.size() <= kMaxLivePoints);
  sample.limits().resize(count);
  for (Values* values : {&sample.least(), &sample.most(), &sample.last()}) values->clear();
  std::string names;
  std::string subjects;
  std::string units;
  for (std::size_t i = 0; i < count; ++i) {
    const LiveSignal& signal = message.signals[i];
    add_line(signal.name, names);
    add_line(signal.subject, subjects);
    add_line(signal.unit, units);
    sample.limits()[i] = signal.limit;
    sample.least().insert(sample.least().end(), signal.least.begin(), signal.least.end());
    sample.most().insert(sample.most().end(), signal.most.begin(), signal.most.end());
    sample.last().insert(sample.last().end(), signal.last.begin(), signal.last.end());
  }
  sample.names() = names.c_str();
  sample.subjects() = subjects.c_str();
  sample.units() = units.c_str();
}

bool decode(const wire::SignalBlock& sample, SignalBlock& message) noexcept {
  message.participant = decode_text(sample.participant());
  message.group = decode_text(sample.group());
  message.part = sample.part();
  message.incarnation = sample.incarnation();
  message.sequence = sample.sequence_number();
  message.model_time_s = sample.model_time_s();
  const std::size_t points = message.model_time_s.size();
  const std::size_t count = sample.limits().size();
  if (points > kMaxLivePoints || count > kMaxLiveSignals) return false;
  if (!std::ranges::all_of(message.model_time_s, is_time) || !std::ranges::is_sorted(message.model_time_s))
    return false;
  std::string_view names = view_of(sample.names());
  std::string_view subjects = view_of(sample.subjects());
  std::string_view units = view_of(sample.units());
  for (const Values* values : {&sample.least(), &sample.most(), &sample.last()}) {
    if (values->size() != count * points) return false;
  }
  message.signals.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    LiveSignal& signal = message.signals[i];
    if (!take_line(names, signal.name) || !take_line(subjects, signal.subject) || !take_line(units, signal.unit)) {
      return false;
    }
    signal.limit = sample.limits()[i];
    if (signal.limit < 0.0) return false;
    const auto piece = [&](const Values& values) {
      const auto begin = values.begin() + static_cast<std::ptrdiff_t>(i * points);
      return Values{begin, begin + static_cast<std::ptrdiff_t>(points)};
    };
    signal.least = piece(sample.least());
    signal.most = piece(sample.most());
    signal.last = piece(sample.last());
  }
  return names.empty() && subjects.empty() && units.empty();
}

}  // namespace hybridtest::fast_dds
