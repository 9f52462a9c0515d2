#include "scenario/catalogue/transfer_systems.hpp"

#include <algorithm>
#include <numbers>

#include "core/time.hpp"
#include "plant/transfer_systems/delay.hpp"
#include "plant/transfer_systems/first_order.hpp"
#include "plant/transfer_systems/ideal.hpp"
#include "plant/transfer_systems/linear_servo_hydraulic.hpp"
#include "plant/transfer_systems/second_order.hpp"
#include "plant/transfer_systems/servo_hydraulic.hpp"

namespace hybridtest {
namespace {
using config::Section;

TransferSystemReading read_ideal(Section&) {
  return {.make = [](double, double) { return std::make_unique<Ideal>(); }};
}

TransferSystemReading read_delay(Section& section) {
  const double delay_s = read_parameters<Delay>(section).delay_s;
  return {.make =
              [delay_s](double period_s, double delay_change_s) {
                return std::make_unique<Delay>(from_seconds(delay_s + delay_change_s), from_seconds(period_s));
              },
          .delay_s = delay_s,
          .pure_delay_s = delay_s};
}

TransferSystemReading read_first_order(Section& section) {
  const auto parameters = read_parameters<FirstOrder>(section);
  const double time_constant_s = parameters.time_constant_s > 0.0
                                     ? parameters.time_constant_s
                                     : FirstOrder::time_constant_s_at(parameters.bandwidth_hz);
  return {.make = [time_constant_s](
                      double period_s,
                      double) { return std::make_unique<FirstOrder>(time_constant_s, from_seconds(period_s)); },
          .delay_s = time_constant_s,
          .has_bandwidth = true};
}

TransferSystemReading read_second_order(Section& section) {
  const auto parameters = read_parameters<SecondOrder>(section);
  const double delay_s = to_seconds(parameters.delay);
  return {.make =
              [parameters](double period_s, double delay_change_s) {
                SecondOrder::Parameters changed = parameters;
                changed.delay += from_seconds(delay_change_s);
                return std::make_unique<SecondOrder>(changed, from_seconds(period_s));
              },
          .delay_s = parameters.damping_ratio / (std::numbers::pi * parameters.natural_frequency_hz) + delay_s,
          .pure_delay_s = delay_s,
          .has_bandwidth = true};
}

TransferSystemReading read_servo_hydraulic(Section& section) {
  const auto p = read_parameters<ServoHydraulic>(section);
  // The loop's integrator, x' = Kp Qr / A (u - x), and the valve in front of it.
  const double loop_s = p.piston_area_m2 / (p.proportional_gain_per_m * p.rated_flow_m3_per_s);
  const double rate_s = p.derivative_gain_s_per_m / p.proportional_gain_per_m;
  return {.make = [p](double period_s, double) { return std::make_unique<ServoHydraulic>(p, from_seconds(period_s)); },
          .delay_s = std::max(0.0, loop_s - rate_s),
          .rating = {.displacement_m = p.stroke_m,
                     .velocity_m_per_s = p.rated_flow_m3_per_s / p.piston_area_m2,
                     .force_n = p.supply_pressure_pa * p.piston_area_m2}};
}

TransferSystemReading read_linear_servo_hydraulic(Section& section) {
  const auto parameters = read_parameters<LinearServoHydraulic>(section);
  const double range_m = parameters.converter_range_m;
  TransferSystemReading reading{.make =
                                    [parameters](double period_s, double) {
                                      return std::make_unique<LinearServoHydraulic>(parameters, from_seconds(period_s));
                                    },
                                .delay_s = parameters.model.low_frequency_delay_s(),
                                .specimen_stiffness_n_per_m = parameters.model.stiffness_n_per_m};
  if (range_m > 0.0) reading.rating.displacement_m = range_m;
  return reading;
}

}  // namespace

const std::vector<PartType<TransferSystemReading>>& transfer_systems() {
  static const std::vector<PartType<TransferSystemReading>> table{
      {"ideal", read_ideal},
      {"delay", read_delay, describe<Delay>},
      {"first_order", read_first_order, describe<FirstOrder>},
      {"second_order", read_second_order, describe<SecondOrder>},
      {"servo_hydraulic", read_servo_hydraulic, describe<ServoHydraulic>},
      {"linear_servo_hydraulic", read_linear_servo_hydraulic, describe<LinearServoHydraulic>},
  };
  return table;
}

TransferSystemReading read_transfer_system(Section section) { return read_type(section, transfer_systems()); }

}  // namespace hybridtest
