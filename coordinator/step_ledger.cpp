#include "coordinator/step_ledger.hpp"

#include "core/message_copies.hpp"

namespace hybridtest {

void StepLedger::bind(SubstructureIndex substructure, Incarnation incarnation) noexcept {
  accounts_[substructure].bound = incarnation;
}

void StepLedger::open(Step step, std::uint16_t iteration, Instant now) noexcept {
  step_ = step;
  iteration_ = iteration;
  opened_ = now;
  answered_ = 0;
  for (Account& account : accounts_) {
    account.answered = false;
    account.attempts = 0;
  }
}

LedgerEntry StepLedger::enter(const ForceMeasurement& measurement, Instant now) noexcept {
  if (measurement.substructure >= accounts_.size()) return LedgerEntry::foreign;
  Account& account = accounts_[measurement.substructure];
  if (measurement.sender != account.bound) return LedgerEntry::foreign;
  if (measurement.step != step_) return measurement.step > step_ ? LedgerEntry::early : LedgerEntry::stale;
  if (measurement.iteration != iteration_) {
    return measurement.iteration > iteration_ ? LedgerEntry::early : LedgerEntry::stale;
  }
  if (account.answered) return LedgerEntry::duplicate;
  account.answered = true;
  copy_message(measurement, account.answer);
  account.round_trip = now - opened_;
  ++answered_;
  return LedgerEntry::accepted;
}

void StepLedger::bridge(SubstructureIndex substructure, const InterfaceVector& force_n) noexcept {
  Account& account = accounts_[substructure];
  if (account.answered) return;
  account.answered = true;
  account.answer.step = step_;
  account.answer.iteration = iteration_;
  account.answer.force_n = force_n;
  account.answer.flags = MeasurementFlags::bridged;
  ++answered_;
}

}  // namespace hybridtest
