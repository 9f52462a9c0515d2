#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "diagnosis/intake/finding.hpp"
#include "diagnosis/intake/raw_recording.hpp"
#include "diagnosis/recording.hpp"

namespace hybridtest {

/// What became of a recording: itself, or everything that is wrong with it.
struct Intake {
  std::optional<Recording> recording;  // without its hash and role, which the reader of the file knows
  std::vector<IntakeFinding> findings;
};

/// A recording shorter than this tells nothing.
inline constexpr std::size_t kLeastSamples = 16;

/// Takes a recording from CSV: a header of names and units (`time_s`, and any of column_name(), with
/// `_1`, `_2` … for several degrees of freedom), one row per sample, SI.
///
/// Columns of a run's own tables that are no channel are left aside; any other unknown one is a
/// finding, and so is everything of check_recording().
/// @param file   as the user named it.
[[nodiscard]] Intake read_csv_recording(std::string_view text, const std::string& file);

/// Checks what was read: every value finite, sampling even and without gaps (check_sampling()),
/// units plausible (check_units()), degrees of freedom without a hole, samples enough.
[[nodiscard]] Intake check_recording(RawRecording raw);

}  // namespace hybridtest
