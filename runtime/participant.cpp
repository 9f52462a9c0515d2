#include "runtime/participant.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "coordinator/opensees/generic_client_server.hpp"
#include "coordinator/opensees/opensees_lead.hpp"

namespace hybridtest {
namespace {

/// Capacity of the queues between link and loop: one target per step, and the few messages that begin
/// and end a test.
constexpr std::size_t kLoopQueue = 64;

CoordinatorSettings coordinator_settings(const Scenario& scenario) {
  CoordinatorSettings settings;
  settings.test_name = scenario.name;
  settings.mode = scenario.time.mode;
  settings.step_s = scenario.time.step_s;
  settings.duration_s = scenario.time.duration_s;
  settings.time_scale = scenario.time.time_scale;
  settings.last_step = scenario.time.last_step;
  settings.stop_on_recording_failure = scenario.stop_on_recording_failure;
  settings.discovery_timeout = scenario.timeouts.discovery;
  settings.arm_timeout = scenario.timeouts.arm;
  settings.stop_timeout = scenario.timeouts.stop;
  settings.stiffness_n_per_m = scenario.structure.stiffness_n_per_m;
  settings.recorded_dofs = scenario.recorded_dofs;
  settings.bridging = scenario.real_time.bridging;
  settings.load = scenario.excitation.load(scenario.structure);
  if (scenario.opensees) settings.last_step = std::numeric_limits<Step>::max();  // its model ends the test
  for (const SubstructureScenario& substructure : scenario.substructures) {
    settings.substructures.push_back(
        {substructure.id, substructure.role, substructure.interface, substructure.initial_stiffness_n_per_m});
  }
  return settings;
}

/// Of names of degrees of freedom.
std::vector<Eigen::Index> rows_of(const Scenario& scenario, const std::vector<std::string>& names) {
  std::vector<Eigen::Index> rows;
  for (const std::string& name : names) rows.push_back(std::ranges::find(scenario.dofs, name) - scenario.dofs.begin());
  return rows;
}

/// The elements of an OpenSees that leads, over sockets.
std::unique_ptr<ElementPort> serve_elements(const Scenario& scenario, Waker& waker) {
  std::vector<ServedElement> elements;
  for (const LedElementScenario& led : scenario.opensees->elements) {
    const SubstructureScenario& substructure = *scenario.find(led.substructure);
    const std::vector<Eigen::Index> rows = rows_of(scenario, led.dofs);
    const Eigen::MatrixXd stiffness = substructure.interface.on_structure(substructure.initial_stiffness_n_per_m);
    elements.push_back({led.port,
                        {.stiffness_n_per_m = stiffness(rows, rows),
                         .damping_n_s_per_m = led.damping_n_s_per_m.asDiagonal(),
                         .mass_kg = led.mass_kg.asDiagonal()}});
  }
  return std::make_unique<GenericClientServer>(scenario.opensees->listen_address, scenario.opensees->client_address,
                                               std::move(elements), [&waker] { waker.signal(); });
}

OpenSeesLeadSettings lead_settings(const Scenario& scenario) {
  OpenSeesLeadSettings settings;
  settings.structure_size = std::ssize(scenario.dofs);
  settings.allow_iterations = scenario.opensees->allow_iterations;
  settings.silence = scenario.opensees->silence;
  settings.can_revert = std::ranges::all_of(scenario.substructures, [](const SubstructureScenario& substructure) {
    return substructure.role == Role::numerical_substructure;
  });
  for (const LedElementScenario& led : scenario.opensees->elements) {
    const SubstructureScenario& substructure = *scenario.find(led.substructure);
    settings.elements.push_back(
        {scenario.index_of(substructure), substructure.id, rows_of(scenario, led.dofs), substructure.interface});
  }
  return settings;
}

[[nodiscard]] bool can_be_resumed(const Scenario& scenario) { return scenario.timeouts.resume > Duration::zero(); }

/// Answers that a substructure keeps for a coordinator that is resumed.
std::size_t remembered(const Scenario& scenario, const SubstructureScenario& substructure) {
  return can_be_resumed(scenario) ? AnswerMemory::answers_for(substructure.interface.size()) : 0;
}

/// Announcements that a substructure takes only when its end of the commands and measurements is connected: before it
/// is ready, that is. Packets of discovery that are lost are repeated after seconds, and each port is discovered by
/// itself.
class AnnouncementsOnceLinked final : public Inbox<TestAnnouncement> {
 public:
  AnnouncementsOnceLinked(Transport& transport, SubstructureIndex substructure)
      : transport_{transport}, substructure_{substructure}, announcements_{transport.announcement_inbox()} {}

