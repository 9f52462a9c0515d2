#pragma once

#include <cstdint>
#include <vector>

#include "core/messages.hpp"
#include "core/time.hpp"

namespace hybridtest {

/// Result of entering a measurement.
enum class LedgerEntry : std::uint8_t {
  accepted,   // the first answer of its substructure to the open command
  duplicate,  // this command has already been answered
  stale,      // an answer to a step or an iteration that is closed
  early,      // from the process that was armed, for a step that is not open yet: a site in real time ran ahead
  foreign,    // not from the process this test armed
};

/// State of the open command, which is a step and an iteration of it: which substructures have answered, and how long
/// it took. Each is completed exactly once, also when the network loses, repeats or reorders messages.
class StepLedger {
 public:
  explicit StepLedger(std::size_t substructures) : accounts_(substructures) {}

  /// Binds a substructure to the process that was armed; answers of others are foreign.
  void bind(SubstructureIndex substructure, Incarnation incarnation) noexcept;
  void open(Step step, std::uint16_t iteration, Instant now) noexcept;

  [[nodiscard]] LedgerEntry enter(const ForceMeasurement& measurement, Instant now) noexcept;

  [[nodiscard]] Step step() const noexcept { return step_; }
  [[nodiscard]] std::uint16_t iteration() const noexcept { return iteration_; }
  /// When the open command was sent.
  [[nodiscard]] Instant opened() const noexcept { return opened_; }
  [[nodiscard]] bool is_complete() const noexcept { return answered_ == accounts_.size(); }
  [[nodiscard]] bool has_answered(SubstructureIndex substructure) const noexcept {
    return accounts_[substructure].answered;
  }
  /// Puts a force in the place of an answer that missed its deadline. Its flags say so.
  void bridge(SubstructureIndex substructure, const InterfaceVector& force_n) noexcept;
  [[nodiscard]] bool is_bridged(SubstructureIndex substructure) const noexcept {
    return accounts_[substructure].answered && any(accounts_[substructure].answer.flags & MeasurementFlags::bridged);
  }
  /// The answer to the open command; valid once has_answered().
  [[nodiscard]] const ForceMeasurement& answer(SubstructureIndex substructure) const noexcept {
    return accounts_[substructure].answer;
  }
  /// From sending the command for the first time to its answer, the coordinator's clock.
  [[nodiscard]] Duration round_trip(SubstructureIndex substructure) const noexcept {
    return accounts_[substructure].round_trip;
  }
  /// How often the open command was sent: once unless repeated.
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

  std::size_t answered_ = 0;
  Step step_ = kNoStep;
  std::uint16_t iteration_ = 0;
  Instant opened_{};
  std::vector<Account> accounts_;  // by substructure
};

}  // namespace hybridtest
