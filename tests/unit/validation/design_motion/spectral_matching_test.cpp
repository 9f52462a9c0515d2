#include "validation/design_motion/spectral_matching.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/random.hpp"
#include "validation/design_motion/elastic_spectrum.hpp"
#include "validation/design_motion/filtered_noise.hpp"
#include "validation/design_motion/oscillator.hpp"

namespace hybridtest::design_motion {
namespace {

constexpr double kStep_s = 0.01;

std::vector<double> noise() {
  Random random{2};
  return filtered_noise(random, {}, {}, kStep_s, 3101);
}

SpectralTarget own_spectrum(const std::vector<double>& motion, double factor) {
  SpectralTarget target;
  for (const double period_s : logarithmic_periods(0.1, 2.0, 30)) {
    target.period_s.push_back(period_s);
    const auto peak = peak_response(motion, kStep_s, period_s, target.damping_ratio);
    target.pseudo_acceleration_m_per_s2.push_back(factor * std::abs(peak.pseudo_acceleration_m_per_s2));
  }
  return target;
}

TEST(SpectralFit, ComparesWithTheTarget) {
  const auto motion = noise();
  SpectralTarget target = own_spectrum(motion, 1.0);
  EXPECT_DOUBLE_EQ(spectral_fit(motion, kStep_s, target).misfit(), 0.0);
  target.pseudo_acceleration_m_per_s2.front() *= 2.0;
  target.pseudo_acceleration_m_per_s2.back() *= 0.8;
  const SpectralFit fit = spectral_fit(motion, kStep_s, target);
  EXPECT_DOUBLE_EQ(fit.lowest, 0.5);
  EXPECT_DOUBLE_EQ(fit.highest, 1.25);
  EXPECT_DOUBLE_EQ(fit.misfit(), 0.5);
}

TEST(MatchSpectrum, MatchesSpectrumOfAnotherShape) {
  const auto motion = noise();
  SpectralTarget target = own_spectrum(motion, 1.0);
  // A fifth more and less in turns over the periods.
  for (std::size_t i = 0; i < target.period_s.size(); ++i) {
    target.pseudo_acceleration_m_per_s2[i] *= 1.0 + 0.2 * std::sin(std::log(target.period_s[i] * 10.0) * 3.0);
  }
  const double before = spectral_fit(motion, kStep_s, target).misfit();
  const double after = spectral_fit(match_spectrum(motion, kStep_s, target, 0.5, 15), kStep_s, target).misfit();
  EXPECT_GT(before, 0.15);
  EXPECT_LT(after, 0.05);
}

TEST(MatchSpectrum, KeepsMotionThatFits) {
  const auto motion = noise();
  EXPECT_EQ(match_spectrum(motion, kStep_s, own_spectrum(motion, 1.0), 0.5, 3), motion);
  EXPECT_EQ(match_spectrum(motion, kStep_s, own_spectrum(motion, 1.5), 0.5, 0), motion);
}

}  // namespace
}  // namespace hybridtest::design_motion
