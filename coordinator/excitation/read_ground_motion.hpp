#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "coordinator/excitation/ground_motion.hpp"
#include "core/ground_motion_facts.hpp"

namespace hybridtest {

enum class AccelerationUnit : std::uint8_t { g, m_per_s2, cm_per_s2 };

/// What the file does not contain.
struct GroundMotionOptions {
  /// Multiplies every value; any finite number.
  double scale = 1.0;
  /// Unit of the values. AT2 files without it are in g, as their header says; text files without
  /// it need a header whose acceleration column ends in `_m_per_s2`, `_cm_per_s2` or `_g`.
  std::optional<AccelerationUnit> unit;
  /// Step of a one-column file, where it is required. Where the file has its own step, both must agree.
  std::optional<double> dt_s;
};

/// Longest motion that is read; limits the memory (over an hour at 1 kHz).
inline constexpr std::size_t kGroundMotionPointsMax = 5'000'000;
/// Larger accelerations are a wrong unit or scale and would overflow later.
inline constexpr double kGroundAcceleration_m_per_s2_max = 1e6;
inline constexpr std::size_t kGroundMotionBytesMax = std::size_t{64} << 20U;

/// Reads a ground motion from one of
///
///   - PEER AT2 (the name ends in .AT2, or a line of the header holds NPTS): four header lines,
///     the one with the number of points and the step either as `NPTS= 1559, DT= .02000 SEC` or,
///     in older files, as `4000 .0050 NPTS, DT`; then the values by rows of any length; the first
///     value is at time 0;
///   - two columns, time in s and acceleration, separated by blanks or one comma, equally spaced
///     within one percent of the step, the first time not negative;
///   - one column, with GroundMotionOptions::dt_s, the first value at time 0.
///
/// In text files a first line of names and lines and line ends behind `#` are allowed. Line ends
/// of any system, also mixed, and a missing last one are accepted; numbers may have Fortran's D
/// exponent and no leading zero.
///
/// @throws ConfigError with file, line and what was expected: a file that cannot be read or is
///         empty; a velocity or displacement record; a header without count or step; a count that
///         disagrees with the header; text or numbers that are not finite among the values; uneven
///         spacing; an unknown unit; options out of range.
[[nodiscard]] GroundMotion read_ground_motion(const std::filesystem::path& file,
                                              const GroundMotionOptions& options = {});

/// The same from text. `name` is the file name in messages and for the choice of the format.
[[nodiscard]] GroundMotion parse_ground_motion(std::string_view text, const std::string& name,
                                               const GroundMotionOptions& options = {});

}  // namespace hybridtest
