#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "core/time.hpp"

namespace hybridtest {

/// A file of the operating system that is closed with this object.
class OwnedFile {
 public:
  OwnedFile() = default;
  explicit OwnedFile(int file) noexcept : file_{file} {}
  ~OwnedFile();
  OwnedFile(OwnedFile&& other) noexcept;
  OwnedFile& operator=(OwnedFile&& other) noexcept;
  OwnedFile(const OwnedFile&) = delete;
  OwnedFile& operator=(const OwnedFile&) = delete;

  [[nodiscard]] int get() const noexcept { return file_; }

 private:
  int file_ = -1;
};

/// A host of its own in this kernel: an unnamed network namespace with a loopback device and one TUN device. Whoever
/// holds tunnel() is the network of the host: it reads the IPv4 packets that the host sends, and writes those that it
/// shall receive.
///
/// The namespace belongs to this process and to the programs in it. Nothing of it is left when they have ended, however
/// they ended.
class EmulatedHost {
 public:
  /// Why hosts cannot be emulated here; empty where they can.
  [[nodiscard]] static std::string why_not();

  /// @param number         1 to 250; the address is 10.77.0.number.
  /// @param clock_offset   by which the monotonic clock of programs in this host is ahead; not negative.
  /// @throws std::runtime_error where hosts cannot be emulated.
  explicit EmulatedHost(int number, Duration clock_offset = Duration{0});

  [[nodiscard]] int number() const noexcept { return number_; }
  [[nodiscard]] std::string address() const;
  [[nodiscard]] int tunnel() const noexcept { return tunnel_.get(); }

  /// Runs the action in the host, on a thread of its own, and waits for its end. What the action opens and starts
  /// belongs to the host for good: sockets, and programs with their children.
  /// @throws what the action throws.
  void inside(const std::function<void()>& action) const;

 private:
  int number_;
  Duration clock_offset_;
  OwnedFile namespace_;
  OwnedFile tunnel_;
};

}  // namespace hybridtest
