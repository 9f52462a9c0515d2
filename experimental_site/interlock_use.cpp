#include "experimental_site/interlock_use.hpp"

#include <algorithm>
#include <string>

namespace hybridtest {
namespace {

/// The columns of a quantity: its name alone at a site with one interface degree of freedom, else with a number from 1.
/// @return how many there are.
Eigen::Index find_columns(const TableLayout& layout, const std::string& name,
                          std::array<std::size_t, kMaxSiteDofs>& columns) {
  if (const auto only = layout.position(name)) {
    columns[0] = *only;
    return 1;
  }
  Eigen::Index count = 0;
  while (count < kMaxSiteDofs) {
    const auto next = layout.position(name + "_" + std::to_string(count + 1));
    if (!next) break;
    columns[static_cast<std::size_t>(count++)] = *next;
  }
  return count;
}

}  // namespace

std::string_view unit_of(InterlockKind kind) noexcept {
  switch (kind) {
    case InterlockKind::displacement:
    case InterlockKind::tracking_error:
    case InterlockKind::displacement_step: return "m";
    case InterlockKind::force:
    case InterlockKind::force_step: return "N";
    case InterlockKind::velocity: return "m/s";
    case InterlockKind::command_age: return "s";
    default: return "";
  }
}

InterlockUse::InterlockUse(const SiteLimits& limits, const TableLayout& control)
    : limits_{limits},
      lag_sine_{control.position("tracking_lag_sine")},
      energy_ratio_{control.position("energy_error_ratio")},
      command_age_{control.position("command_age_s")},
      follows_{control.position("follows_targets")} {
  dofs_ = std::min({find_columns(control, "target_displacement_m", target_),
                    find_columns(control, "measured_displacement_m", measured_),
                    find_columns(control, "measured_force_n", force_)});
  has_velocity_ = find_columns(control, "target_velocity_m_per_s", velocity_) >= dofs_;
  velocity_m_per_s_ = SiteVector::Zero(dofs_);
}

void InterlockUse::read(std::span<const double> row, const Columns& columns, SiteVector& values) const {
  values.resize(dofs_);
  for (Eigen::Index k = 0; k < dofs_; ++k) values[k] = row[columns[static_cast<std::size_t>(k)]];
}

void InterlockUse::read(std::span<const double> row) {
  const auto value = [&](const std::optional<std::size_t>& column) { return column ? row[*column] : 0.0; };
  measured_before_m_ = measured_m_;
  force_before_n_ = force_n_;
  read(row, target_, target_m_);
  read(row, measured_, measured_m_);
  read(row, force_, force_n_);
  if (has_velocity_) read(row, velocity_, velocity_m_per_s_);
  energy_error_ratio_ = value(energy_ratio_);
  tracking_lag_sine_ = value(lag_sine_);
  command_age_s_ = value(command_age_);
  is_following_ = value(follows_) != 0.0;
}

std::optional<InterlockLevel> InterlockUse::level(InterlockKind kind) const {
  if (dofs_ == 0 || measured_m_.size() == 0) return {};
  if (kind == InterlockKind::velocity && !has_velocity_) return {};
  if (kind == InterlockKind::energy_error && !energy_ratio_) return {};
  if (kind == InterlockKind::command_age && !command_age_) return {};
  const InterlockInput input{.phase = is_following_ ? SitePhase::running : SitePhase::resting,
                             .target_displacement_m = target_m_,
                             .target_velocity_m_per_s = velocity_m_per_s_,
                             .command_displacement_m = target_m_,
                             .measured_displacement_m = measured_m_,
                             .force_n = force_n_,
                             .energy_error_ratio = energy_error_ratio_,
                             .tracking_lag_sine = tracking_lag_sine_,
                             .command_age_s = command_age_s_,
                             .expects_commands = is_following_,
                             .is_new_sample = true};
  return level_of(kind, limits_, input, measured_before_m_, force_before_n_);
}

}  // namespace hybridtest
