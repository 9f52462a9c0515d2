#include "validation/studies/compensator_character/test_stand.hpp"

#include "compensation/sample_history.hpp"
#include "validation/studies/rths_benchmark/candidates.hpp"
#include "validation/studies/rths_benchmark/constants.hpp"
#include "validation/studies/rths_benchmark/plant.hpp"

namespace hybridtest::character {
namespace {

constexpr double kDelayPeriodS = 0.001;
constexpr std::size_t kDelayPeriods = 20;

class PureDelay final : public TestStand {
 public:
  explicit PureDelay(double stiffness_n_per_m) : stiffness_n_per_m_{stiffness_n_per_m} { commands_m_.push(0.0); }
  void step(double command_m) noexcept override { commands_m_.push(command_m); }
  // The newest command was sent one period ago.
  [[nodiscard]] double displacement_m() const noexcept override { return commands_m_[kDelayPeriods - 1]; }
  [[nodiscard]] double force_n() const noexcept override { return stiffness_n_per_m_ * displacement_m(); }

 private:
  double stiffness_n_per_m_;
  SampleHistory commands_m_{kDelayPeriods};
};

class BenchmarkActuator final : public TestStand {
 public:
  void step(double command_m) noexcept override { plant_.step(command_m); }
  [[nodiscard]] double displacement_m() const noexcept override { return plant_.displacement_m(); }
  [[nodiscard]] double force_n() const noexcept override { return plant_.force_n(); }

 private:
  rths::Plant plant_{TransferSystemModel{}};
};

}  // namespace

StandKind pure_delay_stand() {
  const double stiffness_n_per_m = TransferSystemModel{}.stiffness_n_per_m;
  return {.name = "pure delay of 20 ms",
          .period_s = kDelayPeriodS,
          .delay_s = kDelayPeriodS * static_cast<double>(kDelayPeriods),
          .mass_kg = 0.0,
          .damping_n_s_per_m = 0.0,
          .stiffness_n_per_m = stiffness_n_per_m,
          .has_loop_delay = false,
          .fits_model = false,
          .make = [stiffness_n_per_m] { return std::make_unique<PureDelay>(stiffness_n_per_m); }};
}

StandKind benchmark_stand() {
  const TransferSystemModel model;
  return {.name = "benchmark actuator",
          .period_s = rths::kPeriodS,
          .delay_s = rths::nominal_delay_s(rths::Arrangement::straight),
          .mass_kg = model.mass_kg,
          .damping_n_s_per_m = model.damping_n_s_per_m,
          .stiffness_n_per_m = model.stiffness_n_per_m,
          .has_loop_delay = true,
          .fits_model = true,
          .make = [] { return std::make_unique<BenchmarkActuator>(); }};
}

}  // namespace hybridtest::character