  [[nodiscard]] bool take(TestAnnouncement& announcement) noexcept override {
    is_linked_ = is_linked_ || transport_.reachable(substructure_);
    return is_linked_ && announcements_->take(announcement);
  }

 private:
  Transport& transport_;
  SubstructureIndex substructure_;
  std::unique_ptr<Inbox<TestAnnouncement>> announcements_;
  bool is_linked_ = false;
};

/// Under simulated time nothing waits for a model: its calls block.
ModelSurroundings model_surroundings(const SubstructureScenario& substructure,
                                     const ParticipantSurroundings& surroundings) {
  if (surroundings.run_directory.empty()) return {};
  return {.log = surroundings.run_directory / (substructure.id + "_model.log"),
          .wake = [&waker = surroundings.transport.waker()] { waker.signal(); }};
}

}  // namespace

Participant::Participant(const Scenario& scenario, std::string_view id, Role role,
                         const ParticipantSurroundings& surroundings)
    : status_in_{surroundings.transport.status_inbox()},
      status_out_{surroundings.transport.status_outbox()},
      control_in_{surroundings.transport.control_inbox()},
      presence_{
          Identity{id, role, surroundings.incarnation, scenario.digest},
          scenario.timeouts.liveliness_lease,
          *status_in_,
          *status_out_,
          surroundings.events,
          std::max<std::size_t>(kMaxSubstructures, role == Role::coordinator ? scenario.substructures.size() : 0) +
              Presence::kOthers} {
  presence_.wait_for_links(scenario.timeouts.link);
}

CoordinatorParticipant::CoordinatorParticipant(const Scenario& scenario, const ParticipantSurroundings& surroundings)
    : Participant{scenario, kCoordinatorId, Role::coordinator, surroundings},
      announcements_{surroundings.transport.announcement_outbox()},
      control_out_{surroundings.transport.control_outbox()},
      measurements_{
          surroundings.transport.measurement_inbox(static_cast<std::uint16_t>(scenario.substructures.size()))},
      commands_{surroundings.transport.command_outbox(static_cast<std::uint16_t>(scenario.substructures.size()))} {
  std::unique_ptr<MotionSource> source;
  if (scenario.opensees) {
    elements_ = serve_elements(scenario, surroundings.transport.waker());
    source = std::make_unique<OpenSeesLead>(lead_settings(scenario), *elements_, surroundings.sink("opensees"));
  } else {
    source = scenario.make_integrator();
  }
  coordinator_ = std::make_unique<Coordinator>(
      coordinator_settings(scenario), std::move(source), presence_,
      CoordinatorPorts{*announcements_, *control_in_, *control_out_, *measurements_, *commands_,
                       [&transport = surroundings.transport](SubstructureIndex i) { return transport.reachable(i); }},
      CoordinatorRecord{surroundings.sink("steps"), surroundings.sink("exchanges"),
                        scenario.time.mode == CouplingMode::real_time ? &surroundings.sink("bridges") : nullptr,
                        &surroundings.sink("clocks"),
                        can_be_resumed(scenario) ? &surroundings.sink("answers") : nullptr});
}

std::vector<TableLayout> CoordinatorParticipant::tables(const Scenario& scenario) {
  std::vector<TableLayout> tables{
      Coordinator::steps_layout(scenario.recorded_names(), scenario.excitation.records.size(),
                                !scenario.excitation.forces.empty()),
      Coordinator::exchanges_layout(), ClockWindows::layout()};
  if (scenario.opensees) tables.push_back(OpenSeesLead::trials_layout());
  if (scenario.time.mode == CouplingMode::real_time) tables.push_back(Coordinator::bridges_layout());
  if (can_be_resumed(scenario)) tables.push_back(Coordinator::answers_layout());
  return tables;
}

NumericalParticipant::NumericalParticipant(const Scenario& scenario, const SubstructureScenario& substructure,
                                           const ParticipantSurroundings& surroundings)
    : Participant{scenario, substructure.id, Role::numerical_substructure, surroundings},
      announcements_{
          std::make_unique<AnnouncementsOnceLinked>(surroundings.transport, scenario.index_of(substructure))},
      commands_{surroundings.transport.command_inbox(scenario.index_of(substructure))},
      measurements_{surroundings.transport.measurement_outbox(scenario.index_of(substructure))} {
  std::unique_ptr<SubstructureModel> model = substructure.make_model();
  model->start(model_surroundings(substructure, surroundings));
  numerical_ =
      std::make_unique<NumericalNode>(scenario.index_of(substructure), scenario.time.mode, std::move(model), presence_,
                                      MembershipPorts{*announcements_, *control_in_, scenario.timeouts.discovery,
                                                      scenario.timeouts.resume, surroundings.is_restored},
                                      *commands_, *measurements_, surroundings.sink("steps"), substructure.recorded,
                                      remembered(scenario, substructure));
}

std::vector<TableLayout> NumericalParticipant::tables(const SubstructureScenario& substructure) {
  return {NumericalNode::steps_layout(substructure.recorded_names())};
}

SiteParticipant::SiteParticipant(const Scenario& scenario, const SubstructureScenario& substructure,
                                 const ParticipantSurroundings& surroundings, bool runs_loop)
    : Participant{scenario, substructure.id, Role::experimental_site, surroundings},
      announcements_{
          std::make_unique<AnnouncementsOnceLinked>(surroundings.transport, scenario.index_of(substructure))},
      commands_{surroundings.transport.command_inbox(scenario.index_of(substructure))},
      measurements_{surroundings.transport.measurement_outbox(scenario.index_of(substructure))},
      requests_{kLoopQueue},
      reports_{kLoopQueue},
      waking_reports_{reports_, runs_loop ? nullptr : &surroundings.transport.waker()} {
  const ControlLoopSettings settings = control_loop_settings(scenario, substructure);
  const double control_period_s = settings.step_s / settings.periods_per_step;
  rig_ = substructure.make_rig(control_period_s);
  if (!substructure.site.rig_tables.empty()) rig_->record_to(surroundings.sink);
  rig_->connect();
  // A motion below a twentieth of the displacement limit does not scale the energy error.
  EnergyErrorMonitor energy_error{substructure.initial_stiffness_n_per_m, 0.05 * settings.limits.displacement_m};
  loop_ = std::make_unique<ControlLoop>(settings, *rig_, substructure.make_compensation(control_period_s),
                                        std::move(energy_error), ControlLoopPorts{requests_, waking_reports_},
                                        surroundings.sink("control"));
  link_ = std::make_unique<SiteLink>(
      scenario.index_of(substructure), settings.dofs, scenario.time.mode, presence_,
      MembershipPorts{*announcements_, *control_in_, scenario.timeouts.discovery, scenario.timeouts.resume},
      SiteLinkPorts{*commands_, *measurements_, requests_, reports_}, surroundings.sink("steps"),
      remembered(scenario, substructure));
  if (runs_loop) node_.emplace(*link_, *loop_);
}

std::vector<TableLayout> SiteParticipant::tables(const SubstructureScenario& substructure) {
  const int dofs = static_cast<int>(substructure.interface.size());
  std::vector<TableLayout> tables{SiteLink::steps_layout(dofs), ControlLoop::control_layout(dofs)};
  tables.insert(tables.end(), substructure.site.rig_tables.begin(), substructure.site.rig_tables.end());
  return tables;
}

std::unique_ptr<Participant> make_substructure_participant(const Scenario& scenario,
                                                           const SubstructureScenario& substructure,
                                                           const ParticipantSurroundings& surroundings) {
  if (substructure.role == Role::numerical_substructure) {
    return std::make_unique<NumericalParticipant>(scenario, substructure, surroundings);
  }
  return std::make_unique<SiteParticipant>(scenario, substructure, surroundings, true);
}

std::vector<TableLayout> substructure_tables(const SubstructureScenario& substructure) {
  return substructure.role == Role::numerical_substructure ? NumericalParticipant::tables(substructure)
                                                           : SiteParticipant::tables(substructure);
}

}  // namespace hybridtest
