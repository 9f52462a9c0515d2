#include "validation/blind_batches/plant/foreign_laws.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace hybridtest::blind {
namespace {

constexpr double kStiffness = 1e7;
constexpr double kYieldN = 5e4;
constexpr double kYieldM = kYieldN / kStiffness;

PlantEffect law_named(const std::string& law, const Parameters& more = {}) {
  PlantEffect effect{"specimen", "hysteresis_law", {}, law};
  effect.parameters = {{"stiffness_n_per_m", kStiffness},
                       {"yield_force_n", kYieldN},
                       {"hardening_ratio", 0.02},
                       {"softening", 0.0},
                       {"flag_ratio", 0.6},
                       {"locked_share", 0.6},
                       {"slot_share", 0.6},
                       {"scale", 100.0}};
  for (const auto& [name, value] : more) effect.parameters[name] = value;
  return effect;
}

struct Path {
  History x;
  History force;

  /// Force at the last passage of a displacement.
  [[nodiscard]] double last_at(double x_m, bool is_rising) const {
    for (std::size_t i = x.size() - 1; i > 0; --i) {
      const bool passes = is_rising ? x[i - 1] < x_m && x[i] >= x_m : x[i - 1] > x_m && x[i] <= x_m;
      if (passes) return force[i];
    }
    return std::nan("");
  }
  /// Work of the last cycle.
  [[nodiscard]] double last_work() const {
    double work = 0.0;
    for (std::size_t i = x.size() * 3 / 4; i < x.size(); ++i)
      work += 0.5 * (force[i] + force[i - 1]) * (x[i] - x[i - 1]);
    return work;
  }
};

/// Four cycles of sines with the given amplitudes; 1 s each.
Path cycled(const PlantEffect& law, const std::array<double, 4>& amplitudes_m) {
  const Spring spring = foreign_law(law);
  Path path;
  for (int i = 0; i <= 16000; ++i) {
    const double t = static_cast<double>(i) / 4000.0;
    const double x = amplitudes_m[static_cast<std::size_t>(std::min(3.0, std::floor(t)))] * std::sin(kTwoPi * t);
    path.x.push_back(x);
    path.force.push_back(spring({t, x, 0.0, 0.0}));
  }
  return path;
}

TEST(ForeignLaw, EveryLawBeginsWithItsStiffnessAndYields) {
  for (const std::string& name : foreign_laws()) {
    const Path small = cycled(law_named(name), {1e-3 * kYieldM, 1e-3 * kYieldM, 1e-3 * kYieldM, 1e-3 * kYieldM});
    const double tangent = peak(small.force) / peak(small.x);
    EXPECT_GT(tangent, 0.6 * kStiffness) << name;
    EXPECT_LT(tangent, 1.05 * kStiffness) << name;
    const double reached = 8.0 * kYieldM;
    const Parameters lasting{{"scale", 1e9}};
    const double most = peak(cycled(law_named(name, lasting), {reached, reached, reached, reached}).force);
    EXPECT_GT(most, 0.5 * kYieldN) << name;
    EXPECT_LT(most, 0.35 * kStiffness * reached) << name;
  }
}

TEST(ForeignLaw, PeakSeekerHeadsForTheFarthestPoint) {
  const PlantEffect law = law_named("peak_seeking");
  const double large = 6.0 * kYieldM;
  // After large cycles a small one swings about the line from its reversal to the peak reached before.
  const Path path = cycled(law, {large, large, large, 0.5 * large});
  const Path virgin = cycled(law, {0.5 * large, 0.5 * large, 0.5 * large, 0.5 * large});
  EXPECT_LT(peak({path.force.end() - 3000, path.force.end()}), 0.85 * peak(virgin.force));
  EXPECT_GT(path.last_work(), 0.0);
  // Control: the tendon, which has no memory of it.
  const Path tendon = cycled(law_named("tendon"), {large, large, large, 0.5 * large});
  const Path tendon_alone = cycled(law_named("tendon"), {0.5 * large, 0.5 * large, 0.5 * large, 0.5 * large});
  EXPECT_NEAR(peak({tendon.force.end() - 3000, tendon.force.end()}), peak(tendon_alone.force), 0.02 * kYieldN);
}

TEST(ForeignLaw, SlipLockPinchesNearTheOrigin) {
  const double large = 6.0 * kYieldM;
  const Path pinched = cycled(law_named("slip_lock"), {large, large, large, large});
  const Path plump = cycled(law_named("fading_with_path", {{"scale", 1e9}}), {large, large, large, large});
  EXPECT_LT(pinched.last_at(0.0, true), 0.5 * plump.last_at(0.0, true));
  EXPECT_GT(peak(pinched.force), 0.8 * peak(plump.force));
}

TEST(ForeignLaw, TendonComesBackToItsOrigin) {
  const double large = 6.0 * kYieldM;
  const Path path = cycled(law_named("tendon"), {large, large, large, large});
  // No force is locked in: half of the flag to either side of zero, and it dissipates.
  EXPECT_NEAR(path.last_at(0.0, false), -0.3 * kYieldN, 0.02 * kYieldN);
  EXPECT_GT(path.last_work(), 0.0);
}

TEST(ForeignLaw, FadesWithWhatItsNameSays) {
  const double large = 0.5 * kYieldM;
  const std::array<double, 4> same{large, large, large, large};
  const auto left = [&](const std::string& law, double scale) {
    const Path path = cycled(law_named(law, {{"scale", scale}, {"yield_force_n", 100.0 * kYieldN}}), same);
    return path.force[13000] / path.force[1000];  // peaks of the first and the fourth cycle
  };
  EXPECT_NEAR(left("fading_with_path", 12.0 * large), std::exp(-1.0), 0.01);  // three cycles of four amplitudes
  EXPECT_NEAR(left("fading_with_time", 3.0), std::exp(-1.0), 0.01);
  EXPECT_NEAR(left("fading_with_peak", large), 1.0, 0.01);  // all of it was lost on the first way out
  // Three loops of nearly 4 Fy (x - xy), half of which is the scale: the strength goes with the root.
  const double far = 6.0 * kYieldM;
  const double scale = 24.0 * kYieldN * (far - kYieldM);
  const Path path = cycled(law_named("fading_with_energy", {{"scale", scale}}), {far, far, far, far});
  EXPECT_NEAR(path.force[13000] / path.force[1000], std::exp(-0.25), 0.05);
}

TEST(ForeignLaw, BesideAnElasticModelItMayBeYieldingWithItsLaw) {
  const std::vector<Cause> causes = names_of_law("tendon", LawKind::elastic);
  const Cause yielding{"specimen", "yielding", "self_centring"};
  EXPECT_EQ(std::ranges::count(causes, yielding), 1);
  EXPECT_EQ(std::ranges::count(names_of_law("tendon", LawKind::bilinear), yielding), 0);
}

TEST(ForeignLaw, EveryLawHasAnAnswerOfItsOwn) {
  for (const std::string& name : foreign_laws()) {
    for (const Cause& cause : names_of_law(name, LawKind::bilinear)) EXPECT_EQ(cause.interface, "specimen");
    EXPECT_FALSE(names_of_law(name, LawKind::elastic).empty()) << name;
  }
}

}  // namespace
}  // namespace hybridtest::blind
