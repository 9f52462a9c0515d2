#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/messages.hpp"
#include "core/time.hpp"

namespace hybridtest {

/// Result of entering a measurement.
enum class LedgerEntry : std::uint8_t {
  accepted,   // the first answer of its substructure to the open step
  duplicate,  // this step has already been answered
  stale,      // an answer to a step that is closed
  foreign,    // not from the process this test armed, or an unknown substructure or step
};

/// State of the open step: which substructures have answered, and how long it took. Each step is
/// completed exactly once, also when the network loses, repeats or reorders messages.
class StepLedger {
 public:
  explicit StepLedger(std::size_t substructures) noexcept : count_{substructures} {}

  /// Binds a substructure to the process that was armed; answers of others are foreign.
  void bind(SubstructureIndex substructure, Incarnation incarnation) noexcept;
  void open(Step step, Instant now) noexcept;

  [[nodiscard]] LedgerEntry enter(const ForceMeasurement& measurement, Instant now) noexcept;

  [[nodiscard]] Step step() const noexcept { return step_; }
  /// When the open step was sent.
  [[nodiscard]] Instant opened() const noexcept { return opened_; }
  [[nodiscard]] bool is_complete() const noexcept { return answered_ == count_; }
  [[nodiscard]] bool has_answered(SubstructureIndex substructure) const noexcept {
    return accounts_[substructure].answered;
  }
  /// The answer to the open step; valid once has_answered().
  [[nodiscard]] const ForceMeasurement& answer(SubstructureIndex substructure) const noexcept {
    return accounts_[substructure].answer;
  }
  /// From sending the command for the first time to its answer, the coordinator's clock.
  [[nodiscard]] Duration round_trip(SubstructureIndex substructure) const noexcept {
    return accounts_[substructure].round_trip;
  }
  /// Commands sent for the open step: 1 unless repeated.
  [[nodiscard]] std::uint16_t attempts(SubstructureIndex substructure) const noexcept {
    return accounts_[substructure].attempts;
  }
  void count_attempt(SubstructureIndex substructure) noexcept { ++accounts_[substructure].attempts; }

 private:
  struct Account {
    Incarnation bound = 0;
    bool answered = false;
    std::uint16_t attempts = 0;
    Duration round_trip{};
    ForceMeasurement answer;
  };

  std::size_t count_;
  std::size_t answered_ = 0;
  Step step_ = kNoStep;
  Instant opened_{};
  std::array<Account, kMaxSubstructures> accounts_{};
};

}  // namespace hybridtest
