#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string_view>
#include <vector>

#include "core/faults.hpp"
#include "core/fixed_text.hpp"
#include "core/interface_vector.hpp"
#include "core/time.hpp"

/// The messages of a hybrid test, independent of the transport. `idl/hybridtest.idl` defines
/// their form on the network; `transport/fast_dds/wire_mapping.hpp` converts between the two.
///
/// Displacement, force and their derivatives are in the substructure's interface coordinates:
/// displacement positive along the structure's degree of freedom (against `relative_to`), the
/// restoring force positive when it resists a positive displacement.
namespace hybridtest {

/// In a test whose participants are processes on a network: a test announcement of a fixed size has room for so many.
inline constexpr int kMaxSubstructures = 32;
/// In a test under simulated time, in one process and without DDS. Every participant has a recording, and a process may
/// usually have 1024 files open.
inline constexpr int kMaxSimulatedSubstructures = 1000;
/// Number of points in each command: the newest one and those before it.
inline constexpr int kCommandPoints = 4;
/// In one block of live signals.
inline constexpr std::size_t kMaxLiveSignals = 16;
inline constexpr std::size_t kMaxLivePoints = 16;

using ParticipantId = FixedText<48>;
/// The id of the coordinator of every test.
inline constexpr std::string_view kCoordinatorId = "coordinator";
/// Stands for an OpenSees that leads, where an event names who ended it.
inline constexpr std::string_view kOpenSeesId = "opensees";
/// Stands for the person who stops a test, where an event names who ended it.
inline constexpr std::string_view kOperatorId = "operator";
using ScenarioDigest = std::array<std::uint8_t, 32>;  // SHA-256 of the effective scenario

/// Random number of each process, drawn at its start; distinguishes two processes with one id.
using Incarnation = std::uint64_t;

/// Position of a substructure in the scenario's list; the key of commands and measurements.
using SubstructureIndex = std::uint16_t;

/// Step 0 is the initial state at model time 0.
using Step = std::int64_t;
inline constexpr Step kNoStep = -1;

enum class Role : std::uint8_t { coordinator, numerical_substructure, experimental_site, operator_tool };

enum class CouplingMode : std::uint8_t { lockstep, paced, real_time };

/// As scenarios have it.
[[nodiscard]] constexpr std::string_view name(CouplingMode mode) noexcept {
  switch (mode) {
    case CouplingMode::lockstep: return "lockstep";
    case CouplingMode::paced: return "paced";
    case CouplingMode::real_time: return "real_time";
  }
  return "unknown";
}

/// Life of a participant. `lost` is never sent: the transport reports it for a participant
/// whose liveliness lease ran out.
enum class LifecycleState : std::uint8_t {
  joining,  // looking for the test; nothing is checked yet
  ready,    // scenario agreed, rig connected; nothing can move
  armed,    // rig armed; motion possible
  running,
  stopping,  // bringing the rig to rest
  finished,  // at rest, records closed, about to leave
  refused,   // does not take part; the event gives the reason
  waiting,   // the coordinator is lost, and a successor is waited for; the specimen is held, the state of a model kept
  lost,
};

struct SubstructureAnnouncement {
  ParticipantId id;
  Role role = Role::numerical_substructure;
  std::uint16_t interface_dofs = 0;
  bool operator==(const SubstructureAnnouncement&) const = default;
};

/// Coordinator to all, transient local: the test that is about to run.
struct TestAnnouncement {
  FixedText<64> test_name;
  Incarnation coordinator = 0;
  /// The first coordinator of the test that is resumed; 0 for a new test.
  Incarnation succeeds = 0;
  ScenarioDigest scenario_digest{};
  CouplingMode mode = CouplingMode::lockstep;
  double step_s = 0.0;                                    // [s] model time
  double duration_s = 0.0;                                // [s] model time
  double time_scale = 1.0;                                // [-] wall time over model time, paced mode
  std::vector<SubstructureAnnouncement> substructures{};  // at most kMaxSubstructures over a network
  bool operator==(const TestAnnouncement&) const = default;
};

/// Everyone to all, keyed by participant, transient local; repeated as a heartbeat.
struct ParticipantStatus {
  ParticipantId id;
  Role role = Role::operator_tool;
  Incarnation incarnation = 0;
  LifecycleState state = LifecycleState::joining;
  ScenarioDigest scenario_digest{};
  Step last_step = kNoStep;  // last step answered or, for the coordinator, completed
  FaultFlags faults = FaultFlags::none;
  Duration clock{};  // [ns] sender's clock at sending; it starts with the process, so this is its age
  bool operator==(const ParticipantStatus&) const = default;
};

/// Whether two vectors have the same size and entries; Eigen's own comparison wants equal sizes.
[[nodiscard]] inline bool same(const Eigen::Ref<const Eigen::VectorXd>& a,
                               const Eigen::Ref<const Eigen::VectorXd>& b) noexcept {
  return a.size() == b.size() && a == b;
}

/// The structure's motion at one step, in interface coordinates.
template <class Vector>
struct MotionPoint {
  Step step = kNoStep;
  double model_time_s = 0.0;     // [s]
  Vector displacement_m;         // [m]
  Vector velocity_m_per_s;       // [m/s] integrator's own; predicted on the newest point
  Vector acceleration_m_per_s2;  // [m/s2] likewise
  bool operator==(const MotionPoint& other) const noexcept {
    return step == other.step && model_time_s == other.model_time_s && same(displacement_m, other.displacement_m) &&
           same(velocity_m_per_s, other.velocity_m_per_s) && same(acceleration_m_per_s2, other.acceleration_m_per_s2);
  }
};

using CommandPoint = MotionPoint<InterfaceVector>;
/// The same on the control path of a site, which never allocates.
using TargetPoint = MotionPoint<SiteVector>;

/// Coordinator to one substructure, keyed by its index.
struct DisplacementCommand {
  SubstructureIndex substructure = 0;
  Incarnation coordinator = 0;
  /// Within the newest step, from 0; integrators that do not iterate have one. A later one takes the place of those
  /// before.
  std::uint16_t iteration = 0;
  /// The substructure answers the force and keeps the state of the step before. Otherwise the step ends here.
  bool is_trial = false;
  /// Before a real-time test, to measure the round trip: answered at once with the iteration and without a force.
  /// Nothing moves.
  bool is_rehearsal = false;
  std::uint8_t point_count = 0;                       // 1 to kCommandPoints
  std::array<CommandPoint, kCommandPoints> points{};  // newest first; consecutive steps
  std::uint16_t attempt = 0;                          // 0 when first sent, counts repeats
  Duration send_time{};                               // [ns] coordinator's clock

