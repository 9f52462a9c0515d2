#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>

#include "core/config/section.hpp"
#include "scenario/catalogue/documentation.hpp"
#include "scenario/catalogue/integrators.hpp"
#include "tests/support/amplification.hpp"

/// The tables of docs/integrators.md: every figure is measured on the integrator.
namespace hybridtest {
namespace {

const std::filesystem::path kIntegratorPage = std::filesystem::path{HYBRIDTEST_SOURCE_DIR} / "docs/integrators.md";

std::string integrator_page() {
  std::ifstream file{kIntegratorPage, std::ios::binary};
  return {std::istreambuf_iterator<char>{file}, {}};
}

/// One row per setting; every type stands there once with the defaults of its parameters at least.
const std::vector<std::string> kSettings{
    "type: central_difference",
    "type: explicit_newmark",
    "type: cr",
    "type: kr_alpha, rho_inf: 0.8",
    "type: kr_alpha, rho_inf: 0.5",
    "type: kr_alpha, rho_inf: 0",
    "type: alpha_operator_splitting, alpha: 0",
    "type: alpha_operator_splitting, alpha: -0.1",
    "type: alpha_operator_splitting, alpha: -0.3",
    "type: generalised_alpha, rho_inf: 0.8, iterations: 3",
    "type: implicit_newmark",
    "type: rosenbrock_w",
};

IntegratorReading integrator_of(const std::string& setting) {
  config::Document document = config::Document::parse("integrator: {" + setting + "}", "table");
  IntegratorReading reading = read_integrator(document.root().section("integrator"));
  document.throw_if_errors();
  return reading;
}

/// Of one mode without damping, at omega times the step of the test.
class ModeOf {
 public:
  ModeOf(const IntegratorReading& integrator, double omega_dt)
      : omega_h_{omega_dt * integrator.needs.commands_per_step},
        roots_{test::amplification_roots(integrator.make, integrator.needs.commands_per_step, {.omega_dt = omega_dt})},
        exponent_{std::log(test::principal_root(roots_))} {}

  [[nodiscard]] double radius() const { return std::abs(roots_[0]); }
  [[nodiscard]] double error() const { return std::abs(exponent_ - std::complex<double>{0.0, omega_h_}) / omega_h_; }
  [[nodiscard]] double period_error() const { return omega_h_ / exponent_.imag() - 1.0; }
  [[nodiscard]] double damping_ratio() const { return -exponent_.real() / std::abs(exponent_); }

 private:
  double omega_h_;
  Eigen::VectorXcd roots_;
  std::complex<double> exponent_;
};

/// A percentage whose rounding has no sign.
std::string percent(double share, int digits) {
  const double value = 100.0 * share;
  return fmt::format("{:.{}f}", std::abs(value) < 0.5 * std::pow(10.0, -digits) ? 0.0 : value, digits);
}

constexpr double kStable = 1.0 + 1e-6;

std::string stable_up_to(const IntegratorReading& integrator) {
  if (ModeOf{integrator, 300.0}.radius() < kStable) return "any";
  double stable = 0.1;
  double unstable = 300.0;
  while (unstable - stable > 1e-4) {
    const double middle = 0.5 * (stable + unstable);
    (ModeOf{integrator, middle}.radius() < kStable ? stable : unstable) = middle;
  }
  return fmt::format("{:.2f}", stable);
}

double order(const IntegratorReading& integrator) {
  return std::log2(ModeOf{integrator, 0.1}.error() / ModeOf{integrator, 0.05}.error());
}

/// Of a nearly infinitely fast mode. The predictor of a corrected displacement grows with omega dt, and so does its
/// rounding.
double fast_mode_radius(const IntegratorReading& integrator) {
  return ModeOf{integrator, integrator.needs.corrects_displacement ? 300.0 / integrator.needs.commands_per_step : 1e4}
      .radius();
}

std::string needs_of(const IntegratorNeeds& needs) {
  return std::string{needs.initial_stiffness ? "initial stiffness" : ""} +
         (needs.tries_displacements ? ", trials: numerical substructures alone" : "");
}

std::string row(const std::string& setting) {
  const IntegratorReading integrator = integrator_of(setting);
  const std::string limit = stable_up_to(integrator);
  const bool is_limited = limit != "any";
  std::string text = fmt::format("| `{}` | {:.1f} | {} | {} |", setting.substr(6), order(integrator), limit,
                                 is_limited ? "—" : fmt::format("{:.1f}", fast_mode_radius(integrator)));
  for (const double omega_dt : {0.1, 1.0}) {
    const ModeOf mode{integrator, omega_dt};
    text += fmt::format(" {} | {} |", percent(mode.damping_ratio(), 3), percent(mode.period_error(), 2));
  }
  return text + fmt::format(" {} | {} | {} |\n", integrator.needs.commands_per_step, needs_of(integrator.needs),
                            integrator.source);
}

std::string integrator_rows() {
  std::string text =
      "| integrator | order | stable up to ω Δt | ρ∞ | damping at 0.1, % | period at 0.1, % | damping at 1, % | "
      "period at 1, % | commands per step | needs | source |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
  for (const std::string& setting : kSettings) text += row(setting);
  return text;
}

/// A mode with omega = 1 rad/s and m = 1 kg beside a damper whose force is measured, at omega dt = 0.1.
class ModeWithDamper {
 public:
  ModeWithDamper(const IntegratorReading& integrator, double damper_dt)
      : integrator_{integrator.make(test::oscillator(1.0, 0.0, 1.0), kStep_s,
                                    {Eigen::VectorXd::Ones(1), Eigen::VectorXd::Zero(1)})},
        damping_n_s_per_m_{damper_dt / kStep_s} {
    for (int step = 0; step < kSteps && largest_m_ < kGrown_m; ++step) {
      double commanded_m_per_s = 0.0;
      const auto force_n = [&](const MotionState& command) -> Eigen::VectorXd {
        commanded_m_per_s = command.velocity_m_per_s[0];
        return command.displacement_m + damping_n_s_per_m_ * command.velocity_m_per_s;
      };
      complete_step(*integrator_, force_n, Eigen::VectorXd::Zero(1));
      has_equilibrium_ = has_equilibrium_ && integrator_->missing_m() == 0.0;
      const MotionState& completed = integrator_->completed();
      largest_m_ = std::max(largest_m_, std::abs(completed.displacement_m[0]));
      velocity_error_ = std::max(velocity_error_, std::abs(commanded_m_per_s - completed.velocity_m_per_s[0]));
    }
  }

