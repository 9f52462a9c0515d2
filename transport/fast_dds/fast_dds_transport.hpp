#pragma once

#include <memory>
#include <string_view>

#include "transport/fast_dds/fast_dds_settings.hpp"
#include "transport/transport.hpp"

namespace hybridtest::fast_dds {

/// Joins a test over DDS: one DomainParticipant, in the partition named as the test.
///
/// Threads of Fast DDS fill the inboxes; the ports may be used from any one thread each. All
/// ports must be gone before the transport.
///
/// @param test_name   1 to 64 characters without `*?[]/`, which have a meaning in partitions.
/// @throws ConfigError for such a name, and for settings as require_usable().
/// @throws std::runtime_error when Fast DDS refuses: no free port.
[[nodiscard]] std::unique_ptr<Transport> make_fast_dds_transport(const FastDdsSettings& settings,
                                                                 std::string_view test_name);

/// An observer of all tests on a network: one DDS participant, whatever the number of tests that it joins.
class TestSearch {
 public:
  virtual ~TestSearch() = default;

  /// Signalled by whatever arrives, in any of the tests.
  [[nodiscard]] virtual Waker& waker() noexcept = 0;
  /// Announcements of every test that can be heard.
  [[nodiscard]] virtual std::unique_ptr<Inbox<TestAnnouncement>> announcements() = 0;
  /// Observes one of them. The counters are those of all tests together.
  /// @throws ConfigError for a name as make_fast_dds_transport().
  [[nodiscard]] virtual std::unique_ptr<Transport> join(std::string_view test_name) = 0;
};

/// Its readers are those of an observer that reads best effort, see FastDdsSettings. All ports must be gone before the
/// search, and the transports that it made.
/// @throws ConfigError, std::runtime_error as make_fast_dds_transport().
[[nodiscard]] std::unique_ptr<TestSearch> make_test_search(FastDdsSettings settings);

}  // namespace hybridtest::fast_dds
