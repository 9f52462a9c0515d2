#include "tests/realtime/ring_coupling.hpp"

#include <cmath>
#include <numbers>
#include <utility>

#include "compensation/no_compensation.hpp"
#include "compensation/no_force_compensation.hpp"
#include "compensation/polynomial_displacement.hpp"
#include "coordinator/integrators/central_difference.hpp"
#include "mechanics/laws/bilinear.hpp"
#include "numerical_substructure/spring_network.hpp"
#include "plant/specimens/law_specimen.hpp"
#include "plant/transfer_systems/second_order.hpp"

namespace hybridtest {
namespace {

constexpr int kPeriodsPerStep = 2;
constexpr Duration kLease = std::chrono::seconds{10};  // longer than any stall of these tests
constexpr Bilinear::Parameters kStorey{.stiffness_n_per_m = 4.0e6, .yield_force_n = 40.0e3, .hardening_ratio = 0.05};

std::vector<std::unique_ptr<Law>> one_storey() {
  std::vector<std::unique_ptr<Law>> laws;
  laws.push_back(std::make_unique<Bilinear>(kStorey));
  return laws;
}

/// Two storeys, both of 20 t and 4 MN/m.
LinearStructure two_storeys() {
  LinearStructure structure;
  structure.degrees_of_freedom = {"floor_1", "floor_2"};
  structure.mass_kg = (20.0e3 * Eigen::Matrix2d::Identity()).sparseView();
  Eigen::Matrix2d stiffness;
  stiffness << 8.0e6, -4.0e6, -4.0e6, 4.0e6;
  structure.initial_stiffness_n_per_m = stiffness.sparseView();
  structure.damping_n_s_per_m = (1.0e-3 * stiffness).sparseView();
  structure.influence = Eigen::Vector2d::Ones();
  return structure;
}

CoordinatorSettings settings(CouplingMode mode, Step last_step) {
  CoordinatorSettings settings;
  settings.mode = mode;
  settings.step_s = RingCoupling::kStep_s;
  settings.duration_s = RingCoupling::kStep_s * static_cast<double>(last_step);
  settings.last_step = last_step;
  const Eigen::MatrixXd stiffness = Eigen::MatrixXd::Constant(1, 1, kStorey.stiffness_n_per_m);
  settings.substructures = {{"storey_1", Role::experimental_site, InterfaceMap{2, {{0}}}, stiffness},
                            {"storey_2", Role::numerical_substructure, InterfaceMap{2, {{1, 0}}}, stiffness}};
  settings.bridging = {
      .type = BridgeType::initial_stiffness, .deadline = kControlPeriod, .most_in_a_row = 20, .start_anyway = true};
  settings.recorded_dofs = {0, 1};
  GroundLoad ground{two_storeys().load_per_ground_acceleration_kg(), {}};
  for (Step step = 0; step <= last_step; ++step) {
    ground.acceleration_m_per_s2.push_back(
        2.0 * std::sin(3.0 * std::numbers::pi * RingCoupling::kStep_s * static_cast<double>(step)));
  }
  settings.load = AppliedLoad{{std::move(ground)}, {}};
  return settings;
}

std::size_t width(const TableLayout& layout) { return layout.columns.size(); }

}  // namespace

std::unique_ptr<SimulatedRig> noisy_rig(Duration control_period) {
  std::vector<std::unique_ptr<TransferSystem>> transfer_systems;
  transfer_systems.push_back(std::make_unique<SecondOrder>(
      SecondOrder::Parameters{
          .natural_frequency_hz = 15.0, .damping_ratio = 0.9, .delay = std::chrono::milliseconds{4}},
      control_period));
  auto rig = std::make_unique<SimulatedRig>(
      std::move(transfer_systems), std::make_unique<LawSpecimen>(one_storey()),
      SimulatedRig::SensorNoise{.displacement_noise_m = 1.0e-5, .force_noise_n = 50.0, .seed = 7, .first_stream = 0},
      control_period);
  rig->connect();
  return rig;
}

SiteCompensation compensation(bool compensates, Duration control_period) {
  SiteCompensation made;
  if (compensates) {
    made.commands.push_back(std::make_unique<PolynomialDisplacement>(3, std::chrono::milliseconds{23}, control_period));
  } else {
    made.commands.push_back(std::make_unique<NoCompensation>());
  }
  made.forces.push_back(std::make_unique<NoForceCompensation>());
  return made;
}

ControlLoopSettings wide_limits(CouplingMode mode, double command_age_s) {
  ControlLoopSettings settings;
  settings.mode = mode;
  settings.trajectory.keeps_time = mode == CouplingMode::real_time;
  settings.periods_per_step = kPeriodsPerStep;
  settings.step_s = RingCoupling::kStep_s;
  settings.limits.displacement_m = 0.5;
  settings.limits.velocity_m_per_s = 5.0;
  settings.limits.force_n = 1.0e6;
  settings.limits.tracking_error_m = 0.5;
  settings.limits.energy_error_ratio = 1.0e3;
  settings.limits.command_age_s = command_age_s;
  settings.return_time_s = 0.2;
  return settings;
}

RingCoupling::RingCoupling(CouplingMode mode, Step last_step, bool compensates, double command_age_s)
    : step_record_{width(Coordinator::steps_layout({"floor_1", "floor_2"}, 1, false)), kRows},
      exchange_record_{width(Coordinator::exchanges_layout()), kRows},
      bridge_record_{width(Coordinator::bridges_layout()), kRows},
      numerical_record_{width(NumericalNode::steps_layout({"floor_2"})), kRows},
      site_record_{width(SiteLink::steps_layout(1)), kRows},
      control_record_{width(ControlLoop::control_layout(1)), kRows},
      coordinator_presence_{Identity{"coordinator", Role::coordinator, 1, {}}, kLease, coordinator_statuses_,
                            from_coordinator_, events_},
      site_presence_{Identity{"storey_1", Role::experimental_site, 2, {}}, kLease, site_statuses_, from_site_, events_},
      numerical_presence_{Identity{"storey_2", Role::numerical_substructure, 3, {}}, kLease, numerical_statuses_,
                          from_numerical_, events_},
      rig_{noisy_rig(kControlPeriod)},
      loop_{std::make_unique<ControlLoop>(wide_limits(mode, command_age_s), *rig_,
                                          compensation(compensates, kControlPeriod),
                                          EnergyErrorMonitor{SiteMatrix::Constant(1, 1, 4.0e6), 0.01},
                                          ControlLoopPorts{requests_, reports_}, control_record_)},
      link_{std::make_unique<SiteLink>(
          SubstructureIndex{0}, 1, mode, site_presence_, MembershipPorts{site_announcements_, site_control_, kLease},
          SiteLinkPorts{site_commands_, measurements_, requests_, reports_}, site_record_)},
      numerical_{std::make_unique<NumericalNode>(
          SubstructureIndex{1}, mode, std::make_unique<SpringNetwork>(springs_to_ground(one_storey())),
          numerical_presence_, MembershipPorts{numerical_announcements_, numerical_control_, kLease},
          numerical_commands_, measurements_, numerical_record_, std::vector<Eigen::Index>{0})},
      coordinator_{std::make_unique<Coordinator>(
          settings(mode, last_step), std::make_unique<CentralDifference>(two_storeys(), kStep_s), coordinator_presence_,
          CoordinatorPorts{announcements_, coordinator_control_, control_, measurements_, commands_},
          CoordinatorRecord{step_record_, exchange_record_, &bridge_record_})} {}

void RingCoupling::advance_all_but_loop(Instant now) noexcept {
  static_cast<void>(coordinator_->advance(now));
  static_cast<void>(numerical_->advance(now));
  advance_link(now);
}

std::vector<double> RingCoupling::take_control_row() {
  std::vector<double> row(control_record_.row_width());
  if (control_record_.take(row) == 0) row.clear();
  return row;
}

void RingCoupling::advance(Duration passed) noexcept {
  now_ += passed;
  static_cast<void>(coordinator_->advance(now_));
  static_cast<void>(numerical_->advance(now_));
  static_cast<void>(SiteNode{*link_, *loop_}.advance(now_));
}

}  // namespace hybridtest
