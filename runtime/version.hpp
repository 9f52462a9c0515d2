#pragma once

#include <string_view>

namespace hybridtest {

inline constexpr std::string_view kVersion = HYBRIDTEST_VERSION;

}  // namespace hybridtest
