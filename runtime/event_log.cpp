#include "runtime/event_log.hpp"

#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include "core/event_text.hpp"

namespace hybridtest {
namespace {

spdlog::level::level_enum level_of(Severity severity) {
  switch (severity) {
    case Severity::information: return spdlog::level::info;
    case Severity::warning: return spdlog::level::warn;
    case Severity::fault: return spdlog::level::err;
  }
  return spdlog::level::info;
}

}  // namespace

EventLog::EventLog(Outbox<Event>& network, Outbox<Event>& record, const std::filesystem::path& directory,
                   bool to_terminal)
    : network_{network}, record_{record}, waiting_{256} {
  std::vector<spdlog::sink_ptr> sinks{
      std::make_shared<spdlog::sinks::basic_file_sink_st>((directory / "events.log").string())};
  if (to_terminal) sinks.push_back(std::make_shared<spdlog::sinks::stderr_sink_st>());
  logger_ = std::make_shared<spdlog::logger>("events", sinks.begin(), sinks.end());
  logger_->set_pattern("%Y-%m-%dT%H:%M:%S.%eZ %l %v", spdlog::pattern_time_type::utc);
  logger_->flush_on(spdlog::level::info);
  // A full disk must not end the test; the recorder reports it.
  logger_->set_error_handler([](const std::string&) {});
}

EventLog::~EventLog() = default;

bool EventLog::send(const Event& event) noexcept {
  network_.send(event);
  record_.send(event);
  return waiting_.send(event);
}

void EventLog::write(const std::function<void(const Event&)>& also) {
  Event event;
  while (waiting_.take(event)) {
    if (also) also(event);
    const std::string at =
        event.step == kNoStep ? "" : fmt::format(" [step {}, model time {:.4g} s]", event.step, event.model_time_s);
    logger_->log(level_of(event.severity), "{}: {}{}", event.source.view(), describe(event), at);
  }
}

}  // namespace hybridtest
