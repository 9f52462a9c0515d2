#include "mechanics/laws/bouc_wen_table.hpp"

#include <algorithm>
#include <cmath>

#include "mechanics/laws/power.hpp"
#include "mechanics/laws/runge_kutta.hpp"

namespace hybridtest {

namespace {

/// Of the length over which the slope changes.
constexpr double kNodesPerLength = 24.0;
/// From zero on, where |w|^n may have no third derivative, the distance of nodes grows with w.
constexpr double kFirstStep = 1.0 / 4096.0;
constexpr double kStepGrowth = 0.3;
/// So near to its limit w is there.
constexpr double kNearLimit = 1e-12;
constexpr std::size_t kNodesMax = std::size_t{1} << 16U;

}  // namespace

BoucWenTable::BoucWenTable(double exponent, double loading) : exponent_{exponent}, loading_{loading}, nodes_{Node{}} {
  while (nodes_.back().w < 1.0 - (loading_ < 1.0 ? 0.0 : kNearLimit) && nodes_.size() < kNodesMax) {
    const Node& last = nodes_.back();
    const double largest = std::min(1.0, last.w + 1.0 / kNodesPerLength);
    const double change = exponent_ * std::abs(loading_) * power_of(largest, exponent_ - 1.0);
    const double step =
        std::min(1.0 / (kNodesPerLength * std::max(1.0, change)), std::max(kStepGrowth * last.w, kFirstStep));
    const double w = runge_kutta_step(last.w, step, [this](double at) { return slope(at); });
    if (!(w > last.w)) break;  // nearer than rounding tells
    nodes_.push_back({.path = last.path + step, .w = w, .slope = slope(w)});
  }
}

double BoucWenTable::slope(double w) const noexcept { return 1.0 - loading_ * power_of(w, exponent_); }

double BoucWenTable::between(const Node& from, const Node& to, double share) noexcept {
  const double length = to.path - from.path;
  const double rest = 1.0 - share;
  return rest * rest * ((1.0 + 2.0 * share) * from.w + share * length * from.slope) +
         share * share * ((1.0 + 2.0 * rest) * to.w - rest * length * to.slope);
}

double BoucWenTable::at(double path) const noexcept {
  if (path >= nodes_.back().path) return std::min(1.0, nodes_.back().w);
  const auto to = std::ranges::upper_bound(nodes_, path, {}, &Node::path);
  if (to == nodes_.begin()) return 0.0;
  const Node& from = *(to - 1);
  return std::min(1.0, between(from, *to, (path - from.path) / (to->path - from.path)));
}

double BoucWenTable::path_to(double w) const noexcept {
  if (w >= nodes_.back().w) return nodes_.back().path;
  const auto to = std::ranges::upper_bound(nodes_, w, {}, &Node::w);
  if (to == nodes_.begin()) return 0.0;
  const Node& from = *(to - 1);
  const double length = to->path - from.path;
  double share = (w - from.w) / (to->w - from.w);
  // The cubic is nearly straight: Newton's steps on it double the digits each time.
  constexpr int kStepsMax = 4;
  constexpr double kHalfTheDigits = 1e-8;
  double step = 1.0;
  for (int i = 0; i < kStepsMax && std::abs(step) > kHalfTheDigits; ++i) {
    const double rest = 1.0 - share;
    const double rate = 6.0 * share * rest * (to->w - from.w) +
                        length * (rest * (1.0 - 3.0 * share) * from.slope + share * (3.0 * share - 2.0) * to->slope);
    step = (w - between(from, *to, share)) / rate;
    share = std::clamp(share + step, 0.0, 1.0);
  }
  return from.path + share * length;
}

}  // namespace hybridtest
