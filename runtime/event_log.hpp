#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "core/messages.hpp"
#include "core/ports.hpp"
#include "core/ring_port.hpp"

namespace spdlog {
class logger;
}

namespace hybridtest {

/// Where the events of one participant go: to the others, into its recording, and, once the
/// node has had its turn, to standard error and `events.log`.
class EventLog final : public Outbox<Event> {
 public:
  /// @param directory   of the run; `events.log` there is appended to.
  /// @param to_terminal   also to standard error, by which a participant started by hand speaks.
  EventLog(Outbox<Event>& network, Outbox<Event>& record, const std::filesystem::path& directory, bool to_terminal);
  ~EventLog() override;

  bool send(const Event& event) noexcept override;
  /// Writes what was sent since the last call. Not for a control thread.
  void write();

 private:
  Outbox<Event>& network_;
  Outbox<Event>& record_;
  RingPort<Event> waiting_;
  std::shared_ptr<spdlog::logger> logger_;
};

}  // namespace hybridtest
