#include "transport/fast_dds/wire_mapping.hpp"

#include <gtest/gtest.h>

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "core/random.hpp"

namespace hybridtest::fast_dds {
namespace {

/// Over the wire: encode, serialise to CDR, back, decode.
template <class Sample, class Message>
[[nodiscard]] bool travels(const Message& message, Message& received) {
  Sample sent;
  encode(message, sent);
  std::vector<char> bytes(Sample::getMaxCdrSerializedSize() + 4);
  eprosima::fastcdr::FastBuffer out_buffer{bytes.data(), bytes.size()};
  eprosima::fastcdr::Cdr out{out_buffer};
  sent.serialize(out);
  eprosima::fastcdr::FastBuffer in_buffer{bytes.data(), out.getSerializedDataLength()};
  eprosima::fastcdr::Cdr in{in_buffer};
  Sample arrived;
  arrived.deserialize(in);
  return decode(arrived, received);
}

// --- random messages over the whole range of each type

class Draw {
 public:
  explicit Draw(std::uint64_t seed) : random_{seed} {}

  template <class Number>
  Number any() {
    return static_cast<Number>(random_.bits());
  }
  std::uint64_t up_to(std::uint64_t last) { return random_.below(last + 1); }
  /// Any magnitude, now and then no number at all.
  double value() {
    switch (random_.below(8)) {
      case 0: return 0.0;
      case 1: return -0.0;
      case 2: return std::numeric_limits<double>::infinity();
      case 3: return std::numeric_limits<double>::denorm_min();
      default: return random_.uniform(-1.0, 1.0) * std::pow(10.0, random_.uniform(-300.0, 300.0));
    }
  }
  double time_s() { return random_.uniform(0.0, 1e6); }
  Step step() { return static_cast<Step>(random_.bits() >> 1U) - 1; }
  Duration clock() { return Duration{any<std::int64_t>() / 4}; }
  InterfaceVector vector() {
    InterfaceVector result{static_cast<Eigen::Index>(up_to(kMaxInterfaceDofs))};
    for (double& entry : result) entry = value();
    return result;
  }
  template <std::size_t Capacity>
  FixedText<Capacity> text() {
    std::string result(up_to(Capacity), ' ');
    for (char& letter : result) letter = static_cast<char>(1 + up_to(254));  // any byte but the end of text
    return FixedText<Capacity>{result};
  }
  /// Names of signals stand in lines.
  template <std::size_t Capacity>
  FixedText<Capacity> line() {
    std::string result = text<Capacity>().text();
    std::ranges::replace(result, '\n', ' ');
    return FixedText<Capacity>{result};
  }
  ScenarioDigest digest() {
    ScenarioDigest result;
    for (auto& byte : result) byte = any<std::uint8_t>();
    return result;
  }
  template <class Enum>
  Enum one_of(Enum last) {
    return static_cast<Enum>(up_to(static_cast<std::uint64_t>(last)));
  }

