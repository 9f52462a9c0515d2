#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config_error.hpp"
#include "runtime/participant_process.hpp"

namespace hybridtest {
namespace {

TEST(Distributable, RefusesMoreSubstructuresThanGoOverANetwork) {
  Scenario scenario;
  scenario.name = "frame";
  scenario.substructures.resize(kMaxSubstructures);
  EXPECT_NO_THROW(require_distributable(scenario));
  scenario.substructures.resize(kMaxSubstructures + 1);
  try {
    require_distributable(scenario);
    FAIL() << "33 substructures were accepted";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), ::testing::AllOf(::testing::HasSubstr("frame: 33 substructures"),
                                               ::testing::HasSubstr("has at most 32. Use `hybridtest simulate`")));
  }
}

}  // namespace
}  // namespace hybridtest
