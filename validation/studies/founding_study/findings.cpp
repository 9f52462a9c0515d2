#include "validation/studies/founding_study/findings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace hybridtest::founding {
namespace {

double largest(std::span<const double> values) {
  double most = 0.0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

double peak_force_n(const MethodRun& run) {
  double peak = 0.0;
  for (const auto& force_n : run.force_n) peak = std::max(peak, largest(force_n));
  return peak;
}

bool grows(const std::array<double, 4>& quarters) {
  return std::ranges::adjacent_find(quarters, std::greater_equal{}) == quarters.end();
}

}  // namespace

Distance distance_of(const MethodRun& run, const MethodRun& exact) {
  Distance distance;
  distance.name = run.name;
  distance.is_complete = run.reason == StopReason::completed;
  distance.interlock = run.interlock;
  distance.lasted_s = run.time_s.empty() ? 0.0 : run.time_s.back();
  for (std::size_t floor = 0; floor < kFloors; ++floor) {
    const auto& found = run.displacement_m[floor];
    const auto& wanted = exact.displacement_m[floor];
    double error_square = 0.0;
    double square = 0.0;
    double largest_error = 0.0;
    for (std::size_t i = 0; i < std::min(found.size(), wanted.size()); ++i) {
      const double error = found[i] - wanted[i];
      error_square += error * error;
      square += wanted[i] * wanted[i];
      largest_error = std::max(largest_error, std::abs(error));
    }
    distance.rms_percent[floor] = square > 0.0 ? 100.0 * std::sqrt(error_square / square) : 0.0;
    distance.peak_percent[floor] = 100.0 * largest_error / largest(wanted);
  }
  const double scale_n = peak_force_n(exact);
  for (const auto& force_n : run.force_n) {
    for (std::size_t i = 1; i < force_n.size(); ++i) {
      const double change = std::abs(force_n[i] - force_n[i - 1]) / scale_n;
      distance.largest_change_percent = std::max(distance.largest_change_percent, 100.0 * change);
      if (change > kJumpShare) ++distance.jumps;
    }
  }
  for (const double energy_j : run.energy_error_j) {
    if (std::abs(energy_j) > std::abs(distance.energy_error_j)) distance.energy_error_j = energy_j;
  }
  return distance;
}

double worst_rms_percent(const Distance& distance) { return std::ranges::max(distance.rms_percent); }

std::vector<std::size_t> best_first(std::span<const MethodRun> runs) {
  std::vector<std::size_t> order;
  for (std::size_t i = 1; i < runs.size(); ++i) order.push_back(i);
  std::ranges::stable_sort(order, {}, [&](std::size_t i) {
    const Distance distance = distance_of(runs[i], runs[0]);
    return distance.is_complete ? std::pair{0, worst_rms_percent(distance)} : std::pair{1, -distance.lasted_s};
  });
  return order;
}

std::array<double, 4> error_by_quarters_m(const MethodRun& run, const MethodRun& exact, std::size_t floor) {
  std::array<double, 4> quarters{};
  const std::size_t count = std::min(run.displacement_m[floor].size(), exact.displacement_m[floor].size());
  for (std::size_t i = 0; i < count; ++i) {
    double& quarter = quarters[4 * i / count];
    quarter = std::max(quarter, std::abs(run.displacement_m[floor][i] - exact.displacement_m[floor][i]));
  }
  return quarters;
}

std::vector<Finding> find(std::span<const MethodRun> runs) {
  const MethodRun& exact = runs[0];
  std::vector<Distance> distances;
  for (const MethodRun& run : runs) distances.push_back(distance_of(run, exact));
  const auto of = [&](std::string_view name) -> const Distance& {
    return *std::ranges::find(distances, name, &Distance::name);
  };
  const Distance& uncompensated = of("uncompensated");
  const Distance& displacement = of("polynomial_displacement");
  const Distance& force = of("polynomial_force");
  const Distance& newmark = of("newmark_kinematics");
  const Distance& quadratic = of("force_correction_quadratic");
  const Distance& corrected = of("force_correction");

  const auto quarters = error_by_quarters_m(runs[1], exact, 1);
  const double closest_of_study = std::max(worst_rms_percent(displacement), worst_rms_percent(newmark));
  return {
      {"Without compensation the delay acts as negative damping: the motion grows until an interlock ends the test",
       fmt::format(
           "largest error of floor 2 by quarters {:.2g}, {:.2g}, {:.2g}, {:.2g} mm; {:.0f} J added by the delay; {}",
           1e3 * quarters[0], 1e3 * quarters[1], 1e3 * quarters[2], 1e3 * quarters[3], -uncompensated.energy_error_j,
           uncompensated.interlock.empty() ? "no interlock" : uncompensated.interlock),
       !uncompensated.is_complete && !uncompensated.interlock.empty() && grows(quarters) &&
           uncompensated.energy_error_j < 0.0},
      {"Of the four methods of the study, extrapolation of the displacement and Newmark kinematics have the smallest "
       "errors",
       fmt::format("{:.2f} and {:.2f} % against {:.2f} and {:.2f} %", worst_rms_percent(displacement),
                   worst_rms_percent(newmark), worst_rms_percent(force), worst_rms_percent(quadratic)),
       displacement.is_complete && newmark.is_complete && closest_of_study < worst_rms_percent(force) &&
           closest_of_study < worst_rms_percent(quadratic)},
      {"Extrapolation of the force has larger errors than extrapolation of the displacement",
       fmt::format("{:.2f} against {:.2f} %", worst_rms_percent(force), worst_rms_percent(displacement)),
       worst_rms_percent(force) > 2.0 * worst_rms_percent(displacement)},
      {"Quadratic force correction jumps",
       fmt::format("{} jumps, the largest {:.0f} % of the peak force in one control period", quadratic.jumps,
                   quadratic.largest_change_percent),
       quadratic.jumps > 0},
      {"Our force correction does not jump, and the method becomes usable",
       fmt::format("{} jumps, largest change {:.2f} %; {:.2f} % error against {:.2f} %", corrected.jumps,
                   corrected.largest_change_percent, worst_rms_percent(corrected), worst_rms_percent(quadratic)),
       corrected.is_complete && corrected.jumps == 0 && worst_rms_percent(corrected) < worst_rms_percent(quadratic)},
  };
}

}  // namespace hybridtest::founding
