#pragma once

#include <vector>

namespace hybridtest {

/// The solution of dw/ds = 1 - c |w|^n from w = 0 on, for w from 0 to 1: how z of a BoucWen law grows along a path that
/// begins at zero. Tabulated by the classical Runge-Kutta method; between the nodes Hermite's cubic, with the slopes
/// that the equation gives (Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, 1993, section II.6).
/// Along any path w is looked up, however long or short the path is.
class BoucWenTable {
 public:
  /// @param exponent   n, at least 1. @param loading   c, at most 1; with 1, w never reaches 1.
  BoucWenTable(double exponent, double loading);

  /// w after this path, not negative; beyond the table the last one.
  [[nodiscard]] double at(double path) const noexcept;
  /// The path to w, from 0 to 1; to the end of the table for a w that is reached in the limit only.
  [[nodiscard]] double path_to(double w) const noexcept;

 private:
  struct Node {
    double path = 0.0;
    double w = 0.0;
    double slope = 1.0;
  };

  [[nodiscard]] double slope(double w) const noexcept;
  /// Of Hermite's cubic from a node to the next one, at this share of the path between them.
  [[nodiscard]] static double between(const Node& from, const Node& to, double share) noexcept;

  double exponent_;
  double loading_;
  std::vector<Node> nodes_;
};

}  // namespace hybridtest
