#include "diagnosis/identification/remembered_law.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "mechanics/laws/bilinear.hpp"

namespace hybridtest {
namespace {

std::unique_ptr<Law> yielding() {
  return std::make_unique<Bilinear>(
      Bilinear::Parameters{.stiffness_n_per_m = 1.0e6, .yield_force_n = 5.0e3, .hardening_ratio = 0.05});
}

double step(Law& law, double displacement_m) {
  const double force_n = law.trial(displacement_m, 0.0);
  law.commit();
  return force_n;
}

double path_m(int i) { return 0.02 * std::sin(0.1 * i); }

TEST(LawFromMemory, EqualsTheLawOnAndBesideThePath) {
  const auto memory = std::make_shared<LawMemory>();
  const auto first = remembering(yielding(), *memory);
  for (int i = 0; i < 200; ++i) step(*first, path_m(i));
  const auto law = yielding();
  int made = 0;
  const auto remembered = from_memory(
      [&] {
        ++made;
        return yielding();
      },
      memory);
  for (int i = 0; i < 120; ++i) ASSERT_EQ(step(*remembered, path_m(i)), step(*law, path_m(i))) << i;
  EXPECT_EQ(made, 0);
  for (int i = 120; i < 200; ++i) {
    ASSERT_EQ(step(*remembered, 1.1 * path_m(i)), step(*law, 1.1 * path_m(i))) << i;
  }
  EXPECT_EQ(made, 1);
}

}  // namespace
}  // namespace hybridtest
