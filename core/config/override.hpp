#pragma once

#include <string_view>
#include <vector>

#include "core/config/node.hpp"

namespace hybridtest::config {

/// Puts one `key.path=value` into the tree.
///
/// The path names existing mappings and list elements (`[2]`, or `[id]` for the element whose
/// `id` is that text); only its last key may be new. What does not fit becomes a finding and
/// leaves the tree alone.
///
/// @param source   filled with the override's name; must outlive the tree.
void apply_override(std::string_view assignment, Source& source, Node& root, std::vector<Finding>& findings);

}  // namespace hybridtest::config
