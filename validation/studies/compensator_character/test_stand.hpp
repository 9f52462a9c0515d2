#pragma once

#include <functional>
#include <memory>

namespace hybridtest::character {

/// The transfer system with an elastic specimen on which a compensator is measured, one control sample at a time.
class TestStand {
 public:
  virtual ~TestStand() = default;
  /// Imposes the command over the coming control period.
  virtual void step(double command_m) noexcept = 0;
  [[nodiscard]] virtual double displacement_m() const noexcept = 0;
  [[nodiscard]] virtual double force_n() const noexcept = 0;
};

/// A kind of stand and what belongs to it.
struct StandKind {
  const char* name;
  double period_s;
  double delay_s;  // that a method is told
  double mass_kg;  // of the specimen: force = m a + c v + k x
  double damping_n_s_per_m;
  double stiffness_n_per_m;
  /// The structure gets the force of the sample before and holds it over one, as in the benchmark; otherwise that of
  /// this sample.
  bool has_loop_delay;
  bool fits_model;  // methods that need the benchmark's model can be measured
  std::function<std::unique_ptr<TestStand>()> make;
};

/// The command arrives 20 ms late and otherwise unchanged, at 1 kHz.
[[nodiscard]] StandKind pure_delay_stand();
/// The nominal plant of the virtual RTHS benchmark, at its rate.
[[nodiscard]] StandKind benchmark_stand();

}  // namespace hybridtest::character
