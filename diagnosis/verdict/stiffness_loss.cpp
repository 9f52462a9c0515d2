#include "diagnosis/verdict/stiffness_loss.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "diagnosis/signals/signals.hpp"
#include "diagnosis/tuning.hpp"

namespace hybridtest {

double lost_stiffness(Law& law, std::span<const Motion> motion) {
  std::vector<double> displacement_m(motion.size());
  std::ranges::transform(motion, displacement_m.begin(), &Motion::displacement_m);
  const double back_m = reversal_threshold_m(displacement_m);
  const std::vector<Reversal> reversals = reversals_of(displacement_m, back_m);
  double largest_m = 0.0;
  for (const Reversal& reversal : reversals) largest_m = std::max(largest_m, std::abs(reversal.displacement_m));
  const auto last = std::find_if(reversals.rbegin(), reversals.rend(), [&](const Reversal& reversal) {
    return std::abs(reversal.displacement_m) > tuning::kMainShare * largest_m;
  });
  law.reset();
  const double initial_n_per_m = law.initial_stiffness_n_per_m();
  if (last == reversals.rend() || !(initial_n_per_m > 0.0)) return 0.0;
  double force_n = 0.0;
  for (std::size_t i = 0; i <= last->sample; ++i) {
    force_n = law.trial(motion[i].displacement_m, motion[i].velocity_m_per_s);
    law.commit();
  }
  const double towards_zero_m = last->displacement_m > 0.0 ? -back_m : back_m;
  const double unloaded_n = law.trial(last->displacement_m + towards_zero_m, 0.0);
  law.revert();
  return std::max(0.0, 1.0 - (force_n - unloaded_n) / (-towards_zero_m * initial_n_per_m));
}

}  // namespace hybridtest
