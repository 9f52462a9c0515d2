#pragma once

#include <array>
#include <cstddef>

#include "core/parameters/range.hpp"

namespace hybridtest {

inline constexpr int kMaxPolynomialOrder = 4;
inline constexpr Range kPolynomialOrders{.low = 1.0, .high = kMaxPolynomialOrder};

using PolynomialWeights = std::array<double, kMaxPolynomialOrder + 1>;

/// Lagrange's weights w_j of the points at times 0, -1, …, -order for the value at time `ahead`:
/// w_j = product over l != j of (ahead + l) / (l - j). Those beyond `order` are zero.
/// @param order   0 to kMaxPolynomialOrder.
/// @param ahead   in spacings of the points.
[[nodiscard]] inline PolynomialWeights polynomial_weights(int order, double ahead) noexcept {
  PolynomialWeights weights{};
  for (int j = 0; j <= order; ++j) {
    double weight = 1.0;
    for (int l = 0; l <= order; ++l) {
      if (l != j) weight *= (ahead + l) / (l - j);
    }
    weights[static_cast<std::size_t>(j)] = weight;
  }
  return weights;
}

}  // namespace hybridtest
