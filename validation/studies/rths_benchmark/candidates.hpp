#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "compensation/force_compensator.hpp"
#include "validation/studies/rths_benchmark/control_path.hpp"

namespace hybridtest::rths {

/// The kind of a row of the study.
enum class Standing {
  yardstick,   // no compensation, the released controller
  published,   // as published
  variant,     // of a published method, with an addition that its authors did not have
  ours,        // this project's best for the benchmark
  our_variant  // ours with other settings, or another method of ours
};

/// One compensator of the study: its name in the tables and how to make it.
struct Candidate {
  std::string name;
  Standing standing = Standing::published;
  Arrangement arrangement = Arrangement::straight;
  std::string remark;  // for the summary
  std::function<std::unique_ptr<ControlPath>()> make_path;
  std::function<std::unique_ptr<ForceCompensator>()> make_force_compensator;
};

/// The compensator to which the targets of the study apply.
inline constexpr std::string_view kOurs = "adaptive_model_inverse";

/// Delay [s] of the nominal transfer system at 3.5 Hz, between the first frequencies of the four cases, half
/// a period of hold included. Methods that need only a delay receive this value. In the second arrangement
/// the transfer system is the plant within the benchmark's loop.
[[nodiscard]] double nominal_delay_s(Arrangement arrangement);

/// Every row of the study, in its order. Names end in `+pi` in the second arrangement.
[[nodiscard]] std::vector<Candidate> all_candidates();

/// The named ones, in the order of the study; without names, all of them. A name without `+pi` selects both
/// arrangements. @throws ConfigError for an unknown name, with the nearest known one.
[[nodiscard]] std::vector<Candidate> chosen_candidates(const std::vector<std::string>& names);

}  // namespace hybridtest::rths
