#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "core/child_process.hpp"
#include "runtime/network_options.hpp"

namespace hybridtest {

/// The live view of a test that `hybridtest run` has started: a process of its own, which stays until the test is over
/// and nobody looks any more.
class LivePage {
 public:
  explicit LivePage(std::unique_ptr<ChildProcess> process) : process_{std::move(process)} {}

  /// After the test: tells how long the page stays.
  void tell_end();

 private:
  std::unique_ptr<ChildProcess> process_;
};

/// Starts it and prints its address.
/// @throws std::runtime_error when it does not start.
[[nodiscard]] LivePage start_live_page(const std::string& test_name, const std::filesystem::path& run_directory,
                                       const NetworkOptions& network, bool allow_control);

}  // namespace hybridtest
