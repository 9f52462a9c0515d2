#pragma once

#include <gmock/gmock.h>

#include <fstream>
#include <string>
#include <vector>

#include "tests/support/system_fixture.hpp"

namespace hybridtest {

/// A TCP or UDP port that nobody uses now.
[[nodiscard]] int free_port();

/// The shipped two-storey test as its three programs, each as on a host of its own.
class AcrossHosts : public SystemTest {
 protected:
  /// Writes the file and returns its path.
  [[nodiscard]] std::string write(const std::string& name, const std::string& text) const;
  /// A network profile of this text after its first line, used in the domain of this test.
  [[nodiscard]] Arguments with_profile(const std::string& body) const;

  /// @param before   words before the program, such as those that enter a network namespace.
  [[nodiscard]] StartedProgram start(const std::string& program_name, const std::string& id, const Arguments& more,
                                     const Arguments& before = {}) const;
  /// The column that tells two runs apart, from `directory() / run`.
  [[nodiscard]] std::vector<double> displacement(const std::string& run) const;
  /// The same, simulated in one process.
  [[nodiscard]] std::vector<double> simulated(const Arguments& more = {}) const;
  /// Runs the three programs to their end, all with these arguments, and compares with simulated().
  void expect_bits_of_simulate(const Arguments& network_arguments, const Arguments& before_coordinator = {},
                               const Arguments& before_others = {}) const;
  /// An authority with a certificate for each of the names, in `directory() / folder`. @return false without openssl.
  [[nodiscard]] bool make_certificates(const std::string& folder, const std::vector<std::string>& names) const;

  static constexpr const char* kDuration = "time.duration_s=1";
  /// A busy machine loses nobody.
  static constexpr const char* kPatient = "timeouts={discovery_s: 60, liveliness_lease_s: 30}";
};

}  // namespace hybridtest
