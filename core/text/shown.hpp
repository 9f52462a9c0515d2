#pragma once

#include <string>
#include <string_view>
#include <vector>

/// Text from the user inside a message.
namespace hybridtest {

/// Made harmless and short: control characters replaced, at most about 60 bytes.
[[nodiscard]] std::string shown(std::string_view text);
/// `a, b, c`; the first 20 of a longer list.
[[nodiscard]] std::string listed(const std::vector<std::string>& names);
/// `; did you mean 'type'? Known here: a, b, c`, without the question where no known name is near.
/// @param label   of the list, in lower case: "known here".
[[nodiscard]] std::string name_advice(std::string_view name, const std::vector<std::string>& known,
                                      std::string_view label);

}  // namespace hybridtest
