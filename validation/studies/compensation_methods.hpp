#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "compensation/compensator.hpp"
#include "compensation/force_compensator.hpp"

namespace hybridtest {

/// What a method works with.
enum class MethodGroup {
  extrapolation,  // on commands, from a delay
  adaptive,       // on commands, from measurements or a model
  force           // on forces
};

/// A method of delay compensation as the studies compare it: a compensator on commands and one on forces,
/// with the parameters of its publication where there are any.
struct CompensationMethod {
  std::string name;
  MethodGroup group = MethodGroup::extrapolation;
  bool is_ours = false;
  bool needs_model = false;  // needs the model of the benchmark's transfer system; others get its delay only
  std::string remark;
  /// @param delay_s   of the transfer system at low frequency.
  std::function<std::unique_ptr<Compensator>(double delay_s, double period_s)> make_compensator;
  std::function<std::unique_ptr<ForceCompensator>(double delay_s, double period_s)> make_force_compensator;
};

/// Every method, `none` first.
[[nodiscard]] std::vector<CompensationMethod> compensation_methods();

/// Compensates a force that is one sample late and held over one sample: one and a half periods on average.
/// @param periods   of lead.
[[nodiscard]] std::unique_ptr<ForceCompensator> make_force_lead(double periods, double period_s);
inline constexpr double kLoopDelayPeriods = 1.5;

}  // namespace hybridtest
