#include "diagnosis/signals/between_steps.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/assert.hpp"

namespace hybridtest {

namespace {

/// Neighbouring samples with the same reading.
struct Plateau {
  std::size_t begin = 0;
  std::size_t end = 0;  // behind the last one
  double value = 0.0;   // mean
};

std::vector<Plateau> plateaus_of(std::span<const double> readings, double step) {
  std::vector<Plateau> plateaus;
  for (std::size_t i = 0; i < readings.size(); ++i) {
    if (plateaus.empty() || std::abs(readings[i] - plateaus.back().value) > 0.5 * step) {
      plateaus.push_back({i, i + 1, readings[i]});
      continue;
    }
    Plateau& last = plateaus.back();
    last.end = i + 1;
    last.value += (readings[i] - last.value) / static_cast<double>(last.end - last.begin);
  }
  return plateaus;
}

/// Where the motion is known: from one plateau to the next.
struct Passage {
  double sample = 0.0;
  double value = 0.0;
};

double slope_between(const Passage& from, const Passage& to) {
  return std::abs(to.value - from.value) / (to.sample - from.sample);
}

}  // namespace

std::vector<double> between_steps(std::span<const double> readings, double step) {
  HYBRIDTEST_ASSERT(step > 0.0);
  std::vector<double> motion(readings.begin(), readings.end());
  const std::vector<Plateau> plateaus = plateaus_of(readings, step);
  if (plateaus.size() < 3) return motion;
  std::vector<Passage> passages;  // the k-th one behind the k-th plateau
  for (std::size_t k = 0; k + 1 < plateaus.size(); ++k) {
    passages.push_back({static_cast<double>(plateaus[k].end) - 0.5, 0.5 * (plateaus[k].value + plateaus[k + 1].value)});
  }
  // The first and the last plateau, between an end of the recording and a passage, stay as they are read.
  for (std::size_t k = 1; k + 1 < plateaus.size(); ++k) {
    const Plateau& plateau = plateaus[k];
    // A motion that passes a step in a sample is read as well as it is known.
    if (plateau.end - plateau.begin == 1) continue;
    const Passage& before = passages[k - 1];
    const Passage& behind = passages[k];
    const double length = behind.sample - before.sample;
    const double side = plateau.value - plateaus[k - 1].value;
    const bool turns = side * (plateau.value - plateaus[k + 1].value) > 0.0;
    double slope = 0.0;  // with which it comes and goes where it turns
    if (turns && k > 1) slope = slope_between(passages[k - 2], before);
    if (turns && k + 1 < passages.size()) slope = 0.5 * (slope + slope_between(behind, passages[k + 1]));
    for (std::size_t i = plateau.begin; i < plateau.end; ++i) {
      const double place = (static_cast<double>(i) - before.sample) / length;
      const double beyond = std::min(slope * length * place * (1.0 - place), 0.5 * step);
      motion[i] = before.value + place * (behind.value - before.value) + std::copysign(beyond, side);
    }
  }
  return motion;
}

}  // namespace hybridtest
