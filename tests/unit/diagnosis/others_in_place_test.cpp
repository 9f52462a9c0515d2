#include "diagnosis/verdict/others_in_place.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/identification/effect_fit.hpp"
#include "diagnosis/identification/segment.hpp"
#include "diagnosis/identification/smoothing_choice.hpp"
#include "mechanics/laws/bilinear.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

/// What the last comparison says of a cause and of what was tried in its place.
namespace hybridtest {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

const EffectType* of_specimen(const char* name) { return find_effect(EffectInterface::specimen, name); }

/// Of a strength that fades with the path, and what may be in its place.
class OthersInPlace : public testing::Test {
 protected:
  OthersInPlace() {
    SiteModel model = made_model();
    model.make_law = [] {
      return std::make_unique<Bilinear>(Bilinear::Parameters{
          .stiffness_n_per_m = kMadeStiffness_n_per_m, .yield_force_n = 1.6e4, .hardening_ratio = 0.05});
    };
    const std::unique_ptr<Law> specimen = model.make_law();
    const Recording recording = made_recording(made_motion_m, [&](double t) {
      const double force_n = specimen->trial(made_motion_m(t), 0.0);
      specimen->commit();
      return (1.0 - t / 60.0) * force_n;
    });
    problem_.emplace(make_problem(model, modelled_segments(model, recording, 0, 0)));
    for (const EffectType* const type : {kWithPath, kWithTime, kWithCycles, kStrength}) {
      selection_.library.push_back({.type = type, .fit = fit_effects(*problem_, {type}, false)});
    }
    selection_.chosen = selection_.library.front().fit;
    selection_.shares = {1.0};
    selection_.chosen_probabilities = {0.0};
  }

  /// The cause is that probable, and others share what is left: by time, alone and with the numbers of the model, by a
  /// number of the model, and by cycles.
  void compare(double probability) {
    const double rest = 1.0 - probability;
    std::vector<Instead> others;
    const auto add = [&](const EffectType* type, double share) {
      const auto place = std::ranges::find(selection_.library, type, &Candidate::type);
      others.push_back({type, share * rest, place->fit});
    };
    add(kWithTime, 0.1);
    add(kStrength, 0.2);
    add(kWithTime, 0.6);
    add(kWithCycles, 0.1);
    Growth growth{.fit = selection_.chosen, .accepted = {}};
    growth.accept({kWithPath, probability, others});
    put_others_beside(*problem_, {}, growth, selection_);
  }

  [[nodiscard]] std::vector<std::string> alike() const {
    std::vector<std::string> names;
    for (const AlikeLeader& one : selection_.alike) names.emplace_back(one.type->name);
    return names;
  }

  const EffectType* const kWithPath = of_specimen("strength_degradation");
  const EffectType* const kWithTime = of_specimen("strength_degradation_with_time");
  const EffectType* const kWithCycles = of_specimen("strength_degradation_with_cycles");
  const EffectType* const kStrength = of_specimen("strength_error");
  std::optional<IdentificationProblem> problem_;
  Selection selection_;
};

TEST_F(OthersInPlace, AreASetWithACauseThatIsNotSure) {
  compare(0.5);
  // Of 0.5, 0.3 and 0.05 without the number of the model: 0.588 and 0.353 are above 0.9 together.
  EXPECT_THAT(alike(), ElementsAre("strength_degradation_with_time", "strength_degradation"));
  EXPECT_EQ(selection_.library[0].type, kWithPath);
  EXPECT_NEAR(selection_.library[0].probability, 0.5 / 0.85, 1e-12);
  EXPECT_EQ(selection_.library[1].type, kWithTime);
  EXPECT_NEAR(selection_.library[1].probability, 0.3 / 0.85, 1e-12);
  EXPECT_EQ(selection_.library[2].probability, 0.0);
  EXPECT_NEAR(selection_.chosen_probabilities.front(), 0.5 / 0.85, 1e-12);
}

TEST_F(OthersInPlace, AreNoneBesideACauseThatIsSure) {  // control
  compare(0.9);
  EXPECT_THAT(alike(), IsEmpty());
  EXPECT_NEAR(selection_.chosen_probabilities.front(), 0.9 / 0.97, 1e-12);
}

}  // namespace
}  // namespace hybridtest
