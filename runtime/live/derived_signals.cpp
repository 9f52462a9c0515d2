#include "runtime/live/derived_signals.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "experimental_site/interlock_use.hpp"
#include "mechanics/structure/energy_balance.hpp"

namespace hybridtest {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
/// Of the weights behind an estimated delay, site time.
constexpr double kDelayFade_s = 2.0;
/// Motion that tells a delay: its root mean square velocity over the velocity limit of the site. Below it the noise of
/// the sensors decides.
constexpr double kDelayVelocityShare = 1e-3;

/// Signals that are columns.
class Columns final : public DerivedSignals {
 public:
  void add(const TableLayout& table, const std::string& column, SignalName name) {
    const auto position = table.position(column);
    if (!position) return;
    columns_.push_back(*position);
    names_.push_back(std::move(name));
  }
  void read(std::span<const double> row, std::span<double> values) override {
    for (std::size_t i = 0; i < columns_.size(); ++i) values[i] = row[columns_[i]];
  }

 private:
  std::vector<std::size_t> columns_;
};

class StructureSignals final : public DerivedSignals {
 public:
  StructureSignals(const Scenario& scenario, const TableLayout& steps) {
    const std::vector<std::string> dofs = scenario.recorded_names();
    for (std::size_t i = 0; i < dofs.size(); ++i) {
      columns_.add(steps, "displacement_" + dofs[i] + "_m", {"displacement", dofs[i], "m"});
    }
    add_drifts(scenario, steps);
    columns_.add(steps, "ground_acceleration_m_per_s2", {"ground_acceleration", "", "m/s2"});
    for (std::size_t k = 2; k <= scenario.excitation.records.size(); ++k) {
      const std::string number = std::to_string(k);
      columns_.add(steps, "ground_acceleration_" + number + "_m_per_s2", {"ground_acceleration", number, "m/s2"});
    }
    for (const std::string& dof : dofs) {
      columns_.add(steps, "velocity_" + dof + "_m_per_s", {"velocity", dof, "m/s"});
      columns_.add(steps, "restoring_force_" + dof + "_n", {"restoring_force", dof, "N"});
    }
    add_balance(scenario, steps);
    names_ = columns_.names();
    for (const Drift& drift : drifts_) names_.push_back(drift.name);
    if (!balance_) return;
    names_.push_back({"base_shear", "", "N"});
    for (const char* energy : {"kinetic", "damping", "restoring", "input"}) {
      names_.push_back({std::string{energy} + "_energy", "", "J"});
    }
    names_.push_back({"energy_balance_error", "", "J"});
  }

  void read(std::span<const double> row, std::span<double> values) override {
    columns_.read(row, values);
    std::size_t next = columns_.names().size();
    for (const Drift& drift : drifts_) {
      values[next++] = row[drift.dof] - (drift.relative_to ? row[*drift.relative_to] : 0.0);
    }
    if (!balance_) return;
    const auto fill = [&](const std::vector<std::size_t>& columns, Eigen::VectorXd& vector) {
      for (std::size_t i = 0; i < columns.size(); ++i) vector[static_cast<Eigen::Index>(i)] = row[columns[i]];
    };
    fill(displacements_, displacement_m_);
    fill(velocities_, velocity_m_per_s_);
    fill(restoring_forces_, restoring_n_);
    applied_n_.setZero();
    if (!applied_forces_.empty()) fill(applied_forces_, applied_n_);
    for (std::size_t k = 0; k < ground_.size(); ++k) applied_n_ += row[ground_[k]] * ground_load_kg_[k];
    balance_->add(displacement_m_, velocity_m_per_s_, restoring_n_, applied_n_);
    const StructureEnergy& energy = balance_->energy();
    values[next++] = influence_.dot(restoring_n_);
    for (const double energy_j :
         {energy.kinetic_j, energy.damping_j, energy.restoring_j, energy.input_j, energy.error_j()}) {
      values[next++] = energy_j;
    }
  }

 private:
  struct Drift {
    SignalName name;
    std::size_t dof = 0;  // columns
    std::optional<std::size_t> relative_to;
  };

  void add_drifts(const Scenario& scenario, const TableLayout& steps) {
    const auto column_of = [&](int dof) {
      return steps.position("displacement_" + scenario.dofs[static_cast<std::size_t>(dof)] + "_m");
    };
    for (const SubstructureScenario& substructure : scenario.substructures) {
      const std::vector<InterfaceDof>& dofs = substructure.interface.dofs();
      for (std::size_t k = 0; k < dofs.size(); ++k) {
        const auto dof = column_of(dofs[k].dof);
        if (!dof) continue;
        Drift drift{{"drift", substructure.id + " " + substructure.interface_names[k], "m"}, *dof, {}};
        if (dofs[k].relative_to != InterfaceDof::kGround) {
          drift.relative_to = column_of(dofs[k].relative_to);
          if (!drift.relative_to) continue;
        }
        drifts_.push_back(std::move(drift));
      }
    }
  }

