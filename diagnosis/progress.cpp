#include "diagnosis/progress.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <mutex>
#include <utility>

#include "diagnosis/tuning.hpp"

namespace hybridtest {

struct PartProgress::Shared {
  ProgressSink sink;
  ProgressClock clock;
  std::atomic<std::size_t> predictions = 0;
  std::mutex mutex;  // of the following, and of calls of the sink
  ProgressReport last;
  Instant last_at;

  void send() {
    last.predictions = predictions;
    if (clock) last_at = clock();
    sink(last);
  }
};

PartProgress::PartProgress(ProgressSink sink, ProgressClock now) {
  if (!sink) return;
  shared_ = std::make_shared<Shared>();
  shared_->sink = std::move(sink);
  shared_->clock = std::move(now);
  if (shared_->clock) shared_->last_at = shared_->clock();
}

PartProgress PartProgress::part(double from, double to) const {
  PartProgress inner = *this;
  inner.from_ = std::lerp(from_, to_, from);  // exact at the end: shares never decrease
  inner.to_ = std::lerp(from_, to_, to);
  return inner;
}

PartProgress PartProgress::round(std::size_t index, std::size_t rounds) const {
  const double length = 1.0 / static_cast<double>(rounds);
  return part(length * static_cast<double>(index), length * static_cast<double>(index + 1));
}

void PartProgress::report(std::string_view stage, std::size_t done, std::size_t all) const {
  if (!shared_) return;
  const double share = all > 0 ? static_cast<double>(done) / static_cast<double>(all) : 1.0;
  const std::scoped_lock lock{shared_->mutex};
  // A search that starts again goes through its stages once more.
  const double reached = std::max(shared_->last.share, std::lerp(from_, to_, share));
  shared_->last = {.stage = stage, .done = done, .all = all, .share = reached};
  shared_->send();
}

void PartProgress::alive() const {
  if (!shared_) return;
  ++shared_->predictions;
  if (!shared_->clock) return;
  const std::scoped_lock lock{shared_->mutex};
  const bool is_silent = shared_->clock() - shared_->last_at >= std::chrono::seconds{tuning::kSilence_s};
  if (is_silent && !shared_->last.stage.empty()) shared_->send();
}

}  // namespace hybridtest
