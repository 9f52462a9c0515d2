#include "diagnosis/identification/remembered_law.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "diagnosis/identification/law_candidates.hpp"
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

/// In the middle of the ranges; what has the unit of a length is of the size of the path.
EffectSetting replacement_of(const LawCandidate& law, double size) {
  EffectSetting setting{.type = &law.type, .values = {size}};
  for (std::size_t i = 1; i < law.type.parameters.size(); ++i) {
    const double middle = 0.5 * (law.ranges[i].low + std::min(law.ranges[i].high, 2.0));
    const std::string_view unit = law.type.parameters[i].unit;
    const double scale = unit == "m" ? 0.02 : unit == "1/m" || unit == "s/m" ? 10.0 : 1.0;
    setting.values.push_back(scale * middle);
  }
  return setting;
}

std::vector<double> forces_along(Law& law, double times = 1.0) {
  std::vector<double> forces_n;
  for (int i = 0; i < 400; ++i) {
    forces_n.push_back(law.trial(times * path_m(i), times * (path_m(i) - path_m(i - 1)) / 0.01));
    law.commit();
  }
  return forces_n;
}

/// A search evaluates a law once for all sizes. The integrated laws take as many steps whatever the size: only rounding
/// differs.
TEST(RememberedReplacement, SizeOfEachLawScalesItsForce) {
  for (const bool law_is_spring : {true, false}) {
    for (const LawCandidate& law : law_candidates(law_is_spring)) {
      const EffectSetting replacement = replacement_of(law, 3.7e6);
      const std::vector<double> expected_n = forces_along(*replacement.type->replacement->make(replacement.values));
      const double peak_n = std::abs(*std::ranges::max_element(expected_n, {}, [](double f) { return std::abs(f); }));
      ASSERT_GT(peak_n, 0.0);
      const auto memory = std::make_shared<LawMemory>();
      const std::vector<double> first_n = forces_along(*remembering(replacement, *memory));
      const std::vector<double> again_n = forces_along(*remembered(replacement, memory));
      const std::vector<double> beside_n = forces_along(*remembered(replacement, memory), 1.1);
      const std::vector<double> expected_beside_n =
          forces_along(*replacement.type->replacement->make(replacement.values), 1.1);
      for (std::size_t i = 0; i < expected_n.size(); ++i) {
        ASSERT_NEAR(first_n[i], expected_n[i], 1e-9 * peak_n) << law.type.replacement->law << " " << i;
        ASSERT_EQ(again_n[i], first_n[i]) << law.type.replacement->law << " " << i;
        ASSERT_NEAR(beside_n[i], expected_beside_n[i], 1e-9 * peak_n) << law.type.replacement->law << " " << i;
      }
    }
  }
}

TEST(LawMemories, KeepsTheShapesUsedLast) {
  const LawCandidate& law = law_candidates(true).front();
  const auto of_shape = [&](double yield_m) {
    EffectSetting replacement = replacement_of(law, 1.0e6);
    replacement.values[1] = yield_m;
    return replacement;
  };
  LawMemories memories{2};
  const auto memory = std::make_shared<LawMemory>();
  memories.keep(of_shape(0.01), 0, memory);
  memories.keep(of_shape(0.02), 0, std::make_shared<LawMemory>());
  EffectSetting larger = of_shape(0.01);
  larger.values[0] *= 2.0;
  EXPECT_EQ(memories.find(larger, 0), memory) << "of any size";
  EXPECT_EQ(memories.find(of_shape(0.01), 1), nullptr) << "another segment";
  memories.keep(of_shape(0.03), 0, std::make_shared<LawMemory>());
  EXPECT_EQ(memories.find(of_shape(0.02), 0), nullptr) << "the one not used for longest";
  EXPECT_EQ(memories.find(of_shape(0.01), 0), memory);
}

}  // namespace
}  // namespace hybridtest
