#include "coordinator/force_bridge.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "core/assert.hpp"

namespace hybridtest {
namespace {

/// Measured steps kept beside the longest gap: those of the polynomial of highest order, and the one that closes it.
constexpr std::size_t kBesideGap = 5;

constexpr std::size_t kPointsMost = 4;

}  // namespace

ForceBridge::ForceBridge(const BridgingSettings& settings, Eigen::MatrixXd stiffness_n_per_m, Eigen::Index dofs)
    : settings_{settings},
      stiffness_n_per_m_{std::move(stiffness_n_per_m)},
      entries_(static_cast<std::size_t>(settings.most_in_a_row) + 1 + kBesideGap),
      force_n_{InterfaceVector::Zero(dofs)},
      difference_{InterfaceVector::Zero(dofs)} {
  HYBRIDTEST_ASSERT(settings.order >= 1 && settings.order < static_cast<int>(kPointsMost));
  for (Entry& entry : entries_) {
    entry.displacement_m = entry.force_n = entry.measured_n = InterfaceVector::Zero(dofs);
  }
  closed_.reserve(entries_.size());
}

ForceBridge::Entry& ForceBridge::append(Step step, const InterfaceVector& displacement_m) noexcept {
  Entry& entry = entries_[next_];
  next_ = (next_ + 1) % entries_.size();
  ++count_;
  entry.step = step;
  entry.displacement_m = displacement_m;
  return entry;
}

void ForceBridge::take(Step step, const InterfaceVector& displacement_m, const InterfaceVector& force_n) noexcept {
  Entry& entry = append(step, displacement_m);
  entry.force_n = entry.measured_n = force_n;
  entry.is_measured = true;
  entry.is_bridged = false;
}

const InterfaceVector& ForceBridge::bridge(Step step, const InterfaceVector& displacement_m) noexcept {
  extrapolate(step);
  if (settings_.type == BridgeType::initial_stiffness) {
    std::size_t n = 0;
    while (n + 1 < kept() && !newest(n).is_measured) ++n;
    difference_ = displacement_m - newest(n).displacement_m;
    force_n_.noalias() += stiffness_n_per_m_ * difference_;
  }
  Entry& entry = append(step, displacement_m);
  entry.force_n = force_n_;
  entry.is_measured = false;
  entry.is_bridged = true;
  open_ = std::min(open_ + 1, entries_.size());
  return force_n_;
}

/// Lagrange's polynomial through the newest measured forces.
void ForceBridge::extrapolate(Step step) noexcept {
  const std::size_t wanted =
      settings_.type == BridgeType::polynomial ? static_cast<std::size_t>(settings_.order) + 1 : std::size_t{1};
  std::array<const Entry*, kPointsMost> points{};
  std::size_t found = 0;
  for (std::size_t n = 0; n < kept() && found < wanted; ++n) {
    if (newest(n).is_measured) points[found++] = &newest(n);
  }
  force_n_.setZero();
  for (std::size_t i = 0; i < found; ++i) {
    double weight = 1.0;
    for (std::size_t j = 0; j < found; ++j) {
      if (j == i) continue;
      weight *= static_cast<double>(step - points[j]->step) / static_cast<double>(points[i]->step - points[j]->step);
    }
    force_n_ += weight * points[i]->measured_n;
  }
}

void ForceBridge::take_late(Step step, const InterfaceVector& force_n) noexcept {
  for (std::size_t n = 0; n < kept(); ++n) {
    Entry& entry = newest(n);
    if (entry.step != step || entry.is_measured || force_n.size() != entry.force_n.size() || !force_n.allFinite()) {
      continue;
    }
    entry.measured_n = force_n;
    entry.is_measured = true;
  }
}

std::span<const BridgedStep> ForceBridge::closed(bool ends) noexcept {
  closed_.clear();
  if (open_ == 0) return {};
  const bool has_measured_end = !newest(0).is_bridged;
  if (!has_measured_end && !ends) return {};
  // The gap is at `last` to `first`, counted from the newest step; a measured step is before it, unless it was
  // forgotten.
  const std::size_t last = has_measured_end ? 1 : 0;
  const std::size_t first = std::min(last + open_ - 1, kept() - 1);
  for (std::size_t n = first + 1; n-- > last;) {
    // The nearest measured forces on both sides, late ones included.
    std::size_t before = n;
    while (before < kept() && !newest(before).is_measured) ++before;
    std::size_t after = n;
    while (after > 0 && !newest(after).is_measured) --after;
    const bool came_late = newest(n).is_measured;
    const bool is_known = n > 0 && n + 1 < kept() && before < kept() && newest(after).is_measured;
    closed_.push_back(
        {.step = newest(n).step,
         .in_a_row = static_cast<int>(first - n + 1),
         .energy_added_j = is_known ? energy_of(n, before, after) : std::numeric_limits<double>::quiet_NaN(),
         .came_late = came_late});
  }
  open_ = 0;
  return closed_;
}

/// The restoring force takes energy from the structure, so one that is too small leaves it there. The motion around a
/// step is half of what the structure moves from the step before to the one behind (trapezoidal rule).
double ForceBridge::energy_of(std::size_t n, std::size_t before, std::size_t after) noexcept {
  const Entry& bridged = newest(n);
  const double span = static_cast<double>(newest(after).step - newest(before).step);
  const double share = span > 0.0 ? static_cast<double>(bridged.step - newest(before).step) / span : 0.0;
  difference_ = (1.0 - share) * newest(before).measured_n + share * newest(after).measured_n - bridged.force_n;
  return 0.5 * difference_.dot(newest(n - 1).displacement_m - newest(n + 1).displacement_m);
}

}  // namespace hybridtest