  [[nodiscard]] const CommandPoint& newest() const noexcept { return points[0]; }
  /// Whether there is a point and each has a value per degree of freedom in every quantity.
  [[nodiscard]] bool fits(Eigen::Index dofs) const noexcept;
  bool operator==(const DisplacementCommand&) const = default;
};

inline bool DisplacementCommand::fits(Eigen::Index dofs) const noexcept {
  if (point_count == 0 || point_count > kCommandPoints) return false;
  for (int i = 0; i < point_count; ++i) {
    const CommandPoint& point = points[static_cast<std::size_t>(i)];
    if (point.displacement_m.size() != dofs || point.velocity_m_per_s.size() != dofs ||
        point.acceleration_m_per_s2.size() != dofs) {
      return false;
    }
  }
  return true;
}

/// A substructure to the coordinator, keyed by its index.
struct ForceMeasurement {
  SubstructureIndex substructure = 0;
  Incarnation sender = 0;
  Step step = kNoStep;
  std::uint16_t iteration = 0;              // of the command answered
  double model_time_s = 0.0;                // [s] of the step answered
  InterfaceVector imposed_displacement_m;   // [m] commanded to the actuators or the model
  InterfaceVector measured_displacement_m;  // [m]
  InterfaceVector force_n;                  // [N] restoring force
  MeasurementFlags flags = MeasurementFlags::none;
  Duration receive_time{};       // [ns] sender's clock, command received
  Duration send_time{};          // [ns] sender's clock
  Duration command_send_time{};  // [ns] echo of the command's send_time, coordinator's clock
  bool operator==(const ForceMeasurement& other) const noexcept {
    return substructure == other.substructure && sender == other.sender && step == other.step &&
           iteration == other.iteration && model_time_s == other.model_time_s &&
           same(imposed_displacement_m, other.imposed_displacement_m) &&
           same(measured_displacement_m, other.measured_displacement_m) && same(force_n, other.force_n) &&
           flags == other.flags && receive_time == other.receive_time && send_time == other.send_time &&
           command_send_time == other.command_send_time;
  }
};

enum class ControlVerb : std::uint8_t { arm, start, pause, resume, stop, emergency_stop };

/// Operator tools and the coordinator to all.
struct TestControl {
  ControlVerb verb = ControlVerb::stop;
  Incarnation sender = 0;
  Role sender_role = Role::operator_tool;
  StopReason reason = StopReason::none;  // with stop and emergency_stop
  bool operator==(const TestControl&) const = default;
};

enum class Severity : std::uint8_t { information, warning, fault };

/// An event, for users and for the recording. The text is made from the code by
/// describe(), so that a control loop can raise events without formatting.
struct Event {
  ParticipantId source;
  Incarnation incarnation = 0;
  Severity severity = Severity::information;
  EventCode code = EventCode::none;
  Step step = kNoStep;
  double model_time_s = 0.0;       // [s]
  ParticipantId subject;           // who or what it is about; may be empty
  std::array<double, 2> values{};  // meaning and unit by code, see describe()
  Duration clock{};                // [ns] sender's clock
  bool operator==(const Event&) const = default;
};

/// One signal of a live view, over the points of its block. Each point stands for the rows since the point before, so
/// that no peak is lost.
struct LiveSignal {
  FixedText<48> name;      // of the quantity, see live_signals.hpp
  FixedText<128> subject;  // degree of freedom or substructure that it belongs to; may be empty
  FixedText<16> unit;
  double limit = std::numeric_limits<double>::quiet_NaN();  // [unit] magnitude, of its interlock; NaN without one
  std::vector<double> least{};                              // [unit] one entry per point
  std::vector<double> most{};                               // [unit] likewise
  std::vector<double> last{};                               // [unit] of the newest row; NaN where there is no value
  bool operator==(const LiveSignal&) const = default;
};

/// A participant to live views; best effort. It is made from recorded rows by the thread that writes them to the file,
/// and not on the path of a step.
struct SignalBlock {
  ParticipantId participant;
  Incarnation incarnation = 0;
  FixedText<32> group;
  std::uint16_t part = 0;              // a group of many signals travels in several blocks
  std::uint64_t sequence = 0;          // counts the blocks of one part
  std::vector<double> model_time_s{};  // [s] of the newest row of each point
  std::vector<LiveSignal> signals{};   // at most kMaxLiveSignals
  bool operator==(const SignalBlock&) const = default;
};

}  // namespace hybridtest