  TestAnnouncement announcement() {
    TestAnnouncement m;
    m.test_name = text<64>();
    m.coordinator = any<Incarnation>();
    m.succeeds = any<Incarnation>();
    m.scenario_digest = digest();
    m.mode = one_of(CouplingMode::paced);
    m.step_s = time_s();
    m.duration_s = time_s();
    m.time_scale = time_s();
    m.substructures.resize(static_cast<std::size_t>(up_to(kMaxSubstructures)));
    for (auto& substructure : m.substructures) {
      substructure = {text<48>(), one_of(Role::operator_tool), static_cast<std::uint16_t>(up_to(kMaxInterfaceDofs))};
    }
    return m;
  }
  ParticipantStatus status() {
    return {text<48>(),
            one_of(Role::operator_tool),
            any<Incarnation>(),
            one_of(LifecycleState::waiting),
            digest(),
            step(),
            static_cast<FaultFlags>(up_to(0x7ffff)),
            clock()};
  }
  DisplacementCommand command() {
    DisplacementCommand m;
    m.substructure = static_cast<SubstructureIndex>(up_to(kMaxSubstructures - 1));
    m.coordinator = any<Incarnation>();
    m.iteration = any<std::uint16_t>();
    m.is_trial = up_to(1) == 1;
    m.is_rehearsal = !m.is_trial && up_to(1) == 1;
    m.point_count = static_cast<std::uint8_t>(1 + up_to(kCommandPoints - 1));
    for (auto& point : m.points) point = {step(), time_s(), vector(), vector(), vector()};
    m.attempt = any<std::uint16_t>();
    m.send_time = clock();
    return m;
  }
  ForceMeasurement measurement() {
    return {static_cast<SubstructureIndex>(up_to(kMaxSubstructures - 1)),
            any<Incarnation>(),
            step(),
            any<std::uint16_t>(),
            time_s(),
            vector(),
            vector(),
            vector(),
            static_cast<MeasurementFlags>(up_to(0x7f)),
            clock(),
            clock(),
            clock()};
  }
  TestControl control() {
    return {one_of(ControlVerb::emergency_stop), any<Incarnation>(), one_of(Role::operator_tool),
            one_of(StopReason::resume_refused)};
  }
  Event event() {
    return {text<48>(),
            any<Incarnation>(),
            one_of(Severity::fault),
            one_of(EventCode::resume_refused),
            step(),
            time_s(),
            text<48>(),
            {value(), value()},
            clock()};
  }
  SignalBlock signal() {
    SignalBlock m;
    m.participant = text<48>();
    m.incarnation = any<Incarnation>();
    m.group = text<32>();
    m.part = any<std::uint16_t>();
    m.sequence = any<std::uint64_t>();
    const std::size_t points = up_to(kMaxLivePoints);
    for (std::size_t i = 0; i < points; ++i) m.model_time_s.push_back(static_cast<double>(i) * 0.05);
    const auto values = [&] {
      std::vector<double> result;
      for (std::size_t i = 0; i < points; ++i) result.push_back(value());
      return result;
    };
    m.signals.resize(1 + up_to(kMaxLiveSignals - 1));
    for (LiveSignal& signal : m.signals) {
      signal = {line<48>(), line<128>(), line<16>(), time_s(), values(), values(), values()};
    }
    return m;
  }

 private:
  Random random_;
};

bool same(const InterfaceVector& a, const InterfaceVector& b) {
  if (a.size() != b.size() || a.size() == 0) return a.size() == b.size();
  return std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.size()) * sizeof(double)) == 0;
}

template <class Message>
bool same(const Message& a, const Message& b) {
  return a == b;
}

bool same(const CommandPoint& a, const CommandPoint& b) {
  return a.step == b.step && a.model_time_s == b.model_time_s && same(a.displacement_m, b.displacement_m) &&
         same(a.velocity_m_per_s, b.velocity_m_per_s) && same(a.acceleration_m_per_s2, b.acceleration_m_per_s2);
}

// Vectors apart: Eigen compares vectors of one size only, and 0 equals -0.
bool same(const DisplacementCommand& a, const DisplacementCommand& b) {
  bool equal = a.substructure == b.substructure && a.coordinator == b.coordinator && a.point_count == b.point_count &&
               a.attempt == b.attempt && a.send_time == b.send_time;
  // Those not in use are not sent.
  for (std::size_t i = 0; i < a.point_count; ++i) equal = equal && same(a.points[i], b.points[i]);
  return equal;
}

bool same(const ForceMeasurement& a, const ForceMeasurement& b) {
  return a.substructure == b.substructure && a.sender == b.sender && a.step == b.step &&
         a.model_time_s == b.model_time_s && same(a.imposed_displacement_m, b.imposed_displacement_m) &&
         same(a.measured_displacement_m, b.measured_displacement_m) && same(a.force_n, b.force_n) &&
         a.flags == b.flags && a.receive_time == b.receive_time && a.send_time == b.send_time &&
         a.command_send_time == b.command_send_time;
}

