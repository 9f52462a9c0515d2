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

/// As HYBRIDTEST_NEEDS_DATA, for OpenSees. The programs that the test starts find it by the environment variable.
#define HYBRIDTEST_NEEDS_OPENSEES()                     \
  HYBRIDTEST_NEEDS_DATA(::hybridtest::test_opensees()); \
  setenv("HYBRIDTEST_OPENSEES", ::hybridtest::test_opensees().c_str(), 1)
