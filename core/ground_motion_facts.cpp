#include "core/ground_motion_facts.hpp"

#include <array>
#include <cstdio>

namespace hybridtest {
namespace {

// The strongest records of earthquakes so far have about 3 g; below 0.01 g structures hardly respond.
constexpr double kPlausiblePeak_g_min = 0.01;
constexpr double kPlausiblePeak_g_max = 3.0;

}  // namespace

std::string ground_motion_text(const GroundMotionFacts& motion) {
  std::array<char, 128> text{};
  std::snprintf(text.data(), text.size(), "peak %.4g g (%.4g m/s2), %lld points, %.6g s",
                motion.peak_m_per_s2 / kStandardGravity_m_per_s2, motion.peak_m_per_s2,
                static_cast<long long>(motion.points), motion.duration_s);
  return text.data();
}

std::string ground_motion_warning(const GroundMotionFacts& motion) {
  const double peak_g = motion.peak_m_per_s2 / kStandardGravity_m_per_s2;
  if (peak_g >= kPlausiblePeak_g_min && peak_g <= kPlausiblePeak_g_max) return {};
  std::array<char, 192> text{};
  std::snprintf(text.data(), text.size(),
                "the ground motion has a peak of %.4g g, expected %g to %g g; check excitation.unit and "
                "excitation.scale",
                peak_g, kPlausiblePeak_g_min, kPlausiblePeak_g_max);
  return text.data();
}

}  // namespace hybridtest