template <class Sample, class Message>
void round_trip(Message (Draw::*draw)()) {
  Draw source{2024};
  for (int i = 0; i < 2000; ++i) {
    const Message message = (source.*draw)();
    Message received;
    ASSERT_TRUE((travels<Sample>(message, received))) << "draw " << i;
    ASSERT_TRUE(same(message, received)) << "draw " << i;
  }
}

TEST(WireMapping, AnnouncementRoundTrips) { round_trip<wire::TestAnnouncement>(&Draw::announcement); }
TEST(WireMapping, StatusRoundTrips) { round_trip<wire::ParticipantStatus>(&Draw::status); }
TEST(WireMapping, CommandRoundTrips) { round_trip<wire::DisplacementCommand>(&Draw::command); }
TEST(WireMapping, MeasurementRoundTrips) { round_trip<wire::ForceMeasurement>(&Draw::measurement); }
TEST(WireMapping, ControlRoundTrips) { round_trip<wire::TestControl>(&Draw::control); }
TEST(WireMapping, EventRoundTrips) { round_trip<wire::Event>(&Draw::event); }
TEST(WireMapping, SignalBlockRoundTrips) { round_trip<wire::SignalBlock>(&Draw::signal); }

TEST(WireMapping, NotANumberRoundTrips) {
  ForceMeasurement message = Draw{1}.measurement();
  message.force_n = InterfaceVector::Constant(3, std::numeric_limits<double>::quiet_NaN());
  ForceMeasurement received;
  ASSERT_TRUE((travels<wire::ForceMeasurement>(message, received)));
  EXPECT_TRUE(same(message, received));
}

/// Whether a valid message is refused after `change` has had its way with it on the wire.
template <class Sample, class Message, class Change>
[[nodiscard]] bool refused_after(const Message& message, Change change) {
  Sample sample;
  encode(message, sample);
  Message received;
  EXPECT_TRUE(decode(sample, received)) << "valid before the change";
  change(sample);
  return !decode(sample, received);
}

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
/// Two hundred years: differences of such readings leave the range of 64 bits.
constexpr std::int64_t kBeyondAnyClock = 6'311'520'000LL * 1'000'000'000LL;

TEST(WireMapping, RejectsCommandOutOfRange) {
  const auto refused = [](auto change) { return refused_after<wire::DisplacementCommand>(Draw{3}.command(), change); };
  EXPECT_TRUE(refused([](auto& s) { s.substructure(kMaxSubstructures); }));
  EXPECT_TRUE(refused([](auto& s) { s.point_count(0); }));
  EXPECT_TRUE(refused([](auto& s) { s.purpose(3); }));
  EXPECT_TRUE(refused([](auto& s) { s.point_count(kCommandPoints + 1); }));
  EXPECT_TRUE(refused([](auto& s) { s.points()[3].step(-2); }));
  EXPECT_TRUE(refused([](auto& s) { s.points()[3].model_time_s(-1e-9); }));
  EXPECT_TRUE(refused([](auto& s) { s.points()[0].model_time_s(kNaN); }));
  EXPECT_TRUE(refused([](auto& s) { s.points()[0].displacement_m().resize(kMaxInterfaceDofs + 1); }));
  EXPECT_TRUE(refused([](auto& s) { s.points()[1].velocity_m_per_s().resize(kMaxInterfaceDofs + 1); }));
  EXPECT_TRUE(refused([](auto& s) { s.points()[2].acceleration_m_per_s2().resize(kMaxInterfaceDofs + 1); }));
  EXPECT_TRUE(refused([](auto& s) { s.send_time_ns(kBeyondAnyClock); }));
  EXPECT_FALSE(refused([](auto& s) { s.points()[2].acceleration_m_per_s2().resize(kMaxInterfaceDofs); }));
  EXPECT_FALSE(refused([](auto& s) { s.points()[0].displacement_m().assign(1, kNaN); })) << "for the nodes to decide";
}

