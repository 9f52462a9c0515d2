#include "validation/studies/study_progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

namespace hybridtest {
namespace {

constexpr Duration kOnTerminal = std::chrono::milliseconds{200};
constexpr Duration kInPlainText = std::chrono::seconds{10};

}  // namespace

StudyProgress::StudyProgress(std::size_t runs, std::FILE* out)
    : runs_{runs}, out_{out}, is_terminal_{out != nullptr && isatty(fileno(out)) != 0} {}

StudyProgress::~StudyProgress() {
  if (is_terminal_ && completed_ > 0) std::fputc('\n', out_);
}

void StudyProgress::completed(std::string_view what) {
  const std::scoped_lock lock{mutex_};
  ++completed_;
  if (out_ != nullptr) show(what);
}

void StudyProgress::show(std::string_view what) {
  const Instant now = clock_.now();
  if (now < next_show_ && completed_ < runs_) return;
  next_show_ = now + (is_terminal_ ? kOnTerminal : kInPlainText);
  const double elapsed_s = to_seconds(now.time_since_epoch());
  const double left_s = elapsed_s / static_cast<double>(completed_) * static_cast<double>(runs_ - completed_);
  const auto whole_s = static_cast<long>(left_s + 0.5);
  fmt::print(out_, "{}run {}/{}  {:02}:{:02} left  {}{}", is_terminal_ ? "\r\033[K" : "", completed_, runs_,
             whole_s / 60, whole_s % 60, what, is_terminal_ ? "" : "\n");
  std::fflush(out_);
}

}  // namespace hybridtest