  void add_balance(const Scenario& scenario, const TableLayout& steps) {
    if (scenario.opensees || scenario.recorded_dofs.size() != scenario.dofs.size()) return;
    const auto add = [&](std::vector<std::size_t>& columns, const std::string& name) {
      const auto found = steps.position(name);
      if (found) columns.push_back(*found);
    };
    for (const std::string& dof : scenario.dofs) {
      add(displacements_, "displacement_" + dof + "_m");
      add(velocities_, "velocity_" + dof + "_m_per_s");
      add(restoring_forces_, "restoring_force_" + dof + "_n");
      add(applied_forces_, "applied_force_" + dof + "_n");
    }
    const std::size_t size = scenario.dofs.size();
    if (displacements_.size() != size || velocities_.size() != size || restoring_forces_.size() != size) return;
    for (std::size_t k = 0; k < scenario.excitation.records.size(); ++k) {
      add(ground_,
          k == 0 ? "ground_acceleration_m_per_s2" : "ground_acceleration_" + std::to_string(k + 1) + "_m_per_s2");
      ground_load_kg_.emplace_back(-(scenario.structure.mass_kg * scenario.excitation.records[k].influence));
    }
    if (ground_.size() != ground_load_kg_.size()) return;
    influence_ = scenario.excitation.records.empty() ? scenario.structure.influence
                                                     : scenario.excitation.records.front().influence;
    balance_.emplace(scenario.structure.mass_kg, scenario.structure.damping_n_s_per_m);
    displacement_m_ = velocity_m_per_s_ = restoring_n_ = applied_n_ =
        Eigen::VectorXd::Zero(static_cast<Eigen::Index>(size));
  }

  Columns columns_;
  std::vector<Drift> drifts_;
  std::vector<std::size_t> displacements_, velocities_, restoring_forces_, applied_forces_, ground_;
  std::vector<Eigen::VectorXd> ground_load_kg_;
  Eigen::VectorXd influence_;
  std::optional<EnergyBalance> balance_;
  Eigen::VectorXd displacement_m_, velocity_m_per_s_, restoring_n_, applied_n_;
};

/// Least squares of tracking error over target velocity, with fading weights.
class FadingDelay {
 public:
  void add(double error_m, double velocity_m_per_s, double keep) noexcept {
    if (!std::isfinite(error_m) || !std::isfinite(velocity_m_per_s)) return;
    products_ = keep * products_ + error_m * velocity_m_per_s;
    squares_ = keep * squares_ + velocity_m_per_s * velocity_m_per_s;
    weights_ = keep * weights_ + 1.0;
  }
  /// @param least_m_per_s   root mean square velocity from which on there is a delay.
  [[nodiscard]] double delay_s(double least_m_per_s) const noexcept {
    return squares_ > weights_ * least_m_per_s * least_m_per_s ? products_ / squares_ : kNone;
  }

 private:
  double weights_ = 0.0;
  double products_ = 0.0;
  double squares_ = 0.0;
};

class SiteSignals final : public DerivedSignals {
 public:
  SiteSignals(const SubstructureScenario& substructure, const TableLayout& control)
      : least_velocity_m_per_s_{kDelayVelocityShare * substructure.site.loop.limits.velocity_m_per_s} {
    const std::vector<std::string>& dofs = substructure.interface_names;
    for (std::size_t k = 0; k < dofs.size(); ++k) {
      const std::string suffix = column_suffix(static_cast<int>(k) + 1, static_cast<int>(dofs.size()));
      Dof dof;
      const std::array<std::pair<std::size_t*, std::string>, 4> wanted{{{&dof.target, "target_displacement_m"},
                                                                        {&dof.command, "command_displacement_m"},
                                                                        {&dof.measured, "measured_displacement_m"},
                                                                        {&dof.force, "measured_force_n"}}};
      const bool is_there = std::ranges::all_of(wanted, [&](const auto& one) {
        const auto column = control.position(one.second + suffix);
        *one.first = column.value_or(0);
        return column.has_value();
      });
      if (!is_there) continue;
      dof.velocity = control.position("target_velocity_m_per_s" + suffix);
      dofs_.push_back(dof);
      for (const char* name : {"target_displacement", "command_displacement", "measured_displacement"}) {
        names_.push_back({name, dofs[k], "m"});
      }
      names_.push_back({"force", dofs[k], "N"});
      names_.push_back({"tracking_error", dofs[k], "m"});
      names_.push_back({"estimated_delay", dofs[k], "s"});
    }
    time_ = control.position("time_s");
    follows_ = control.position("follows_targets");
    others_.add(control, "energy_error_j", {"energy_error", "", "J"});
    others_.add(control, "tracking_lag_sine", {"tracking_lag_sine", "", ""});
    names_.insert(names_.end(), others_.names().begin(), others_.names().end());
  }