TEST(WireMapping, RejectsMeasurementOutOfRange) {
  const auto refused = [](auto change) { return refused_after<wire::ForceMeasurement>(Draw{4}.measurement(), change); };
  EXPECT_TRUE(refused([](auto& s) { s.substructure(65535); }));
  EXPECT_TRUE(refused([](auto& s) { s.flags(1U << 7U); }));
  EXPECT_TRUE(refused([](auto& s) { s.step(-2); }));
  EXPECT_TRUE(refused([](auto& s) { s.model_time_s(std::numeric_limits<double>::infinity()); }));
  EXPECT_TRUE(refused([](auto& s) { s.imposed_displacement_m().resize(kMaxInterfaceDofs + 1); }));
  EXPECT_TRUE(refused([](auto& s) { s.measured_displacement_m().resize(kMaxInterfaceDofs + 1); }));
  EXPECT_TRUE(refused([](auto& s) { s.force_n().resize(kMaxInterfaceDofs + 1); }));
  EXPECT_TRUE(refused([](auto& s) { s.receive_time_ns(kBeyondAnyClock); }));
  EXPECT_TRUE(refused([](auto& s) { s.send_time_ns(-kBeyondAnyClock); }));
  EXPECT_TRUE(refused([](auto& s) { s.command_send_time_ns(std::numeric_limits<std::int64_t>::min()); }));
}

TEST(WireMapping, RejectsStatusOutOfRange) {
  const auto refused = [](auto change) { return refused_after<wire::ParticipantStatus>(Draw{5}.status(), change); };
  EXPECT_TRUE(refused([](auto& s) { s.role(4); }));
  EXPECT_TRUE(refused([](auto& s) { s.clock_ns(kBeyondAnyClock); }));
  EXPECT_TRUE(refused([](auto& s) { s.state(static_cast<std::uint8_t>(LifecycleState::lost)); }))
      << "only the transport says who is lost";
  EXPECT_TRUE(refused([](auto& s) { s.last_step(-2); }));
  EXPECT_TRUE(refused([](auto& s) { s.faults(1U << 31U); }));
}

TEST(WireMapping, RejectsAnnouncementOutOfRange) {
  const auto refused = [](auto change) {
    return refused_after<wire::TestAnnouncement>(Draw{6}.announcement(), change);
  };
  EXPECT_TRUE(refused([](auto& s) { s.mode(3); }));
  EXPECT_TRUE(refused([](auto& s) { s.substructure_count(kMaxSubstructures + 1); }));
  EXPECT_TRUE(refused([](auto& s) { s.step_s(kNaN); }));
  EXPECT_TRUE(refused([](auto& s) { s.duration_s(-1.0); }));
  EXPECT_TRUE(refused([](auto& s) { s.time_scale(kNaN); }));
  EXPECT_TRUE(refused([](auto& s) { s.substructures()[31].role(9); }));
  EXPECT_TRUE(refused([](auto& s) { s.substructures()[31].interface_dofs(kMaxInterfaceDofs + 1); }));
}

TEST(WireMapping, RejectsControlAndEventOutOfRange) {
  const auto control_refused = [](auto change) { return refused_after<wire::TestControl>(Draw{7}.control(), change); };
  EXPECT_TRUE(control_refused([](auto& s) { s.verb(6); }));
  EXPECT_TRUE(control_refused([](auto& s) { s.sender_role(4); }));
  EXPECT_TRUE(control_refused([](auto& s) { s.reason(200); }));
  const auto event_refused = [](auto change) { return refused_after<wire::Event>(Draw{8}.event(), change); };
  EXPECT_TRUE(event_refused([](auto& s) { s.severity(3); }));
  EXPECT_TRUE(event_refused([](auto& s) { s.code(60000); }));
  EXPECT_TRUE(event_refused([](auto& s) { s.step(-2); }));
  EXPECT_TRUE(event_refused([](auto& s) { s.model_time_s(kNaN); }));
  EXPECT_FALSE(event_refused([](auto& s) { s.values()[0] = kNaN; }));
}

