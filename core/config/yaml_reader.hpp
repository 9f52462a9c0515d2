#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "core/config/node.hpp"

namespace hybridtest::config {

/// Largest configuration that is read; limits memory and time.
inline constexpr std::size_t kBytesMax = std::size_t{4} << 20U;

/// Reads one YAML document into a tree that keeps places, quoting and key order.
///
/// Refused with a finding each, while reading goes on: duplicate keys (the first value stands),
/// keys that are no names, anchors, aliases, tags. Refused as a whole: what is not YAML or not
/// UTF-8, control characters, a second document, nesting below `depth_max`, more than kBytesMax.
///
/// @param path        of the document inside the configuration, for messages; empty for a file.
/// @return nothing when refused as a whole; a null node when there is nothing in the text.
[[nodiscard]] std::optional<Node> read_yaml(std::string_view text, const Source& source, std::string_view path,
                                            int depth_max, std::vector<Finding>& findings);

}  // namespace hybridtest::config
