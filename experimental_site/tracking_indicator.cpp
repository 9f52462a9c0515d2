#include "experimental_site/tracking_indicator.hpp"

#include <cmath>

#include "core/message_copies.hpp"

namespace hybridtest {

TrackingIndicator::TrackingIndicator(int dofs, double period_s, double window_s, double displacement_m_min) noexcept
    : kept_{std::exp(-period_s / window_s)},
      square_m2_min_{displacement_m_min * displacement_m_min},
      change_square_m2_min_{square_m2_min_ * (period_s / window_s) * (period_s / window_s)},
      wanted_m_{SiteVector::Zero(dofs)},
      measured_m_{wanted_m_},
      mean_growth_m2_{wanted_m_},
      mean_square_m2_{wanted_m_},
      mean_change_square_m2_{wanted_m_} {}

void TrackingIndicator::sample(const SiteVector& wanted_m, const SiteVector& measured_m) noexcept {
  if (has_sample_) {
    const auto into = [this](SiteVector& mean, Eigen::Index k, double value) {
      mean[k] = kept_ * mean[k] + (1.0 - kept_) * value;
    };
    for (Eigen::Index k = 0; k < wanted_m.size(); ++k) {
      const double change_m = wanted_m[k] - wanted_m_[k];
      into(mean_growth_m2_, k, 0.5 * (wanted_m_[k] * measured_m[k] - wanted_m[k] * measured_m_[k]));
      into(mean_square_m2_, k, wanted_m[k] * wanted_m[k]);
      into(mean_change_square_m2_, k, change_m * change_m);
    }
    lag_sine_ = largest_lag_sine();
  }
  has_sample_ = true;
  copy_values(wanted_m, wanted_m_);
  copy_values(measured_m, measured_m_);
}

double TrackingIndicator::largest_lag_sine() const noexcept {
  double largest = 0.0;
  for (Eigen::Index k = 0; k < mean_growth_m2_.size(); ++k) {
    const double scale_m2 =
        std::sqrt((mean_square_m2_[k] + square_m2_min_) * (mean_change_square_m2_[k] + change_square_m2_min_));
    const double lag_sine = scale_m2 > 0.0 ? mean_growth_m2_[k] / scale_m2 : 0.0;
    if (std::fabs(lag_sine) > std::fabs(largest)) largest = lag_sine;
  }
  return largest;
}

}  // namespace hybridtest
