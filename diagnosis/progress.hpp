#pragma once

#include <cstddef>
#include <functional>
#include <string_view>
#include <utility>

namespace hybridtest {

/// How far a long computation is.
struct ProgressReport {
  std::string_view stage;  // what is counted: `effects fitted one by one`
  std::size_t done = 0;
  std::size_t all = 0;
  double share = 0.0;  // of the whole computation, 0 to 1; it never decreases
};

/// Receives reports; one call at a time, from any thread.
using ProgressSink = std::function<void(const ProgressReport&)>;

/// The progress of a part of a computation, whose stages report their own counts. Stages are reported in their order;
/// a stage that is not needed is left out.
class PartProgress {
 public:
  /// Reports to nobody.
  PartProgress() = default;
  /// Of the whole computation.
  explicit PartProgress(ProgressSink sink) : sink_{std::move(sink)} {}

  /// @param from, to   0 to 1, of this part.
  [[nodiscard]] PartProgress part(double from, double to) const;

  /// One of several equal rounds, the first one being 0.
  [[nodiscard]] PartProgress round(std::size_t index, std::size_t rounds) const;

  /// @param done   of `all`, within this part; 0 at its beginning.
  void report(std::string_view stage, std::size_t done, std::size_t all) const;

 private:
  ProgressSink sink_;
  double from_ = 0.0;
  double to_ = 1.0;
};

}  // namespace hybridtest
