#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>

#include "transport/fast_dds/fast_dds_settings.hpp"

namespace hybridtest {

/// What an intruder in a test of two substructures tries.
struct IntruderMeans {
  bool stops = false;            // sends emergency stops, as an operator
  bool commands = false;         // sends displacements to the first substructure, as the coordinator
  bool forges_storey_2 = false;  // joins as the first substructure and sends forces of the second
};

/// A participant that does not keep to the rules: it listens to the statuses of the test to copy the identities of the
/// others, and sends what it should not in a thread of its own until it is destroyed.
class Intruder {
 public:
  /// @param ears   with which it listens to the statuses.
  Intruder(const fast_dds::FastDdsSettings& settings, const fast_dds::FastDdsSettings& ears,
           const std::string& test_name, IntruderMeans means);
  ~Intruder();
  Intruder(const Intruder&) = delete;
  Intruder& operator=(const Intruder&) = delete;

  /// Rounds of sending everything.
  [[nodiscard]] std::uint64_t attempts() const noexcept { return attempts_; }
  /// Statuses of participants that it heard.
  [[nodiscard]] std::uint64_t heard() const noexcept { return heard_; }
  /// The writer that forges forces has left the partition that it was made in.
  [[nodiscard]] bool has_moved() const noexcept;

 private:
  struct Ports;
  void intrude();

  std::unique_ptr<Ports> ports_;
  std::atomic<bool> ends_{false};
  std::atomic<bool> has_moved_{false};
  std::atomic<std::uint64_t> attempts_{0};
  std::atomic<std::uint64_t> heard_{0};
  std::thread thread_;
};

}  // namespace hybridtest
