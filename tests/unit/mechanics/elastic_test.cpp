#include "mechanics/laws/elastic.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/config_error.hpp"
#include "tests/support/shared_data.hpp"
#include "tests/unit/mechanics/reference_history.hpp"

namespace hybridtest {
namespace {

TEST(Elastic, ForceIsStiffnessTimesDisplacement) {
  Elastic spring{4.0e6};
  EXPECT_EQ(spring.trial(0.01, 3.0), 4.0e4);
  EXPECT_EQ(spring.trial(-0.5, 0.0), -2.0e6);
  EXPECT_EQ(spring.initial_stiffness_n_per_m(), 4.0e6);
}

TEST(Elastic, AgreesWithOpenSees) {
  const auto file = shared_data("reference/two_storey_linear.csv");
  HYBRIDTEST_NEEDS_DATA(file);
  const ReferenceHistory reference = read_reference(file);
  Elastic spring{4.0e6};
  // Displacement and force are written with six digits each, and half a unit of the last is lost.
  for (std::size_t i = 0; i < reference.force_n.size(); ++i) {
    ASSERT_NEAR(spring.trial(reference.displacement_m[i], 0.0), reference.force_n[i],
                1e-5 * std::abs(reference.force_n[i]));
  }
}

TEST(Elastic, RejectsStiffnessOutOfRange) {
  EXPECT_THROW(Elastic{0.0}, ConfigError);
  EXPECT_THROW(Elastic{-1.0}, ConfigError);
  EXPECT_THROW(Elastic{std::nan("")}, ConfigError);
  EXPECT_THROW(Elastic{INFINITY}, ConfigError);
}

}  // namespace
}  // namespace hybridtest
