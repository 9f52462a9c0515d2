#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "validation/blind_batches/plant/plant.hpp"
#include "validation/blind_batches/plant/specimen.hpp"

/// The stages between the coordinator's displacement and the sensors' readings, each with its own state: sample by
/// sample in front of the actuator, fine step by fine step behind it.
namespace hybridtest::blind {

/// Sent by the coordinator -> received at the site, which holds the newest that has arrived. Packets may overtake
/// each other.
class NetworkStage {
 public:
  NetworkStage(const Site& site, const PlantEffects& effects);
  [[nodiscard]] double receive(double sent_m);

 private:
  std::vector<std::function<double()>> delays_;  // of the next packet, in samples; infinite when lost
  History sent_m_;
  std::vector<std::vector<std::size_t>> arriving_;  // packets that arrive at each sample
  std::size_t newest_ = 0;
};

/// Target -> command: the polynomial extrapolation of Horiuchi et al. (1999) as in
/// docs/scenario.md, by Neville's scheme.
class CompensatorStage {
 public:
  CompensatorStage(const Site& site, const PlantEffects& effects);
  [[nodiscard]] double command(double target_m);

 private:
  int order_;
  double ahead_samples_;
  double bias_m_ = 0.0;
  History target_m_;
};

/// What the servo loop makes of its command: an ordinary differential equation under straight command lines, by the
/// classical Runge-Kutta method, in as many steps as the fastest pole asks for.
class ServoLoop {
 public:
  /// x' = w (u - x).
  static ServoLoop first_order(double bandwidth_hz, double period_s);
  /// x'' = w^2 (u - x) - 2 zeta w x'.
  static ServoLoop second_order(double natural_frequency_hz, double damping_ratio, double period_s);
  [[nodiscard]] double next(double input);

 private:
  void follow_pole(double fastest_rad_per_s);
  void advance(double before, double input, double h);

  double period_s_ = 0.0;
  double steps_ = 1.0;  // in a period
  double w_ = 0.0;
  double damping_ratio_ = 0.0;
  bool has_two_poles_ = false;
  double input_ = 0.0;
  double x_ = 0.0;
  double v_ = 0.0;
};

/// Command -> true displacement of the actuator, with the effects of the transfer system. To be called once for
/// each fine step.
class ActuatorStage {
 public:
  ActuatorStage(const Site& site, const PlantEffects& effects, double period_s);
  /// @param load_n   force of the specimen at the step before.
  [[nodiscard]] double move(double command_m, double load_n);

 private:
  std::vector<std::function<double(double)>> parts_;
  std::function<double(double)> give_;  // of the frame under a force
};

/// True -> read values, without noise. To be called once for each fine step.
class SensorStage {
 public:
  /// @param interface   "force_sensor" or "displacement_sensor".
  SensorStage(const char* interface, const PlantEffects& effects, double period_s);
  /// @param motion   of the sensor's place: only effects outside the library use it.
  [[nodiscard]] double read(const MotionPoint& motion, double truth);

 private:
  std::vector<std::function<double(const MotionPoint&, double)>> parts_;
};

// The same over whole histories.

[[nodiscard]] History through_network(const Site& site, const PlantEffects& effects, const History& sent_m);
[[nodiscard]] History compensated(const Site& site, const PlantEffects& effects, const History& target_m);
/// Command at the recording's rate -> motion on the fine grid. An actuator without a servo loop follows a spline
/// through the commands.
[[nodiscard]] MotionHistory actuator_motion(const Site& site, const PlantEffects& effects, const History& command_m);
[[nodiscard]] History reading(const char* interface, const PlantEffects& effects, const MotionHistory& motion,
                              const History& truth);

}  // namespace hybridtest::blind
