#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string_view>

namespace hybridtest {

/// A recorded file that is not part of the repository: it stands in `../shared/data` beside the checkout, and may be
/// absent.
inline std::filesystem::path shared_data(const std::filesystem::path& name) {
  return std::filesystem::path{HYBRIDTEST_SHARED_DATA} / name;
}

/// HYBRIDTEST_REQUIRE_DATA=1: absent data are a failure. Set where the data are known to be present, as in CI, so that
/// a wrong path does not silently switch comparisons off.
inline bool requires_shared_data() {
  const char* setting = std::getenv("HYBRIDTEST_REQUIRE_DATA");
  return setting != nullptr && std::string_view{setting} == "1";
}

}  // namespace hybridtest

/// Skips the test where `file` is absent; fails it there with HYBRIDTEST_REQUIRE_DATA=1. Leaves the current function,
/// so it stands in a test, in SetUp() or in the last function that a test calls.
#define HYBRIDTEST_NEEDS_DATA(file)                                                                     \
  do {                                                                                                  \
    const std::filesystem::path& needed_file = file;                                                    \
    if (!std::filesystem::exists(needed_file)) {                                                        \
      if (::hybridtest::requires_shared_data()) {                                                       \
        FAIL() << "recorded data are required (HYBRIDTEST_REQUIRE_DATA=1) and absent: " << needed_file; \
      }                                                                                                 \
      GTEST_SKIP() << "recorded data are absent: " << needed_file;                                      \
    }                                                                                                   \
  } while (false)
