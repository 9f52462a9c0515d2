#include "tests/support/system_fixture.hpp"

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <iostream>
#include <stdexcept>

namespace hybridtest {
namespace {

/// Domains whose UDP ports lie below those that Linux hands out by itself.
constexpr int kDomains = 100;

int draw_domain() {
  static int drawn = 0;
  return 1 + (static_cast<int>(::getpid()) + 7 * drawn++) % kDomains;
}

std::filesystem::path make_directory() {
  std::string pattern = (std::filesystem::temp_directory_path() / "hybridtest_XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error{"no temporary directory"};
  return pattern;
}

std::string plain_test_name() {
  const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
  std::string name = std::string{info->test_suite_name()} + "." + info->name();
  std::ranges::replace_if(
      name, [](unsigned char c) { return std::isalnum(c) == 0 && c != '.'; }, '_');
  return name.substr(0, 48) + "." + std::to_string(::getpid());
}

}  // namespace

SystemTest::SystemTest() : directory_{make_directory()}, test_name_{plain_test_name()}, domain_{draw_domain()} {}

SystemTest::~SystemTest() {
  if (HasFailure()) {
    std::cout << "left for inspection: " << directory_.string() << '\n';
    return;
  }
  std::error_code ignored;
  std::filesystem::remove_all(directory_, ignored);
}

std::filesystem::path SystemTest::output(std::string run, const std::string& id) const {
  std::ranges::replace(run, '/', '_');
  return directory_ / (run + "." + id);
}

Arguments SystemTest::shared(const std::filesystem::path& scenario, const std::string& run,
                             const Arguments& more) const {
  Arguments arguments{scenario.string(), "--out", (directory_ / run).string(), "--set", "name=" + test_name_};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

StartedProgram SystemTest::start_run(const std::filesystem::path& scenario, const std::string& run,
                                     const Arguments& more, const ProgramOptions& options) const {
  Arguments arguments = shared(scenario, run, more);
  arguments.insert(arguments.begin(), "run");
  std::ranges::copy(network(), std::back_inserter(arguments));
  return {program("hybridtest"), arguments, output(run, "hybridtest"), options};
}

StartedProgram SystemTest::start_simulate(const std::filesystem::path& scenario, const std::string& run,
                                          const Arguments& more, const ProgramOptions& options) const {
  Arguments arguments = shared(scenario, run, more);
  arguments.insert(arguments.begin(), {"simulate", "--seed", "1"});
  return {program("hybridtest"), arguments, output(run, "hybridtest"), options};
}

StartedProgram SystemTest::start_participant(const std::string& program_name, const std::string& id,
                                             const std::filesystem::path& scenario, const std::string& run,
                                             const Arguments& more, const ProgramOptions& options) const {
  Arguments arguments = shared(scenario, run, more);
  arguments.insert(arguments.begin(), "--scenario");
  if (program_name != "coordinator") arguments.insert(arguments.end(), {"--id", id});
  std::ranges::copy(network(), std::back_inserter(arguments));
  arguments.emplace_back("--loopback-only");
  return {program(program_name), arguments, output(run, id), options};
}

StartedProgram SystemTest::start_hybridtest(const Arguments& arguments, const std::string& output) const {
  return {program("hybridtest"), arguments, directory_ / output, {.working_directory = directory_}};
}

bool SystemTest::has_recorded(const std::string& run, std::string_view participant, double step) const {
  return wait_until([&] { return recorded(run).last_step(participant) >= step; });
}

pid_t participant_of(const StartedProgram& run, std::string_view id) {
  return id == kCoordinatorId ? run.child({program("coordinator")}) : run.child({"--id", std::string{id}});
}

std::filesystem::path shipped_scenario(const std::string& name) {
  return std::filesystem::path{HYBRIDTEST_SOURCE_DIR} / "launch" / "scenarios" / (name + ".yaml");
}

std::filesystem::path system_scenario(const std::string& name) {
  return std::filesystem::path{HYBRIDTEST_SOURCE_DIR} / "tests" / "system" / "scenarios" / (name + ".yaml");
}

std::filesystem::path program(const std::string& name) { return std::filesystem::path{HYBRIDTEST_PROGRAM_DIR} / name; }

}  // namespace hybridtest