TEST(WireMapping, RejectsSignalBlockOutOfRange) {
  const auto refused = [](auto change) { return refused_after<wire::SignalBlock>(Draw{9}.signal(), change); };
  EXPECT_TRUE(refused([](auto& s) { s.model_time_s().resize(kMaxLivePoints + 1); }));
  EXPECT_TRUE(refused([](auto& s) { s.names() = ""; })) << "a line for each signal";
  EXPECT_TRUE(refused([](auto& s) { s.units() = (std::string{s.units().c_str()} + "m\n").c_str(); })) << "no more";
  EXPECT_TRUE(refused([](auto& s) { s.units() = (std::string(17, 'm') + std::string(16, '\n')).c_str(); }))
      << "too long";
  EXPECT_TRUE(refused([](auto& s) { s.limits().push_back(0.0); }));
  EXPECT_TRUE(refused([](auto& s) { s.model_time_s().push_back(kNaN); }));
  EXPECT_TRUE(refused([](auto& s) { s.least().push_back(0.0); }));
  EXPECT_TRUE(refused([](auto& s) { s.limits()[0] = -1.0; }));
  EXPECT_FALSE(refused([](auto& s) { s.limits()[0] = kNaN; }));
}

TEST(WireMapping, RejectsSignalTimesThatGoBack) {
  const auto refused = [](std::vector<double> times) {
    wire::SignalBlock sample;
    sample.model_time_s(std::move(times));
    SignalBlock message;
    return !decode(sample, message);
  };
  EXPECT_FALSE(refused({0.0, 0.05, 0.05}));
  EXPECT_TRUE(refused({0.05, 0.0}));
}

/// Of a command for an interface of so many degrees of freedom.
std::size_t command_bytes(Eigen::Index dofs, int points = kCommandPoints) {
  DisplacementCommand command;
  command.point_count = static_cast<std::uint8_t>(points);
  for (CommandPoint& point : command.points) {
    point.displacement_m = point.velocity_m_per_s = point.acceleration_m_per_s2 = InterfaceVector::Zero(dofs);
  }
  wire::DisplacementCommand sample;
  encode(command, sample);
  return wire::DisplacementCommand::getCdrSerializedSize(sample);
}

std::size_t measurement_bytes(Eigen::Index dofs) {
  ForceMeasurement measurement;
  measurement.imposed_displacement_m = measurement.measured_displacement_m = measurement.force_n =
      InterfaceVector::Zero(dofs);
  wire::ForceMeasurement sample;
  encode(measurement, sample);
  return wire::ForceMeasurement::getCdrSerializedSize(sample);
}

TEST(WireMapping, MessagesAreAsSmallAsTheInterface) {
  // Header 24, and in each of four points: step and time 16, three lengths with a value each 3 (8 + 8).
  EXPECT_EQ(command_bytes(1), 24U + 4U * (16U + 3U * 16U));
  // Header 64 with its padding, and three lengths with a value each.
  EXPECT_EQ(measurement_bytes(1), 64U + 3U * 16U);
  EXPECT_EQ(command_bytes(100) - command_bytes(1), 4U * 3U * 99U * 8U);
}

TEST(WireMapping, WidestMessagesFitOneDatagram) {
  // Of 65 507 bytes, less the headers below: what is larger travels in fragments.
  constexpr std::size_t kRoom = 65507 - 20 - 12 - 24 - 24 - 32 - 4;
  EXPECT_LE(command_bytes(kMaxInterfaceDofs, 1), kRoom);
  EXPECT_GT(command_bytes(kMaxInterfaceDofs, kCommandPoints), kRoom) << "which is why they have no history";
  EXPECT_LE(measurement_bytes(kMaxInterfaceDofs), kRoom);
}

TEST(WireMapping, SiteMessagesFitOneEthernetFrame) {
  // 1500 bytes less headers: IP 20, UDP 8, RTPS 20, INFO_TS 12, DATA 24 with inline key hash 24,
  // HEARTBEAT that rides along 32, encapsulation 4.
  constexpr std::size_t kRoom = 1500 - 20 - 8 - 20 - 12 - 24 - 24 - 32 - 4;
  EXPECT_LE(command_bytes(kMaxSiteDofs), kRoom);
  EXPECT_LE(measurement_bytes(kMaxSiteDofs), kRoom);
}

}  // namespace
}  // namespace hybridtest::fast_dds
