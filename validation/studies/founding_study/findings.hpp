#pragma once

#include <span>
#include <string>
#include <vector>

#include "validation/studies/founding_study/founding_study.hpp"

namespace hybridtest::founding {

/// A change of force by more than this share of the exact specimen's peak force from one control period to
/// the next is a jump. The exact force changes by less than a hundredth of its peak.
inline constexpr double kJumpShare = 0.05;

/// A method compared with the exact specimen, until its test ended.
struct Distance {
  std::string name;
  bool is_complete = false;
  std::string interlock;
  double lasted_s = 0.0;
  std::array<double, kFloors> rms_percent{};   // root mean square of the error over that of the exact displacement
  std::array<double, kFloors> peak_percent{};  // largest error over the largest exact displacement of the whole test
  double largest_change_percent = 0.0;         // of a force in one control period, over the exact peak force
  int jumps = 0;                               // changes over kJumpShare
  double energy_error_j = 0.0;                 // largest, negative: added to the structure
};

/// @param exact   of the same scenario; complete.
[[nodiscard]] Distance distance_of(const MethodRun& run, const MethodRun& exact);

/// The larger of the errors of the floors, root mean square [%].
[[nodiscard]] double worst_rms_percent(const Distance& distance);

/// Positions of the compared methods in `runs`, best first: completed tests by worst_rms_percent(), then the others,
/// the longest first.
/// @param runs   as from run_founding_study(); the exact specimen, which is first, is left out.
[[nodiscard]] std::vector<std::size_t> best_first(std::span<const MethodRun> runs);

/// Largest errors of the floors in each quarter of the test of a method [m]; they show growth.
[[nodiscard]] std::array<double, 4> error_by_quarters_m(const MethodRun& run, const MethodRun& exact,
                                                        std::size_t floor);

/// A finding of the study, and whether these runs show it.
struct Finding {
  std::string what;
  std::string shown_by;
  bool is_shown = false;
};

/// @param runs   as from run_founding_study().
[[nodiscard]] std::vector<Finding> find(std::span<const MethodRun> runs);

}  // namespace hybridtest::founding
