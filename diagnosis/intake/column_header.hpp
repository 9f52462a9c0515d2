#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "diagnosis/intake/raw_recording.hpp"

namespace hybridtest {

inline constexpr std::string_view kTimeColumn = "time_s";
/// Degrees of freedom of one site that are told apart by a suffix.
inline constexpr std::size_t kMostDofs = 12;

/// What a column is by its header: `measured_force_n` or `measured_force_n_2`, counted from 1.
/// @return nothing for a header that names no channel.
[[nodiscard]] std::optional<ChannelColumn> channel_of_header(std::string_view header);

/// Whether it is a column that a run's own tables and replays have and the diagnosis has no use for.
[[nodiscard]] bool is_left_aside(std::string_view header);

/// What to say of a header that is unknown: the nearest known name, and all of them.
[[nodiscard]] std::string unknown_column_advice(std::string_view header);

}  // namespace hybridtest
