#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "coordinator/excitation/ground_motion.hpp"
#include "validation/studies/rths_benchmark/reference.hpp"

namespace hybridtest::rths {

inline constexpr std::array<const char*, 3> kMotionNames{"elcentro", "kobe", "morgan"};
inline constexpr std::size_t kMotions = kMotionNames.size();

/// The three motions and the reference of every case under each. Does not change once it is made.
class BenchmarkInputs {
 public:
  /// Reads `rths_benchmark_<name>.csv` (time in s, acceleration in m/s2), scales it and computes the references.
  /// @throws ConfigError naming the files that are missing or wrong.
  explicit BenchmarkInputs(const std::filesystem::path& ground_motions);

  [[nodiscard]] const GroundMotion& motion(std::size_t index) const noexcept { return motions_[index]; }
  /// @param case_number   1 to 4. @param motion   0 to 2.
  [[nodiscard]] const Reference& reference(int case_number, std::size_t motion) const noexcept {
    return references_[static_cast<std::size_t>(case_number - 1) * kMotions + motion];
  }

 private:
  std::vector<GroundMotion> motions_;
  std::vector<Reference> references_;
};

/// The directory with the ground motions of the benchmark: `given`, or else the environment variable
/// HYBRIDTEST_GROUND_MOTIONS.
/// @throws ConfigError when neither names one, with what to do next.
[[nodiscard]] std::filesystem::path ground_motion_directory(const std::filesystem::path& given);

}  // namespace hybridtest::rths
