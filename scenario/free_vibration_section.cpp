#include "scenario/free_vibration_section.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "mechanics/structure/static_deflection.hpp"
#include "scenario/structure_section.hpp"

namespace hybridtest {

using config::Section;

FreeVibration read_free_vibration(Section section, const DofTable& dofs, const TestSteps& test) {
  FreeVibration start;
  const auto size = static_cast<Eigen::Index>(dofs.size());
  start.initial = {Eigen::VectorXd::Zero(size), Eigen::VectorXd::Zero(size)};
  const auto displacement = section.optional_section("displacement_m");
  const auto velocity = section.optional_section("velocity_m_per_s");
  if (!displacement && !velocity) section.error("", "expected displacement_m, velocity_m_per_s, or both");
  if (displacement) {
    start.initial.displacement_m = values_by_dof(*displacement, dofs);
    for (const std::string& key : displacement->keys()) {
      if (const std::optional<int> row = dofs.find(key)) start.given.push_back(*row);
    }
  }
  if (section.has_optional("others")) start.others_follow = section.choice("others", {"at_zero", "follow"}) == 1;
  if (velocity) start.initial.velocity_m_per_s = values_by_dof(*velocity, dofs);
  const auto steps_of = [&](const char* key) {
    const double duration_s = section.number(key, {.low = 0.0, .high = 3600.0}, 0.0);
    const auto steps = static_cast<Step>(std::llround(duration_s / test.step_s));
    if (duration_s > 0.0 && steps == 0) section.error(key, "shorter than a step; expected 0 or at least one step");
    return steps;
  };
  start.steps.ramp = steps_of("ramp_s");
  start.steps.hold = steps_of("hold_s");
  if (start.steps.hold > 0 && !start.initial.velocity_m_per_s.isZero(0.0)) {
    section.error("hold_s", "a structure that is held has no velocity; remove hold_s or velocity_m_per_s");
  }
  if (start.steps.hold > 0 && start.steps.ramp == 0) {
    section.error("hold_s",
                  "nothing is held before the test without ramp_s, the time in which the structure gets there");
  }
  if (start.steps.ramp + start.steps.hold >= test.last_step) {
    section.error("ramp_s",
                  "the test ends before the structure is released; expected ramp_s and hold_s together below "
                  "time.duration_s");
    start.steps = {};
  }
  section.finish();
  return start;
}

void let_others_follow(FreeVibration& start, const Eigen::SparseMatrix<double>& initial_stiffness_n_per_m) {
  if (!start.others_follow || start.given.empty()) return;
  start.initial.displacement_m =
      static_deflection(initial_stiffness_n_per_m, start.given, start.initial.displacement_m);
}

void check_initial_ramp(Section excitation, const FreeVibration& start, const TestSteps& test, const std::string& site,
                        const InterfaceMap& interface, double limit_m, double limit_m_per_s, double time_scale) {
  if (interface.structure_size() != start.initial.displacement_m.size()) return;  // reported
  Section section = excitation.section("free_vibration");
  const Eigen::MatrixXd at_interface = interface.matrix();
  const Eigen::VectorXd displacement_m = at_interface * start.initial.displacement_m;
  const Eigen::VectorXd velocity_m_per_s = at_interface * start.initial.velocity_m_per_s;
  if (displacement_m.isZero(0.0) && velocity_m_per_s.isZero(0.0)) return;
  if (start.steps.ramp == 0) {
    section.error("",
                  "the specimen of '" + site +
                      "' must be brought to its initial displacement before the test; expected ramp_s, the time that "
                      "this takes, such as 5.0");
    return;
  }
  const double ramp_s = static_cast<double>(start.steps.ramp) * test.step_s;
  double farthest_m = 0.0;
  double fastest_m_per_s = 0.0;
  constexpr int kPlaces = 200;
  for (int place = 0; place <= kPlaces; ++place) {
    const InitialRampPoint point = initial_ramp_point(static_cast<double>(place) / kPlaces, ramp_s);
    const Eigen::VectorXd path = point.displacement[0] * displacement_m + point.displacement[1] * velocity_m_per_s;
    const Eigen::VectorXd speed = point.velocity[0] * displacement_m + point.velocity[1] * velocity_m_per_s;
    farthest_m = std::max(farthest_m, path.cwiseAbs().maxCoeff());
    fastest_m_per_s = std::max(fastest_m_per_s, speed.cwiseAbs().maxCoeff() / time_scale);
  }
  if (farthest_m > limit_m) {
    section.error("", fmt::format("'{}' would get a command of {:.6g} m before the release, but its limit is {:.6g} m; "
                                  "expected smaller initial displacements, or velocities with a shorter ramp_s",
                                  site, farthest_m, limit_m));
  }
  if (fastest_m_per_s > limit_m_per_s) {
    section.error("ramp_s", fmt::format("'{}' would be pulled at {:.6g} m/s, but its limit is {:.6g} m/s; expected a "
                                        "longer ramp_s or smaller initial velocities",
                                        site, fastest_m_per_s, limit_m_per_s));
  }
}

std::unique_ptr<Integrator> begun_integrator(const IntegratorReading& integrator,
                                             const std::optional<FreeVibration>& start,
                                             const LinearStructure& structure, double step_s) {
  if (!start) return integrator.make(structure, step_s, {});
  auto method = integrator.make(structure, step_s, start->initial);
  if (start->steps.ramp == 0) return method;
  return std::make_unique<InitialRamp>(std::move(method), start->initial, step_s, start->steps);
}

}  // namespace hybridtest
