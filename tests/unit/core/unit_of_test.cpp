#include "core/parameters/unit_of.hpp"

#include <gtest/gtest.h>

namespace hybridtest {
namespace {

TEST(UnitOf, NameOfAParameterEndsInItsUnit) {
  EXPECT_EQ(unit_of("stiffness_n_per_m"), "N/m");
  EXPECT_EQ(unit_of("leakage_m3_per_s_pa"), "m³/(s Pa)");
  EXPECT_EQ(unit_of("proportional_gain_per_m2"), "1/m²");
  EXPECT_EQ(unit_of("slope_m_per_s_min"), "m/s");
  EXPECT_EQ(unit_of("damping_n_s_per_m"), "N s/m");
  EXPECT_EQ(unit_of("hardening_ratio"), "");
  EXPECT_EQ(unit_of("n"), "");
  EXPECT_EQ(unit_of("a2_s2"), "s²");
}

}  // namespace
}  // namespace hybridtest
