#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "core/time.hpp"
#include "report/live/live_source.hpp"
#include "runtime/executor.hpp"

namespace hybridtest {

struct WatchServerSettings {
  std::string address = "127.0.0.1";  // an address of this host, numeric
  int port = 0;                       // 0: kWatchPort, or the next ones where it is taken
  /// Takes requests of the operator from whoever shows this token; empty: takes none.
  std::string token;
  /// For one request with its answer, and for a connection between two requests.
  Duration patience = std::chrono::seconds{5};
  /// Folder of the run whose report is served; empty: none.
  std::filesystem::path run_directory;
};

inline constexpr int kWatchPort = 8470;

/// A token of 256 bits from the random source of the operating system, in hexadecimal.
[[nodiscard]] std::string draw_token();

/// The web server of the live view; docs/watch.md describes its interface and what it refuses. It serves on threads of
/// its own, of lower priority than a test. Connections, their requests in size and time, and answers are limited, so
/// that no client holds up another one for long.
class WatchServer {
 public:
  /// Listens from here on.
  /// @param source, clock   must live longer.
  /// @throws ConfigError where the address or the port cannot be used.
  WatchServer(LiveSource& source, const ProcessClock& clock, const WatchServerSettings& settings);
  ~WatchServer();
  WatchServer(const WatchServer&) = delete;
  WatchServer& operator=(const WatchServer&) = delete;

  [[nodiscard]] int port() const noexcept;
  /// For the browser, with the token behind `#`, which browsers do not send.
  [[nodiscard]] std::string url() const;
  /// When a page asked last; the start when none has.
  [[nodiscard]] Instant last_asked() const noexcept;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace hybridtest
