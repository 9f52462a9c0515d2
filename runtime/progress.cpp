#include "runtime/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

#include "core/event_text.hpp"
#include "runtime/participant.hpp"

namespace hybridtest {
namespace {

constexpr Duration kOnTerminal = std::chrono::milliseconds{200};
constexpr Duration kInPlainText = std::chrono::seconds{5};

std::string clock_text(double seconds) {
  const auto whole = static_cast<long>(seconds + 0.5);
  return whole >= 60 ? fmt::format("{} min {:02} s", whole / 60, whole % 60) : fmt::format("{} s", whole);
}

}  // namespace

std::string_view name(LifecycleState state) noexcept {
  switch (state) {
    case LifecycleState::joining: return "joining";
    case LifecycleState::ready: return "ready";
    case LifecycleState::armed: return "armed";
    case LifecycleState::running: return "running";
    case LifecycleState::stopping: return "stopping";
    case LifecycleState::finished: return "finished";
    case LifecycleState::refused: return "refused";
    case LifecycleState::lost: return "lost";
  }
  return "unknown";
}

Progress::Progress(const Scenario& scenario, std::FILE* out)
    : scenario_{scenario}, out_{out}, is_terminal_{isatty(fileno(out)) == 1} {}

Progress::~Progress() {
  if (line_is_shown_) std::fputc('\n', out_);
}

void Progress::learn(const ParticipantStatus& status) {
  if (status.role == Role::operator_tool) return;
  const std::string id = status.id.text();
  const auto known = states_.find(id);
  if (known == states_.end() || known->second != status.state) {
    states_[id] = status.state;
    if (is_terminal_) next_show_ = Instant{};  // show it at once
  }
}

void Progress::learn(const SignalBlock& block) {
  if (block.sample_count > 0) signals_[block.substructure] = block.samples[block.sample_count - 1U];
}

void Progress::set_completed(Step step, Instant now) {
  if (step <= completed_) return;
  if (completed_ == 0) first_step_at_ = now;
  completed_ = step;
  last_step_at_ = now;
}

void Progress::print(const Event& event) {
  clear_line();
  const char* mark = event.severity == Severity::fault     ? "FAULT   "
                     : event.severity == Severity::warning ? "warning "
                                                           : "";
  fmt::print(out_, "{}{}: {}\n", mark, event.source.view(), describe(event));
  std::fflush(out_);
}

void Progress::show(Instant now) {
  if (now < next_show_) return;
  next_show_ = now + (is_terminal_ ? kOnTerminal : kInPlainText);
  clear_line();
  fmt::print(out_, "{}{}", line(), is_terminal_ ? "" : "\n");
  line_is_shown_ = is_terminal_;
  std::fflush(out_);
}

std::string Progress::line() const {
  const Step planned = scenario_.time.last_step;
  std::string text = fmt::format("step {}/{}  {:.2f} of {:.2f} s", completed_, planned,
                                 scenario_.model_time_s(completed_), scenario_.time.duration_s);
  const double elapsed_s = to_seconds(last_step_at_ - first_step_at_);
  if (completed_ > 0 && elapsed_s > 0.0) {
    const double rate = static_cast<double>(completed_) / elapsed_s;
    text +=
        fmt::format("  {:.0f} steps/s  {} left", rate, clock_text(static_cast<double>(planned - completed_) / rate));
  }
  if (states_.empty()) return text;  // no statuses, as in a simulation
  const auto add_state = [&](std::string_view id) {
    const auto known = states_.find(id);
    text += fmt::format("  {}: {}", id, known == states_.end() ? "not found yet" : name(known->second));
  };
  add_state(kCoordinatorId);
  for (const SubstructureScenario& substructure : scenario_.substructures) {
    add_state(substructure.id);
    const auto signal = signals_.find(scenario_.index_of(substructure));
    if (signal == signals_.end()) continue;
    text += fmt::format(" ({:+.1f} mm {:+.1f} kN)", signal->second.measured_displacement_m * 1e3,
                        signal->second.force_n * 1e-3);
  }
  return text;
}

void Progress::clear_line() {
  if (line_is_shown_) std::fputs("\r\033[K", out_);
  line_is_shown_ = false;
}

}  // namespace hybridtest
