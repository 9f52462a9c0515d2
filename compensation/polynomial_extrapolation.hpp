#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "compensation/polynomial_weights.hpp"
#include "core/parameters/parameter_archive.hpp"

namespace hybridtest {

/// What polynomial_displacement and polynomial_force are told.
struct PolynomialParameters {
  int order = 3;
  double delay_s = 0.020;
  double point_spacing_s = 0.0;

  void serialize(ParameterArchive& archive) {
    archive.optional("order", order, {kPolynomialOrders, "of the polynomial"});
    archive.required("delay_s", delay_s, {kZeroToOne, "to make up for", "", "0 to 1, at most 8 point spacings"});
    archive.optional("point_spacing_s", point_spacing_s,
                     {kNotNegative, "between the points the polynomial goes through; 0: the delay itself", "",
                      "0, or 1 to 10 000 control periods"});
  }
};

/// Evaluates the polynomial through the newest sample of a signal and those 1, 2, …, `order` point
/// spacings T ago, `delay` ahead of the newest:
///
///     y(t) = sum over j of w_j x(t - j T),   w_j = product over l != j of (s + l) / (l - j),   s = delay / T
///
/// Until `order` spacings have passed since the first sample, the order is what the history
/// allows, 0 (y = x) during the first spacing.
class PolynomialExtrapolation {
 public:
  static constexpr int kMaxSpacingsAhead = 8;

  /// @throws ConfigError for parameters outside their ranges.
  PolynomialExtrapolation(const PolynomialParameters& parameters, double control_period_s);

  /// Takes the newest sample and extrapolates from it.
  [[nodiscard]] double advance(double newest) noexcept;
  /// Forgets the samples and goes back to the delay of construction.
  void reset() noexcept;

  /// Values outside 0 to delay_s_max() are moved to the nearest, non-finite ones ignored. The
  /// spacing stays.
  void set_delay(double delay_s) noexcept;
  [[nodiscard]] double delay_s() const noexcept { return delay_s_; }
  [[nodiscard]] double delay_s_max() const noexcept { return kMaxSpacingsAhead * point_spacing_s_; }
  [[nodiscard]] double point_spacing_s() const noexcept { return point_spacing_s_; }
  /// Sum of |w_j| at full order: the most by which a bounded error of the samples can grow.
  [[nodiscard]] double noise_gain() const noexcept;

 private:
  int order_;
  double initial_delay_s_;
  double delay_s_ = 0.0;
  double point_spacing_s_ = 0.0;
  std::size_t periods_per_point_ = 1;
  std::array<PolynomialWeights, kMaxPolynomialOrder + 1> weights_{};  // one set for each order up to order_
  std::vector<double> samples_;                                       // ring of the last order * spacing + 1
  std::size_t newest_ = 0;
  std::size_t known_ = 0;  // samples since the first, as many as the ring holds
};

}  // namespace hybridtest
