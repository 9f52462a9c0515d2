#include "runtime/progress.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <vector>

#include "core/event_text.hpp"
#include "core/text/short_number.hpp"
#include "runtime/participant.hpp"

namespace hybridtest {
namespace {

constexpr Duration kOnTerminal = std::chrono::milliseconds{200};
constexpr Duration kInPlainText = std::chrono::seconds{5};
/// Of events that are alike, this number is printed in each window; the others are counted.
constexpr Duration kRepeatWindow = std::chrono::seconds{10};
constexpr int kPrintedOfRepeats = 3;

/// Columns where there is no terminal to ask, or it does not know.
constexpr std::size_t kPlainWidth = 100;
constexpr std::size_t kWidthMin = 20;
/// For "  +32 sites".
constexpr std::size_t kRoomForRest = 11;
/// Of each state.
constexpr std::size_t kIdsShown = 2;

/// The last column stays free: a cursor in it would start a new line.
std::size_t terminal_width(std::FILE* terminal) {
  winsize size{};
  const bool is_known = ioctl(fileno(terminal), TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return is_known ? std::max<std::size_t>(kWidthMin, size.ws_col - 1U) : kPlainWidth;
}

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
    case LifecycleState::waiting: return "waiting for a resumed coordinator";
    case LifecycleState::lost: return "lost";
  }
  return "unknown";
}

Progress::Progress(const Scenario& scenario, std::FILE* out, std::vector<std::string> heard)
    : scenario_{scenario}, out_{out}, heard_{std::move(heard)}, is_terminal_{isatty(fileno(out)) == 1} {
  if (!heard_.empty()) return;
  heard_.emplace_back(kCoordinatorId);
  for (const SubstructureScenario& substructure : scenario.substructures) heard_.push_back(substructure.id);
}

Progress::~Progress() {
  print_repeated(kNever);
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
  if (block.group.view() != "control" || block.part != 0 || block.model_time_s.empty()) return;
  const auto newest = [&](std::string_view name) {
    const auto signal = std::ranges::find(block.signals, name, [](const LiveSignal& one) { return one.name.view(); });
    return signal == block.signals.end() ? 0.0 : signal->last.back();
  };
  readings_[block.participant.text()] = {newest("measured_displacement"), newest("force")};
}

void Progress::set_completed(Step step, Instant now) {
  if (step <= completed_) return;
  if (completed_ == 0) first_step_at_ = now;
  completed_ = step;
  last_step_at_ = now;
}

void Progress::print(const Event& event) {
  Repeated& repeated =
      repeated_[fmt::format("{}/{}/{}", event.source.view(), static_cast<int>(event.code), event.subject.view())];
  if (now_ >= repeated.window_end) {
    repeated.window_end = now_ + kRepeatWindow;
    repeated.printed = 0;
  }
  if (repeated.printed < kPrintedOfRepeats) {
    ++repeated.printed;
    print_line(event, "");
  } else {
    ++repeated.unprinted;
    repeated.last = event;
  }
}

void Progress::print_line(const Event& event, const std::string& suffix) {
  clear_line();
  const char* mark = event.severity == Severity::fault     ? "FAULT   "
                     : event.severity == Severity::warning ? "warning "
                                                           : "";
  fmt::print(out_, "{}{}: {}{}\n", mark, event.source.view(), describe(event), suffix);
  std::fflush(out_);
}

/// At the end of their window, the last of each kind that was left out, and how many there were.
void Progress::print_repeated(Instant now) {
  for (auto& [key, repeated] : repeated_) {
    if (repeated.unprinted == 0 || now < repeated.window_end) continue;
    print_line(repeated.last, repeated.unprinted == 1 ? "" : fmt::format(" ({} times more)", repeated.unprinted));
    repeated.unprinted = 0;
    if (now != kNever) repeated.window_end = now + kRepeatWindow;
  }
}

void Progress::show(Instant now) {
  now_ = now;
  print_repeated(now);
  if (now < next_show_) return;
  next_show_ = now + (is_terminal_ ? kOnTerminal : kInPlainText);
  clear_line();
  fmt::print(out_, "{}{}", line(is_terminal_ ? terminal_width(out_) : kPlainWidth), is_terminal_ ? "" : "\n");
  line_is_shown_ = is_terminal_;
  std::fflush(out_);
}

std::string Progress::line(std::size_t width) const {
  const Step planned = scenario_.time.last_step;
  std::string text = fmt::format("step {}/{}  {:.2f} of {:.2f} s", completed_, planned,
                                 scenario_.model_time_s(completed_), scenario_.time.duration_s);
  const double elapsed_s = to_seconds(last_step_at_ - first_step_at_);
  if (completed_ > 0 && elapsed_s > 0.0) {
    const double rate = static_cast<double>(completed_) / elapsed_s;
    text +=
        fmt::format("  {:.0f} steps/s  {} left", rate, clock_text(static_cast<double>(planned - completed_) / rate));
  }
  if (!states_.empty()) text += "  " + states();  // a simulation has no statuses
  std::size_t left_out = 0;
  for (const SubstructureScenario& substructure : scenario_.substructures) {
    const auto reading = readings_.find(substructure.id);
    if (reading == readings_.end()) continue;
    const std::string shown = fmt::format("  {} {} mm {} kN", substructure.id,
                                          short_number(reading->second.displacement_m * 1e3, 1, Sign::always),
                                          short_number(reading->second.force_n * 1e-3, 1, Sign::always));
    if (left_out > 0 || text.size() + shown.size() + kRoomForRest > width) {
      ++left_out;
    } else {
      text += shown;
    }
  }
  if (left_out > 0) text += fmt::format("  +{} sites", left_out);
  return text.size() <= width ? text : text.substr(0, width - 3) + "...";
}

/// `all 3 running`, or `ready: coordinator, storey_1; not found yet: storey_2`.
std::string Progress::states() const {
  std::map<std::string_view, std::vector<std::string_view>> groups;
  const auto add = [&](std::string_view id) {
    const auto known = states_.find(id);
    groups[known == states_.end() ? "not found yet" : name(known->second)].push_back(id);
  };
  for (const std::string& id : heard_) add(id);
  if (groups.size() == 1) return fmt::format("all {} {}", groups.begin()->second.size(), groups.begin()->first);
  std::string text;
  for (const auto& [state, ids] : groups) {
    text += fmt::format("{}{}:", text.empty() ? "" : "; ", state);
    for (std::size_t i = 0; i < ids.size() && i < kIdsShown; ++i)
      text += fmt::format("{} {}", i > 0 ? "," : "", ids[i]);
    if (ids.size() > kIdsShown) text += fmt::format(" +{}", ids.size() - kIdsShown);
  }
  return text;
}

void Progress::clear_line() {
  if (line_is_shown_) std::fputs("\r\033[K", out_);
  line_is_shown_ = false;
}

}  // namespace hybridtest
