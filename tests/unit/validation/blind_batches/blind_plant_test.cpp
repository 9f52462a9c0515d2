#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "validation/blind_batches/plant/plant.hpp"
#include "validation/blind_batches/plant/signal_chain.hpp"
#include "validation/blind_batches/plant/specimen.hpp"

// The plant's physics against closed forms.
namespace hybridtest::blind {
namespace {

constexpr double kRateHz = 1000.0;
constexpr double kFinePeriodS = 1.0 / (kRateHz * static_cast<double>(kFineSteps));

/// Samples of a function of time at the recording's rate.
template <class Function>
History samples_of(Function function, double duration_s) {
  History values(static_cast<std::size_t>(duration_s * kRateHz) + 1);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = function(static_cast<double>(i) / kRateHz);
  return values;
}

History sine(double amplitude, double frequency_hz, double duration_s) {
  return samples_of([=](double t) { return amplitude * std::sin(kTwoPi * frequency_hz * t); }, duration_s);
}

Site elastic_site() {
  Site site;
  site.specimen.stiffness_n_per_m = 2e6;
  site.rate_hz = kRateHz;
  return site;
}

TEST(BristleFriction, SlidesAtItsForceAndDissipatesLoopArea) {
  const MotionHistory motion = motion_of(spline(sine(0.02, 0.5, 4.0)), kFinePeriodS);
  const History force = bristle_friction({.force_n = 300.0,
                                          .force_backward_n = 200.0,
                                          .breakaway_n = 300.0,
                                          .stribeck_m_per_s = 1.0,
                                          .presliding_m = 2e-5},
                                         motion);
  EXPECT_NEAR(*std::ranges::max_element(force), 300.0, 1e-6);
  EXPECT_NEAR(*std::ranges::min_element(force), -200.0, 1e-6);
  double work = 0.0;
  for (std::size_t i = force.size() / 2; i < force.size(); ++i) {  // second of the two cycles
    work += force[i] * (motion.displacement_m[i] - motion.displacement_m[i - 1]);
  }
  // Each reversal loses about the presliding deflection twice on the way of 2 x 0.04 m.
  EXPECT_NEAR(work, (300.0 + 200.0) * 0.04, (300.0 + 200.0) * 2 * 2e-5);
}

TEST(BristleFriction, FollowsTheStribeckCurveInSteadySliding) {
  for (const double velocity : {0.002, 0.01, 0.05}) {
    const History ramp = samples_of([=](double t) { return velocity * t; }, 2.0);
    const MotionHistory motion = motion_of(spline(ramp), kFinePeriodS);
    const History force = bristle_friction({.force_n = 100.0,
                                            .force_backward_n = 100.0,
                                            .breakaway_n = 180.0,
                                            .stribeck_m_per_s = 0.01,
                                            .presliding_m = 1e-5},
                                           motion);
    const double share = velocity / 0.01;
    EXPECT_NEAR(force.back(), 100.0 + 80.0 * std::exp(-share * share), 1e-6);
  }
}

TEST(IwanStack, FollowsInitialAndHardeningLines) {
  const StackParameters stack{.stiffness_n_per_m = 1e6, .yield_force_n = 5e3, .hardening_ratio = 0.1, .spread = 0.6};
  const History x{0.0, 0.001, 0.0019, 0.02, 0.0};
  const History force = iwan_stack(stack, x);
  EXPECT_NEAR(force[1], 1e6 * 0.001, 1e-9);
  EXPECT_NEAR(force[2], 1e6 * 0.0019, 1e-9);  // the first element slips at (1 - 0.6) * 5 mm = 2 mm
  // All slip: the mean slip is the yield displacement.
  EXPECT_NEAR(force[3], 0.9 * 5e3 + 0.1 * 1e6 * 0.02, 1e-6);
  // Masing: unloading by more than twice the largest reach ends on the other line.
  EXPECT_NEAR(force[4], -0.9 * 5e3, 1e-6);
}

TEST(BaseLaw, BoucWenHasItsStiffnessAndUltimateForce) {
  LawModel law;
  law.kind = LawKind::bouc_wen;
  law.stiffness_n_per_m = 1e6;
  law.alpha = 0.1;
  law.gamma_per_m = 60.0;
  law.beta_per_m = 40.0;
  const History force = law_force(law, {0.0, 1e-7, 0.5, -0.5});
  EXPECT_NEAR(force[1], 1e6 * 1e-7, 1e-6);  // curvature: 100 / m times the step
  EXPECT_NEAR(force[2], 1e5 * 0.5 + 0.9e6 / 100.0, 1e-9);
  EXPECT_NEAR(force[3], -1e5 * 0.5 - 0.9e6 / 100.0, 1e-9);
}

TEST(BaseLaw, SteelSpringApproachesItsHardeningLine) {
  LawModel law;
  law.kind = LawKind::giuffre_menegotto_pinto;
  law.stiffness_n_per_m = 2e8;
  law.yield_force_n = 4e5;
  law.hardening_ratio = 0.02;
  const double yield_m = 4e5 / 2e8;
  const History force = law_force(law, {0.0, 0.1 * yield_m, 10.0 * yield_m});
  // With R = 20 (1 - 0.925 * 0 / 0.15) on the first branch: (1 + r^-20)^(1/20) - 1 < 1e-21.
  EXPECT_NEAR(force[1], 0.1 * 4e5, 1e-6);
  EXPECT_NEAR(force[2], 4e5 * (1.0 + 0.02 * 9.0), 1e-6);
}

TEST(Actuator, SecondOrderServoDelaysSlowMotion) {
  Site site = elastic_site();
  site.transfer_system = {.kind = TransferKind::second_order,
                          .delay_s = 0.0053,
                          .bandwidth_hz = 0.0,
                          .natural_frequency_hz = 20.0,
                          .damping_ratio = 0.7};
  const History ramp = samples_of([](double t) { return 0.01 * t; }, 2.0);
  const History x = stage_output(Residual::transfer_system, site, {}, ramp);
  const double delay_s = 0.0053 + 2.0 * 0.7 / (kTwoPi * 20.0);
  EXPECT_NEAR(x.back(), 0.01 * (2.0 - delay_s), 1e-12);  // transients: exp(-176) after 2 s
}

TEST(Actuator, ServoFasterThanTheStepsFollowsARamp) {
  for (const double natural_frequency_hz : {200.0, 5e3, 5e4}) {
    for (const double damping_ratio : {0.7, 1.6}) {
      ServoLoop loop = ServoLoop::second_order(natural_frequency_hz, damping_ratio, kFinePeriodS);
      double x = 0.0;
      for (int i = 1; i <= 20000; ++i) x = loop.next(1e-6 * i);
      const double delay_steps = 2.0 * damping_ratio / (kTwoPi * natural_frequency_hz) / kFinePeriodS;
      EXPECT_NEAR(x, 1e-6 * (20000.0 - delay_steps), 1e-12) << natural_frequency_hz << " Hz, " << damping_ratio;
    }
  }
}

TEST(Actuator, FirstOrderServoIsThreeDecibelsDownAtBandwidth) {
  Site site = elastic_site();
  site.transfer_system = {.kind = TransferKind::first_order,
                          .delay_s = 0.0,
                          .bandwidth_hz = 4.0,
                          .natural_frequency_hz = 0.0,
                          .damping_ratio = 0.0};
  History x = stage_output(Residual::transfer_system, site, {}, sine(1.0, 4.0, 3.0));
  x.erase(x.begin(), x.begin() + 2000);  // transient: exp(-50)
  // Straight lines cut (w h)^2 / 12 = 5e-5 of the amplitude; samples miss the peak by 8e-5.
  EXPECT_NEAR(peak(x), std::sqrt(0.5), 2e-4);
}

TEST(Actuator, FrameReducesStrokeByStiffnessRatio) {
  const Site site = elastic_site();
  const PlantEffects frame{
      {"transfer_system", "compliance", {{"stiffness_n_per_m", 2e7}, {"closing_n", 1e-3}}}};  // closed from the start
  const History command = sine(0.01, 1.0, 1.0);
  const History x = stage_output(Residual::transfer_system, site, frame, command);
  // The frame gives a millisecond late, a tenth of the motion; and once from rest.
  const double late_m = 0.1 * 0.01 * kTwoPi * (1e-3 + kFinePeriodS);
  for (std::size_t i = 50; i < x.size(); i += 50) EXPECT_NEAR(x[i], command[i] / 1.1, late_m);
}

TEST(Actuator, HeldBySealsItCatchesUpWithAFastDemand) {
  const PlantEffects seals{{"transfer_system", "stiction", {{"breakaway_m", 0.001}, {"catching_up_hz", 10.0}}}};
  const History ramp = samples_of([](double t) { return 0.1 * t; }, 0.1);
  const History x = stage_output(Residual::transfer_system, elastic_site(), seals, ramp);
  // 1 mm ahead after 10 ms, caught up 1 / (2 pi 10 Hz) = 16 ms later, though 1 mm in that time is less than the demand.
  EXPECT_EQ(x[9], 0.0);
  // It slips within one fine step of 10 ms.
  EXPECT_NEAR(x[18], ramp[18] - 0.001 * (1.0 - 0.008 * kTwoPi * 10.0), 0.1001 * kFinePeriodS);
  EXPECT_NEAR(x[27], ramp[27], 1e-12);
  EXPECT_NEAR(x.back(), ramp.back(), 1e-12);
}

TEST(Compensator, IsExactForMotionsOfItsOrder) {
  Site site = elastic_site();
  site.compensator = {.order = 2, .delay_s = 0.0125};
  const auto parabola = [](double t) { return 0.3 * t * t - 0.1 * t; };
  const History command = compensated(site, {}, samples_of(parabola, 1.0));
  // Points lie halfway between samples, where straight lines err by 0.6 h^2 / 8, weighted by 3.
  EXPECT_NEAR(command[800], parabola(0.8 + 0.0125), 3.0 * 0.6 * 1e-6 / 8.0 + 1e-12);
}

TEST(Network, HoldsNewestArrivedValue) {
  Site site = elastic_site();
  const PlantEffects latency{{"network", "latency", {{"delay_s", 0.0025}}}};
  EXPECT_EQ(through_network(site, latency, {0, 1, 2, 3, 4, 5, 6}), (History{0, 0, 0, 0, 1, 2, 3}));
}

TEST(Specimen, InertiaAndDampingActOnTheDerivatives) {
  Site site = elastic_site();
  site.specimen.kind = LawKind::none;
  site.known_mass_kg = 100.0;
  site.known_damping_n_s_per_m = 2000.0;
  const History x = sine(0.05, 2.0, 3.0);
  const TrueSignals signals = run_plant(site, {}, x);
  const double w = kTwoPi * 2.0;
  for (std::size_t i = 500; i < 2500; i += 37) {
    const double t = static_cast<double>(i) / kRateHz;
    const double expected = 0.05 * (2000.0 * w * std::cos(w * t) - 100.0 * w * w * std::sin(w * t));
    EXPECT_NEAR(signals.read_n[i], expected, 1e-4 * 0.05 * 100.0 * w * w);  // (w h)^2 / 12 = 1.3e-5
  }
}

TEST(Specimen, DamperWithPlayIsFreeAfterReversal) {
  Site site = elastic_site();
  site.specimen.kind = LawKind::none;
  site.known_damping_n_s_per_m = 1000.0;
  const PlantEffects slot{{"specimen", "backlash", {{"width_m", 0.004}}}};  // slots of 3.6 to 4.4 mm
  const TrueSignals signals = run_plant(site, slot, sine(0.01, 1.0, 1.0));
  // After the reversal at 0.25 s the actuator crosses w until cos(2 pi (t - 0.25 s)) = 1 - w / 10 mm.
  const double first_s = std::acos(0.64) / kTwoPi;
  const double last_s = std::acos(0.56) / kTwoPi;
  EXPECT_NEAR(signals.read_n[260], 0.0, 1e-9);
  EXPECT_NEAR(signals.read_n[static_cast<std::size_t>((0.25 + first_s) * kRateHz) - 1], 0.0, 1e-9);
  const double t = 0.25 + last_s + 0.01;
  const auto i = static_cast<std::size_t>(t * kRateHz);
  const double velocity = kTwoPi * 0.01 * std::cos(kTwoPi * static_cast<double>(i) / kRateHz);
  EXPECT_NEAR(signals.read_n[i], 1000.0 * velocity, 1e-3);  // (w h)^2 / 6 of 50 N: 3e-4
}

TEST(Sensors, SkewAndLagDelayRamp) {
  const Site site = elastic_site();
  const History ramp = samples_of([](double t) { return 0.01 * t; }, 1.0);
  const double rate = 2e6 * 0.01;
  const TrueSignals skewed = run_plant(site, {{"force_sensor", "time_skew", {{"skew_s", 0.0031}}}}, ramp);
  EXPECT_NEAR(skewed.read_n.back(), rate * (1.0 - 0.0031), 1e-6);
  // Two poles, also where they are much faster than the steps of the plant.
  for (const double lag_s : {0.006, 1e-6}) {
    const TrueSignals lagging = run_plant(site, {{"force_sensor", "lag", {{"time_constant_s", lag_s}}}}, ramp);
    EXPECT_NEAR(lagging.read_n.back(), rate * (1.0 - lag_s), rate * 1e-8) << lag_s;
  }
}

}  // namespace
}  // namespace hybridtest::blind
