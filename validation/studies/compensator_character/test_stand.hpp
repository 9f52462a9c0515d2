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

/// A kind of test stand and its properties.
struct StandKind {
  const char* name;
  double period_s;
  double delay_s;  // given to the method
  double mass_kg;  // of the specimen: force = m a + c v + k x
  double damping_n_s_per_m;
  double stiffness_n_per_m;
  /// The structure receives the force of the previous sample and holds it over one, as in the benchmark; otherwise it
  /// receives the force of this sample.
  bool has_loop_delay;
  bool fits_model;  // methods that need the benchmark's model can be measured
  std::function<std::unique_ptr<TestStand>()> make;
};

/// The command arrives with a delay of 20 ms and is otherwise unchanged, at 1 kHz.
[[nodiscard]] StandKind pure_delay_stand();
/// The nominal plant of the virtual RTHS benchmark, at its rate.
[[nodiscard]] StandKind benchmark_stand();

}  // namespace hybridtest::character
