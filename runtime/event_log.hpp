#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "core/messages.hpp"
#include "core/ports.hpp"
#include "core/ring_port.hpp"

namespace spdlog {
class logger;
}

namespace hybridtest {

/// Distributes the events of one participant: at once to the other participants and into its
/// recording; after the node has run, to standard error and `events.log`.
class EventLog final : public Outbox<Event> {
 public:
  /// @param directory   of the run; the events are appended to its `events.log`.
  /// @param to_terminal   also to standard error, with the time.
  EventLog(Outbox<Event>& network, Outbox<Event>& record, const std::filesystem::path& directory, bool to_terminal);
  ~EventLog() override;

  bool send(const Event& event) noexcept override;
  /// Writes the events sent since the last call. Not for a control thread.
  /// @param also   called with each of them, if given.
  void write(const std::function<void(const Event&)>& also = {});

 private:
  Outbox<Event>& network_;
  Outbox<Event>& record_;
  RingPort<Event> waiting_;
  std::shared_ptr<spdlog::logger> logger_;
};

}  // namespace hybridtest
