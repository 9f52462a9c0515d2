#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "tests/support/system_fixture.hpp"

/// `launch/setup`, with stand-ins for all that installs, configures or builds: they write down that they were called.
namespace hybridtest {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Optional;

class Setup : public SystemTest {
 protected:
  void SetUp() override {
    std::filesystem::create_directory(stand_ins());
    for (const char* name : {"dpkg-query", "apt-get", "sudo", "mkdir", "cmake"}) {
      const std::filesystem::path file = stand_ins() / name;
      std::ofstream{file} << "#!/bin/sh\necho " << name << " >> '" << calls_file().string() << "'\n";
      std::filesystem::permissions(file, std::filesystem::perms::owner_all);
    }
  }
  [[nodiscard]] StartedProgram start_setup(const std::string& arguments) const {
    const std::string script = (std::filesystem::path{HYBRIDTEST_SOURCE_DIR} / "launch" / "setup").string();
    return {"/bin/sh",
            {"-c", "PATH='" + stand_ins().string() + "':\"$PATH\" exec '" + script + "' " + arguments},
            directory() / "setup"};
  }
  [[nodiscard]] std::string calls() const { return std::filesystem::exists(calls_file()) ? text_of(calls_file()) : ""; }
  void expect_wrong_call(const std::string& arguments, const std::string& why) const {
    StartedProgram setup = start_setup(arguments);
    EXPECT_THAT(setup.wait(), Optional(kExitConfiguration)) << arguments;
    EXPECT_THAT(setup.standard_error(), HasSubstr(why));
    EXPECT_THAT(setup.standard_error(), HasSubstr("launch/setup [--with-test-tools] PRESET [TARGET...]"));
    EXPECT_THAT(calls(), IsEmpty()) << arguments;
  }

 private:
  [[nodiscard]] std::filesystem::path stand_ins() const { return directory() / "stand_ins"; }
  [[nodiscard]] std::filesystem::path calls_file() const { return directory() / "calls"; }
};

TEST_F(Setup, HelpPrintsTheUsageAndInstallsNothing) {
  for (const char* arguments : {"--help", "-h", "release --help", "--with-test-tools -h"}) {
    StartedProgram setup = start_setup(arguments);
    EXPECT_THAT(setup.wait(), Optional(kExitCompleted)) << arguments;
    EXPECT_THAT(setup.standard_output(), HasSubstr("launch/setup [--with-test-tools] PRESET [TARGET...]"));
    EXPECT_THAT(calls(), IsEmpty()) << arguments;
  }
}

TEST_F(Setup, WrongCallEndsBeforeAnythingIsInstalled) {
  expect_wrong_call("", "PRESET is missing");
  expect_wrong_call("--with-test-tools", "PRESET is missing");
  expect_wrong_call("--verbose release", "unknown option --verbose");
  expect_wrong_call("release --with-tools", "unknown option --with-tools");
  expect_wrong_call("relaese", "'relaese' is no preset");
  expect_wrong_call("base", "'base' is no preset");  // others inherit it; it builds nothing
}

/// Control: the stand-ins are what the script calls.
TEST_F(Setup, RightCallInstallsAndBuilds) {
  StartedProgram setup = start_setup("release programs");
  EXPECT_THAT(setup.wait(), Optional(kExitCompleted)) << setup.standard_error();
  EXPECT_THAT(calls(), HasSubstr("dpkg-query"));
  EXPECT_THAT(calls(), ::testing::AnyOf(HasSubstr("apt-get"), HasSubstr("sudo")));
  EXPECT_THAT(calls(), HasSubstr("cmake"));
}

}  // namespace
}  // namespace hybridtest
