#pragma once

#include <memory>
#include <utility>

#include "compensation/compensator.hpp"

namespace hybridtest::rths {

/// The inputs of the controller of the benchmark at one sample.
struct ControlSample {
  double target_m = 0.0;                      // x_n1
  double target_velocity_m_per_s = 0.0;       // of the numerical part
  double target_acceleration_m_per_s2 = 0.0;  // likewise, with the force of the sample before
  double measured_displacement_m = 0.0;       // of this sample
  double previous_displacement_m = 0.0;       // of the sample before
  double previous_force_n = 0.0;              // likewise
};

/// The signal path between the numerical part and the plant, converters included.
class ControlPath {
 public:
  virtual ~ControlPath() = default;
  /// The command [m] that the plant holds until the next sample.
  [[nodiscard]] virtual double command(const ControlSample& sample) noexcept = 0;
};

/// The benchmark's proportional-integral loop on the displacement, Kp = 2, Ki = 95, Tustin:
///
///     e = Q(S(input - x_m)),   u = S(Q(Kp e + Ki (integral of e)))
class ReleasedLoop {
 public:
  [[nodiscard]] double command(double input_m, double measured_displacement_m) noexcept;

 private:
  double error_m_ = 0.0;
  double integral_ = 0.0;
};

/// The controller released with the benchmark: the lead (50.83 s + 8570.4)/(s + 8570.4), Tustin, and the
/// loop behind it.
class ReleasedController final : public ControlPath {
 public:
  [[nodiscard]] double command(const ControlSample& sample) noexcept override;

 private:
  ReleasedLoop loop_;
  double input_m_ = 0.0;
  double output_m_ = 0.0;
};

/// The transfer system that a compensator has to compensate.
enum class Arrangement {
  straight,  // its command goes to the plant
  with_pi,   // its command is the input of the benchmark's loop
};

/// A compensator that receives the measurements of the previous sample.
class CompensatedPath final : public ControlPath {
 public:
  CompensatedPath(std::unique_ptr<Compensator> compensator, Arrangement arrangement)
      : compensator_{std::move(compensator)}, arrangement_{arrangement} {}

  [[nodiscard]] double command(const ControlSample& sample) noexcept override;

 private:
  std::unique_ptr<Compensator> compensator_;
  Arrangement arrangement_;
  ReleasedLoop loop_;
};

}  // namespace hybridtest::rths
