#include "diagnosis/localisation/reversals.hpp"

#include <algorithm>
#include <cmath>

namespace hybridtest {
namespace {

constexpr double kThresholdShare = 0.02;

}  // namespace

std::vector<Reversal> reversals_of(std::span<const double> displacement_m, double threshold_m) {
  std::vector<Reversal> found;
  if (displacement_m.empty()) return found;
  std::size_t highest = 0;
  std::size_t lowest = 0;
  int direction = 0;  // unknown until the motion has gone by the threshold
  for (std::size_t i = 1; i < displacement_m.size(); ++i) {
    const double x = displacement_m[i];
    if (direction >= 0 && x > displacement_m[highest]) highest = i;
    if (direction <= 0 && x < displacement_m[lowest]) lowest = i;
    if (direction >= 0 && displacement_m[highest] - x > threshold_m) {
      // At the start the motion has come from nowhere: a place, not a turn.
      if (direction > 0) found.push_back({highest, displacement_m[highest]});
      direction = -1;
      lowest = i;
    } else if (direction <= 0 && x - displacement_m[lowest] > threshold_m) {
      if (direction < 0) found.push_back({lowest, displacement_m[lowest]});
      direction = 1;
      highest = i;
    }
  }
  return found;
}

double reversal_threshold_m(std::span<const double> displacement_m) {
  if (displacement_m.empty()) return 0.0;
  const auto [low, high] = std::minmax_element(displacement_m.begin(), displacement_m.end());
  return kThresholdShare * (*high - *low);
}

std::vector<double> distance_since_reversal_m(std::span<const double> displacement_m,
                                              const std::vector<Reversal>& reversals) {
  std::vector<double> distance(displacement_m.size());
  double last_m = displacement_m.empty() ? 0.0 : displacement_m.front();
  auto next = reversals.begin();
  for (std::size_t i = 0; i < displacement_m.size(); ++i) {
    if (next != reversals.end() && next->sample <= i) last_m = (next++)->displacement_m;
    distance[i] = std::abs(displacement_m[i] - last_m);
  }
  return distance;
}

std::vector<double> cycles_completed(std::size_t samples, const std::vector<Reversal>& reversals) {
  std::vector<double> cycles(samples);
  std::size_t turns = 0;
  for (std::size_t i = 0; i < samples; ++i) {
    while (turns < reversals.size() && reversals[turns].sample <= i) ++turns;
    const std::size_t whole_cycles = turns / 2;
    cycles[i] = static_cast<double>(whole_cycles);
  }
  return cycles;
}

}  // namespace hybridtest
