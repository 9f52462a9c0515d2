#include "coordinator/step_ledger.hpp"

namespace hybridtest {

void StepLedger::bind(SubstructureIndex substructure, Incarnation incarnation) noexcept {
  accounts_[substructure].bound = incarnation;
}

void StepLedger::open(Step step, Instant now) noexcept {
  step_ = step;
  opened_ = now;
  answered_ = 0;
  for (Account& account : std::span{accounts_}.first(count_)) {
    account.answered = false;
    account.attempts = 0;
  }
}

LedgerEntry StepLedger::enter(const ForceMeasurement& measurement, Instant now) noexcept {
  if (measurement.substructure >= count_) return LedgerEntry::foreign;
  Account& account = accounts_[measurement.substructure];
  if (measurement.sender != account.bound || measurement.step > step_) return LedgerEntry::foreign;
  if (measurement.step < step_) return LedgerEntry::stale;
  if (account.answered) return LedgerEntry::duplicate;
  account.answered = true;
  account.answer = measurement;
  account.round_trip = now - opened_;
  ++answered_;
  return LedgerEntry::accepted;
}

}  // namespace hybridtest