  void read(std::span<const double> row, std::span<double> values) override {
    const double time_s = time_ ? row[*time_] : kNone;
    const double keep = std::exp(-std::max(0.0, time_s - time_before_s_) / kDelayFade_s);
    time_before_s_ = time_s;
    const bool is_following = follows_ && row[*follows_] != 0.0;
    std::size_t next = 0;
    for (Dof& dof : dofs_) {
      const double error_m = row[dof.target] - row[dof.measured];
      if (dof.velocity && is_following) dof.delay.add(error_m, row[*dof.velocity], std::isfinite(keep) ? keep : 1.0);
      for (const double value : {row[dof.target], row[dof.command], row[dof.measured], row[dof.force], error_m,
                                 dof.delay.delay_s(least_velocity_m_per_s_)}) {
        values[next++] = value;
      }
    }
    others_.read(row, values.subspan(next));
  }

 private:
  struct Dof {
    std::size_t target = 0;  // columns
    std::size_t command = 0;
    std::size_t measured = 0;
    std::size_t force = 0;
    std::optional<std::size_t> velocity{};
    FadingDelay delay{};
  };

  double least_velocity_m_per_s_;
  std::vector<Dof> dofs_;
  std::optional<std::size_t> time_;
  std::optional<std::size_t> follows_;
  double time_before_s_ = kNone;
  Columns others_;
};

class InterlockSignals final : public DerivedSignals {
 public:
  InterlockSignals(const SubstructureScenario& substructure, const TableLayout& control)
      : use_{substructure.site.loop.limits, control} {
    const SiteLimits& limits = substructure.site.loop.limits;
    const std::array<std::pair<InterlockKind, std::optional<double>>, 9> all{
        {{InterlockKind::displacement, limits.displacement_m},
         {InterlockKind::velocity, limits.velocity_m_per_s},
         {InterlockKind::force, limits.force_n},
         {InterlockKind::tracking_error, limits.tracking_error_m},
         {InterlockKind::energy_error, limits.energy_error_ratio},
         {InterlockKind::tracking_indicator, limits.tracking_indicator},
         {InterlockKind::command_age, limits.command_age_s},
         {InterlockKind::displacement_step, limits.displacement_step_m},
         {InterlockKind::force_step, limits.force_step_n}}};
    for (const auto& [kind, limit] : all) {
      const bool acts = substructure.site.loop.rules[static_cast<std::size_t>(kind)].action != SafetyAction::none;
      if (!limit || !acts) continue;
      kinds_.push_back(kind);
      names_.push_back({std::string{name(kind)}, "", std::string{unit_of(kind)}, *limit});
    }
  }

  void read(std::span<const double> row, std::span<double> values) override {
    use_.read(row);
    for (std::size_t i = 0; i < kinds_.size(); ++i) {
      const auto level = use_.level(kinds_[i]);
      values[i] = level ? level->observed : kNone;
    }
  }

 private:
  InterlockUse use_;
  std::vector<InterlockKind> kinds_;
};

}  // namespace

std::unique_ptr<DerivedSignals> structure_signals(const Scenario& scenario, const TableLayout& steps) {
  return std::make_unique<StructureSignals>(scenario, steps);
}

std::unique_ptr<DerivedSignals> pace_signals(const TableLayout& steps) {
  auto signals = std::make_unique<Columns>();
  signals->add(steps, "step", {"step", "", ""});
  signals->add(steps, "wall_time_s", {"wall_time", "", "s"});
  return signals;
}

std::unique_ptr<DerivedSignals> site_signals(const SubstructureScenario& substructure, const TableLayout& control) {
  return std::make_unique<SiteSignals>(substructure, control);
}

std::unique_ptr<DerivedSignals> interlock_signals(const SubstructureScenario& substructure,
                                                  const TableLayout& control) {
  return std::make_unique<InterlockSignals>(substructure, control);
}

std::unique_ptr<DerivedSignals> numerical_signals(const SubstructureScenario& substructure, const TableLayout& steps) {
  auto signals = std::make_unique<Columns>();
  for (const std::string& dof : substructure.recorded_names()) {
    signals->add(steps, "displacement_" + dof + "_m", {"displacement", dof, "m"});
    signals->add(steps, "force_" + dof + "_n", {"force", dof, "N"});
  }
  return signals;
}

}  // namespace hybridtest