  [[nodiscard]] bool fails() const { return !has_equilibrium_ || !(largest_m_ < kGrown_m); }
  /// Of the velocity that comes with a command against the one in equilibrium, over the amplitude of the velocity.
  [[nodiscard]] double velocity_error() const { return velocity_error_; }

 private:
  static constexpr double kStep_s = 0.1;
  static constexpr int kSteps = 4000;
  static constexpr double kGrown_m = 10.0;

  std::unique_ptr<Integrator> integrator_;
  double damping_n_s_per_m_;
  bool has_equilibrium_ = true;
  double largest_m_ = 0.0;
  double velocity_error_ = 0.0;
};

double damper_limit(const IntegratorReading& integrator) {
  double stable = 0.01;
  double unstable = 100.0;
  while (unstable - stable > 1e-4) {
    const double middle = 0.5 * (stable + unstable);
    (ModeWithDamper{integrator, middle}.fails() ? unstable : stable) = middle;
  }
  return stable;
}

std::string damper_rows() {
  std::string text =
      "| integrator | error of the velocity at ω Δt = 0.1, % | damper up to c Δt / m |\n"
      "| --- | --- | --- |\n";
  for (const std::string& setting : kSettings) {
    const IntegratorReading integrator = integrator_of(setting);
    text += fmt::format("| `{}` | {} | {:.2f} |\n", setting.substr(6),
                        percent(ModeWithDamper{integrator, 0.0}.velocity_error(), 3), damper_limit(integrator));
  }
  return text;
}

TEST(IntegratorDocumentation, HasTheMeasuredTables) {
  const std::string expected = with_generated_part(
      with_generated_part(integrator_page(), {"integrators", integrator_rows()}), {"dampers", damper_rows()});
  if (std::getenv("HYBRIDTEST_WRITE_DOCS") != nullptr) std::ofstream{kIntegratorPage, std::ios::binary} << expected;
  EXPECT_TRUE(integrator_page() == expected)
      << "docs/integrators.md is not up to date; run this test with HYBRIDTEST_WRITE_DOCS=1 to write its tables";
}

TEST(IntegratorDocumentation, HasEveryIntegrator) {
  for (const PartType<IntegratorReading>& type : integrators()) {
    EXPECT_THAT(kSettings, testing::Contains(testing::StartsWith("type: " + type.name)));
  }
}

TEST(IntegratorDocumentation, EveryIntegratorIsOfSecondOrder) {
  for (const std::string& setting : kSettings) EXPECT_NEAR(order(integrator_of(setting)), 2.0, 0.1) << setting;
}

TEST(IntegratorDocumentation, PredictedVelocityIsWithinHalfOmegaDtSquared) {
  // v + dt a leaves dt^2/2 of the change of a: (omega dt)^2/2 of the amplitude of the velocity.
  for (const char* setting : {"type: central_difference", "type: explicit_newmark", "type: cr"}) {
    EXPECT_NEAR(ModeWithDamper(integrator_of(setting), 0.0).velocity_error(), 0.5 * 0.01, 0.3e-3) << setting;
  }
}

TEST(IntegratorDocumentation, DamperOfAnExplicitMethodIsLimitedByTheMass) {
  // With v + dt a the roots of a mass with a damper alone leave the unit circle at c dt = m.
  EXPECT_NEAR(damper_limit(integrator_of("type: explicit_newmark")), 1.0, 0.02);
}

TEST(IntegratorDocumentation, PeriodErrorsAreThoseOfTheTextbooks) {
  // (omega dt)^2/12 for average acceleration, -(omega dt)^2/24 for central differences (Bathe; Chopra).
  EXPECT_NEAR(ModeOf(integrator_of("type: cr"), 0.1).period_error(), 0.01 / 12.0, 1e-5);
  EXPECT_NEAR(ModeOf(integrator_of("type: central_difference"), 0.1).period_error(), -0.01 / 24.0, 1e-5);
}

}  // namespace
}  // namespace hybridtest
