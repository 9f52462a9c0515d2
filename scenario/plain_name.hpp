#pragma once

#include <string_view>

namespace hybridtest {

/// Only letters, digits, '_', '-' and '.', the first not a '.': names become parts of file, partition and column names.
[[nodiscard]] bool is_plain_name(std::string_view name) noexcept;

/// The rule in words, for messages.
inline constexpr std::string_view kPlainNameRule = "letters, digits, '_', '-' or '.', the first not a '.'";

}  // namespace hybridtest
