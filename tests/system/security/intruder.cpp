#include "tests/system/security/intruder.hpp"

#include <chrono>
#include <optional>

#include "transport/fast_dds/ports.hpp"

namespace hybridtest {

using fast_dds::DdsInbox;
using fast_dds::DdsOutbox;

constexpr std::uint64_t kRoundsBeforeMove = 20;

/// A writer that Fast DDS made where its credentials permit it, and that moves to another partition later.
class MovingWriter {
 public:
  MovingWriter(const fast_dds::FastDdsSettings& settings, const std::string& permitted)
      : participant_{settings}, writer_{participant_.create_writer<ForceMeasurement>(permitted, nullptr)} {}

  void move(const std::string& partition) {
    auto* publisher = const_cast<fast_dds::dds::Publisher*>(writer_->get_publisher());
    fast_dds::dds::PublisherQos qos = publisher->get_qos();
    qos.partition().clear();
    qos.partition().push_back(partition.c_str());
    has_moved_ = publisher->set_qos(qos) == fast_dds::kReturnOk;
  }
  [[nodiscard]] bool has_moved() const noexcept { return has_moved_; }

  void send(const ForceMeasurement& message) {
    fast_dds::encode(message, sample_);
    writer_->write(&sample_, fast_dds::dds::HANDLE_NIL);
  }

 private:
  fast_dds::Participant participant_;
  fast_dds::dds::DataWriter* writer_;
  fast_dds::Topic<ForceMeasurement>::Sample sample_;
  bool has_moved_ = false;
};

struct Intruder::Ports {
  Ports(const fast_dds::FastDdsSettings& settings, const fast_dds::FastDdsSettings& ears_settings,
        const std::string& test_name, IntruderMeans means)
      : participant{settings}, ears{ears_settings}, statuses{ears, test_name}, victims_partition{test_name + "/1"} {
    if (means.stops) control.emplace(participant, test_name);
    if (means.commands) commands.emplace(participant, test_name + "/0");
    if (!means.forges_storey_2) return;
    steps.emplace(participant, test_name + "/0");
    own_forces.emplace(participant, test_name + "/0");
    moving_forces.emplace(settings, test_name + "/0");
  }

  fast_dds::Participant participant;
  fast_dds::Participant ears;
  DdsInbox<ParticipantStatus> statuses;
  std::optional<DdsInbox<DisplacementCommand>> steps;
  std::optional<DdsOutbox<TestControl>> control;
  std::optional<DdsOutbox<DisplacementCommand>> commands;
  std::optional<DdsOutbox<ForceMeasurement>> own_forces;
  std::optional<MovingWriter> moving_forces;
  std::string victims_partition;
};

Intruder::Intruder(const fast_dds::FastDdsSettings& settings, const fast_dds::FastDdsSettings& ears,
                   const std::string& test_name, IntruderMeans means)
    : ports_{std::make_unique<Ports>(settings, ears, test_name, means)}, thread_{[this] { intrude(); }} {}

Intruder::~Intruder() {
  ends_ = true;
  thread_.join();
}

bool Intruder::has_moved() const noexcept { return has_moved_; }

void Intruder::intrude() {
  TestControl stop;
  stop.verb = ControlVerb::emergency_stop;
  stop.sender = 1;
  stop.sender_role = Role::operator_tool;
  stop.reason = StopReason::emergency_stop;
  DisplacementCommand command;
  command.points[0].displacement_m = InterfaceVector::Constant(1, 0.1);
  command.points[0].velocity_m_per_s = InterfaceVector::Zero(1);
  command.points[0].acceleration_m_per_s2 = InterfaceVector::Zero(1);
  ForceMeasurement force;
  force.substructure = 1;
  force.imposed_displacement_m = InterfaceVector::Zero(1);
  force.measured_displacement_m = InterfaceVector::Zero(1);
  force.force_n = InterfaceVector::Constant(1, 5.0e4);
  while (!ends_) {
    ParticipantStatus status;
    while (ports_->statuses.take(status)) {
      if (status.state == LifecycleState::lost) continue;
      ++heard_;
      if (status.role == Role::coordinator) command.coordinator = status.incarnation;
      if (status.role == Role::numerical_substructure) force.sender = status.incarnation;
    }
    if (ports_->control) ports_->control->send(stop);
    if (ports_->commands) {
      command.points[0].step = command.points[0].step + 1;
      ports_->commands->send(command);
    }
    DisplacementCommand seen;
    while (ports_->steps && ports_->steps->take(seen)) force.step = seen.newest().step;
    if (ports_->moving_forces) {
      if (attempts_ == kRoundsBeforeMove) {
        ports_->moving_forces->move(ports_->victims_partition);
        has_moved_ = ports_->moving_forces->has_moved();
      }
      for (int ahead = 0; ahead < 3; ++ahead) {
        ports_->own_forces->send(force);
        ports_->moving_forces->send(force);
        ++force.step;
      }
      force.step -= 3;
    }
    ++attempts_;
    std::this_thread::sleep_for(std::chrono::milliseconds{1});
  }
}

}  // namespace hybridtest
