#pragma once

#include <cstdlib>
#include <filesystem>

#include "tests/support/shared_data.hpp"

namespace hybridtest {

/// The OpenSees that tests run: that of HYBRIDTEST_OPENSEES, else `../shared/opensees/OpenSees` beside the checkout,
/// which is not part of the repository and may be absent.
inline std::filesystem::path test_opensees() {
  const char* variable = std::getenv("HYBRIDTEST_OPENSEES");
  if (variable != nullptr) return variable;
  return shared_data("../opensees/OpenSees").lexically_normal();
}

}  // namespace hybridtest

/// Skips the test where there is no OpenSees, in CI too: it is not part of the data. The programs that the test starts
/// find it by the environment variable.
#define HYBRIDTEST_NEEDS_OPENSEES()                                             \
  do {                                                                          \
    const std::filesystem::path needed_program = ::hybridtest::test_opensees(); \
    if (!std::filesystem::exists(needed_program)) {                             \
      GTEST_SKIP() << "there is no OpenSees: " << needed_program;               \
    }                                                                           \
    setenv("HYBRIDTEST_OPENSEES", needed_program.c_str(), 1);                   \
  } while (false)
