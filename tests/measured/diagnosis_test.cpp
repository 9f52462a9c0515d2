#include "diagnosis/diagnose.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>

#include "diagnosis/intake/intake.hpp"
#include "experimental_site/transfer_systems/delay.hpp"
#include "experimental_site/transfer_systems/ideal.hpp"
#include "mechanics/elastic.hpp"

/// What the diagnosis says of recordings that laboratories made. The figures asserted are findings about
/// the data (shared/data/README.md, and fits by other means), not answers of an earlier version.
namespace hybridtest {
namespace {

std::optional<Recording> measured(const std::string& name, RecordingRole role = RecordingRole::fit) {
  const auto file = std::filesystem::path{HYBRIDTEST_SHARED_DATA} / "measured" / (name + ".csv");
  std::ifstream in{file, std::ios::binary};
  if (!in) return {};
  std::ostringstream text;
  text << in.rdbuf();
  std::optional<Recording> recording = read_csv_recording(text.str(), name).recording;
  if (recording) recording->role = role;
  return recording;
}

/// The stretch of a recording from one share of its length to another.
Recording stretch(const Recording& whole, double from, double to, RecordingRole role) {
  Recording part = whole;
  part.role = role;
  const auto begin = static_cast<std::ptrdiff_t>(from * static_cast<double>(whole.samples));
  const auto end = static_cast<std::ptrdiff_t>(to * static_cast<double>(whole.samples));
  part.samples = static_cast<std::size_t>(end - begin);
  for (std::vector<double>& channel : part.dofs[0].samples) {
    if (!channel.empty()) channel = {channel.begin() + begin, channel.begin() + end};
  }
  return part;
}

Diagnosis answer(const SiteModel& model, const std::vector<Recording>& recordings) {
  DiagnoseSettings settings;
  settings.threads = 2;
  return diagnose(model, recordings, settings);
}

bool names(const Diagnosis& diagnosis, std::string_view interface, std::string_view effect) {
  return std::ranges::any_of(diagnosis.causes, [&](const EffectSetting& cause) {
    return name_of(cause.type->interface) == interface && cause.type->name == effect;
  });
}

SiteModel ideal_actuator() {
  SiteModel model;
  model.make_transfer_system = [](double, double) { return std::make_unique<Ideal>(); };
  return model;
}

SiteModel delayed_actuator(double delay_s) {
  SiteModel model;
  model.removable_delay_s = delay_s;
  model.make_transfer_system = [delay_s](double period_s, double change_s) {
    return std::make_unique<Delay>(from_seconds(delay_s + change_s), from_seconds(period_s));
  };
  return model;
}

class ServoHydraulicActuator : public testing::Test {
 protected:
  void SetUp() override {
    const auto whole = measured("servo_hydraulic_mr_damper_0A");
    if (!whole) GTEST_SKIP() << "no measured data at " HYBRIDTEST_SHARED_DATA;
    // A chirp: every third of it has frequencies of its own, so the middle is held out between two that are fitted.
    recordings_ = {stretch(*whole, 0.0, 0.4, RecordingRole::fit), stretch(*whole, 0.6, 1.0, RecordingRole::fit),
                   stretch(*whole, 0.4, 0.6, RecordingRole::held_out)};
  }

  std::vector<Recording> recordings_;
};

TEST_F(ServoHydraulicActuator, HasABandwidthAndNoDelay) {
  const Diagnosis diagnosis = answer(ideal_actuator(), recordings_);
  EXPECT_TRUE(names(diagnosis, "transfer_system", "bandwidth"));
  EXPECT_EQ(diagnosis.report.where.front().interface, "transfer_system");
  // The laboratory's own two poles remove 99.8 % over the whole record, the best pure delay 74 %.
  EXPECT_GE(diagnosis.report.interface_shrink->variance_removed, 0.997);
}

TEST_F(ServoHydraulicActuator, HasABandwidthBesideTheBestDelay) {
  const Diagnosis diagnosis = answer(delayed_actuator(0.0166), recordings_);
  EXPECT_TRUE(names(diagnosis, "transfer_system", "bandwidth"));
  EXPECT_GE(diagnosis.report.interface_shrink->variance_removed, 0.98);
}

TEST(ServoAxis, HasViscousAndDryFriction) {
  const auto excitation = measured("servo_axis_excitation");
  const auto validation = measured("servo_axis_validation", RecordingRole::held_out);
  if (!excitation || !validation) GTEST_SKIP() << "no measured data at " HYBRIDTEST_SHARED_DATA;
  // Displacement in, force out: the specimen's interface. The position loop is another question.
  std::vector<Recording> recordings{*excitation};
  for (Recording& recording : recordings) recording.dofs[0].of(Channel::target_displacement).clear();
  SiteModel mass_only = ideal_actuator();
  mass_only.effects.push_back({find_effect(EffectInterface::specimen, "inertia"), {95.1}});
  const Diagnosis diagnosis = answer(mass_only, recordings);
  EXPECT_TRUE(names(diagnosis, "specimen", "viscous_damping"));
  EXPECT_TRUE(names(diagnosis, "specimen", "coulomb_friction"));
  for (const char* rejected : {"stiffness_error", "cubic_stiffness", "stribeck_friction"}) {
    EXPECT_FALSE(names(diagnosis, "specimen", rejected)) << rejected;
  }
  EXPECT_GE(diagnosis.report.interface_shrink->variance_removed, 0.98);

  // In the validation record a disturbance came in upstream of the force: the specimen knows nothing of it.
  Recording other = *validation;
  other.dofs[0].of(Channel::target_displacement).clear();
  other.role = RecordingRole::fit;
  SiteModel augmented = mass_only;
  augmented.effects.insert(augmented.effects.end(), diagnosis.causes.begin(), diagnosis.causes.end());
  const Diagnosis again = answer(augmented, {other});
  // A twelfth of the force's size: what is left of the mass-only model's gap is a seventh of that.
  EXPECT_LT(again.report.where.front().nrmse, 1.0 / 12.0);
}

TEST(FrictionDamper, HasFrictionAndMore) {
  std::vector<Recording> recordings;
  for (const char* name : {"friction_damper_1Hz36lb_1in", "friction_damper_0.5Hz36lb_1in"}) {
    const auto recording = measured(name);
    if (!recording) GTEST_SKIP() << "no measured data at " HYBRIDTEST_SHARED_DATA;
    recordings.push_back(*recording);
  }
  SiteModel linear = ideal_actuator();
  linear.make_law = [] { return std::make_unique<Elastic>(4.6e5); };
  const Diagnosis diagnosis = answer(linear, recordings);
  EXPECT_TRUE(names(diagnosis, "specimen", "coulomb_friction"));
  EXPECT_EQ(diagnosis.report.where.front().interface, "specimen");
  // A fit of friction alone by other means leaves 8 % of the gap of a linear model.
  EXPECT_GE(diagnosis.report.interface_shrink->variance_removed, 0.85);
}

}  // namespace
}  // namespace hybridtest
