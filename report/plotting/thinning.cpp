#include "report/plotting/thinning.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/assert.hpp"

namespace hybridtest::plot {
namespace {

/// Half a pixel of a figure that is 500 pixels wide.
constexpr double kFirstDistance = 1e-3;
constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();

}  // namespace

HistoryThinner::HistoryThinner(double low, double high, std::size_t columns)
    : low_{low},
      columns_per_x_{high > low ? static_cast<double>(columns) / (high - low) : 0.0},
      last_column_{static_cast<double>(columns) - 1.0} {
  HYBRIDTEST_ASSERT(columns >= 1);
}

void HistoryThinner::add(double x, double y) {
  if (!std::isfinite(x) || !std::isfinite(y)) {
    end_column();
    if (!kept_.x.empty() && std::isfinite(kept_.x.back())) keep({kNowhere, kNowhere});
    return;
  }
  const double column = std::clamp(std::floor((x - low_) * columns_per_x_), 0.0, last_column_);
  const Point point{x, y};
  if (column != column_) {
    end_column();
    if (kept_.x.empty()) keep(point);
    column_ = column;
    least_ = most_ = point;
    least_is_first_ = true;
  } else if (y < least_.y) {
    least_ = point;
    least_is_first_ = false;
  } else if (y > most_.y) {
    most_ = point;
    least_is_first_ = true;
  }
  last_ = point;
}

void HistoryThinner::keep(const Point& point) {
  if (!kept_.x.empty() && kept_.x.back() == point.x && kept_.y.back() == point.y) return;
  kept_.x.push_back(point.x);
  kept_.y.push_back(point.y);
}

void HistoryThinner::end_column() {
  if (column_ < 0.0) return;
  keep(least_is_first_ ? least_ : most_);
  keep(least_is_first_ ? most_ : least_);
  column_ = -1.0;
}

Points HistoryThinner::take() {
  const bool is_open = column_ >= 0.0;
  end_column();
  if (is_open) keep(last_);
  return std::exchange(kept_, {});
}

LoopThinner::LoopThinner(std::size_t most)
    : most_{most},
      distance_{kFirstDistance},
      x_low_{std::numeric_limits<double>::infinity()},
      x_high_{-x_low_},
      y_low_{x_low_},
      y_high_{-x_low_},
      last_x_{kNowhere},
      last_y_{kNowhere} {
  HYBRIDTEST_ASSERT(most >= 16);
}

bool LoopThinner::is_far(double x, double y) const noexcept {
  if (kept_.x.empty() || !std::isfinite(kept_.x.back())) return true;
  return std::abs(x - kept_.x.back()) > distance_ * (x_high_ - x_low_) ||
         std::abs(y - kept_.y.back()) > distance_ * (y_high_ - y_low_);
}

void LoopThinner::add(double x, double y) {
  last_x_ = x;
  last_y_ = y;
  if (!std::isfinite(x) || !std::isfinite(y)) {
    if (kept_.x.empty() || !std::isfinite(kept_.x.back())) return;
  } else {
    x_low_ = std::min(x_low_, x);
    x_high_ = std::max(x_high_, x);
    y_low_ = std::min(y_low_, y);
    y_high_ = std::max(y_high_, y);
    if (!is_far(x, y)) return;
  }
  kept_.x.push_back(std::isfinite(y) ? x : kNowhere);
  kept_.y.push_back(y);
  if (kept_.x.size() > most_) thin_again();
}

void LoopThinner::thin_again() {
  distance_ *= 2.0;
  const Points all = std::exchange(kept_, {});
  for (std::size_t i = 0; i < all.x.size(); ++i) {
    const bool is_gap = !std::isfinite(all.x[i]) || !std::isfinite(all.y[i]);
    if (is_gap ? !kept_.x.empty() && std::isfinite(kept_.x.back()) : is_far(all.x[i], all.y[i])) {
      kept_.x.push_back(is_gap ? kNowhere : all.x[i]);
      kept_.y.push_back(all.y[i]);
    }
  }
}

Points LoopThinner::take() {
  if (std::isfinite(last_x_) && std::isfinite(last_y_)) {
    kept_.x.push_back(last_x_);
    kept_.y.push_back(last_y_);
  }
  return std::exchange(kept_, {});
}

}  // namespace hybridtest::plot
