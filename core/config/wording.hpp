#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/config/node.hpp"

/// How the configuration's error messages put things.
namespace hybridtest::config {

/// Text from the user, made harmless and short for a message.
[[nodiscard]] std::string shown(std::string_view text);
/// The node as found: `the number 5`, `the text "abc"`, `a list`, `nothing`.
[[nodiscard]] std::string described(const Node& node);
/// `a, b, c`; of very many the first.
[[nodiscard]] std::string listed(const std::vector<std::string>& names);
/// `; did you mean 'type'? <Label>: a, b, c`, or without the question where nothing is near.
/// @param label   in lower case, such as "known here".
[[nodiscard]] std::string name_advice(std::string_view name, const std::vector<std::string>& known,
                                      std::string_view label);

}  // namespace hybridtest::config
