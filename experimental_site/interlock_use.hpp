#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>

#include "core/records.hpp"
#include "experimental_site/interlocks.hpp"

namespace hybridtest {

/// Unit of what the interlock compares; empty for a ratio.
[[nodiscard]] std::string_view unit_of(InterlockKind kind) noexcept;

/// How near the interlocks of a site were to their limits, read from the rows of its table `control`: for live views
/// and reports, after the fact. The rows are given in order.
class InterlockUse {
 public:
  /// @param control   layout of the rows. Interlocks whose columns it lacks, as in older recordings, have no level.
  InterlockUse(const SiteLimits& limits, const TableLayout& control);

  /// @param row   one value per column.
  void read(std::span<const double> row);
  /// At the row read last, see level_of().
  [[nodiscard]] std::optional<InterlockLevel> level(InterlockKind kind) const;

 private:
  /// Columns of one quantity, one per interface degree of freedom.
  using Columns = std::array<std::size_t, kMaxSiteDofs>;

  void read(std::span<const double> row, const Columns& columns, SiteVector& values) const;

  SiteLimits limits_;
  Eigen::Index dofs_ = 0;
  Columns target_{};
  Columns measured_{};
  Columns force_{};
  Columns velocity_{};
  std::optional<std::size_t> lag_sine_;
  std::optional<std::size_t> energy_ratio_;
  std::optional<std::size_t> command_age_;
  std::optional<std::size_t> follows_;
  bool has_velocity_ = false;

  SiteVector target_m_;
  SiteVector velocity_m_per_s_;
  SiteVector measured_m_;
  SiteVector force_n_;
  SiteVector measured_before_m_;
  SiteVector force_before_n_;
  double energy_error_ratio_ = 0.0;
  double tracking_lag_sine_ = 0.0;
  double command_age_s_ = 0.0;
  bool is_following_ = false;
};

}  // namespace hybridtest
