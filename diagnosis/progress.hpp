#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string_view>

#include "core/time.hpp"

namespace hybridtest {

/// How far a long computation is.
struct ProgressReport {
  std::string_view stage;  // what is counted: `effects fitted one by one`
  std::size_t done = 0;
  std::size_t all = 0;
  double share = 0.0;           // of the whole computation, 0 to 1; it never decreases
  std::size_t predictions = 0;  // computed so far: it rises while a long fit goes on
};

/// Receives reports; one call at a time, from any thread.
using ProgressSink = std::function<void(const ProgressReport&)>;
/// Of the display, for alive(); called from any thread.
using ProgressClock = std::function<Instant()>;

/// The progress of a part of a computation, whose stages report their own counts. Stages are reported in their order;
/// a stage that is not needed is left out. All parts of a computation may be used from any thread.
class PartProgress {
 public:
  /// Reports to nobody.
  PartProgress() = default;
  /// Of the whole computation.
  /// @param now   without a clock, alive() reports nothing.
  explicit PartProgress(ProgressSink sink, ProgressClock now = {});

  /// @param from, to   0 to 1, of this part.
  [[nodiscard]] PartProgress part(double from, double to) const;

  /// One of several equal rounds, the first one being 0.
  [[nodiscard]] PartProgress round(std::size_t index, std::size_t rounds) const;

  /// @param done   of `all`, within this part; 0 at its beginning.
  void report(std::string_view stage, std::size_t done, std::size_t all) const;

  /// For a long step: counts a prediction, and repeats the last report if that was a second ago or more.
  void alive() const;

 private:
  struct Shared;

  std::shared_ptr<Shared> shared_;
  double from_ = 0.0;
  double to_ = 1.0;
};

}  // namespace hybridtest
