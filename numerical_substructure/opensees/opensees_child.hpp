#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <optional>
#include <thread>
#include <vector>

#include "core/child_process.hpp"
#include "numerical_substructure/opensees/driver_channel.hpp"
#include "numerical_substructure/opensees/opensees_settings.hpp"

namespace hybridtest {

/// What an OpenSees is started for.
enum class OpenSeesPurpose : std::uint8_t { test, stiffness };

/// OpenSees with our driver in a process of its own. It ends with this object, and with this process.
class OpenSeesChild final : public DriverChannel {
 public:
  /// @param log    its output; empty: a temporary file.
  /// @param wake   called from another thread when a reply waits, or the process has ended; empty: nobody waits.
  /// @throws ConfigError where there is no OpenSees; std::runtime_error when it cannot be started.
  OpenSeesChild(const OpenSeesSettings& settings, OpenSeesPurpose purpose, const std::filesystem::path& log,
                std::function<void()> wake);
  ~OpenSeesChild() override;
  OpenSeesChild(const OpenSeesChild&) = delete;
  OpenSeesChild& operator=(const OpenSeesChild&) = delete;

  bool send(DriverRequest request, std::span<const double> displacements) noexcept override;
  [[nodiscard]] DriverArrival take(DriverReply& reply, Duration limit) noexcept override;
  [[nodiscard]] int exit_code() noexcept override;
  [[nodiscard]] std::string last_words() const override;

 private:
  /// Reads until `size` bytes are there. @return false at the end of the pipe, or of the time.
  [[nodiscard]] bool read_some(char* bytes, std::size_t size, Duration limit) noexcept;
  void watch() noexcept;

  std::size_t dofs_;
  std::filesystem::path folder_;  // temporary
  int requests_ = -1;
  int replies_ = -1;
  std::optional<ChildProcess> process_;
  std::vector<char> bytes_;  // kept, so that its memory is used again
  std::function<void()> wake_;
  std::atomic<int> asked_{0};  // requests sent; -1: the watch ends
  std::thread watch_;
};

}  // namespace hybridtest
