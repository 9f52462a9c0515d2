#include <algorithm>
#include <array>
#include <cstring>

#include "coordinator/coordinator.hpp"

/// How a coordinator takes the place of one that died: it takes the recorded answers in their order. The source of
/// motion and the loads have no other input, so that it commands the same displacements again, bit for bit.
namespace hybridtest {
namespace {

[[nodiscard]] bool has_same_bits(const Eigen::Ref<const Eigen::VectorXd>& a,
                                 const Eigen::Ref<const Eigen::VectorXd>& b) noexcept {
  return a.size() == b.size() &&
         std::memcmp(a.data(), b.data(), sizeof(double) * static_cast<std::size_t>(a.size())) == 0;
}

}  // namespace

bool Coordinator::replay(const AnsweredCommand& recorded) noexcept {
  if (source_->next(Instant{}) != NextMotion::command || completed_steps_ > settings_.last_step) return false;
  open_command(Instant{});
  if (recorded.step != ledger_.step() || recorded.iteration != ledger_.iteration() ||
      recorded.is_trial != source_->is_trial()) {
    return false;
  }
  for (std::size_t i = 0; i < commands_.size(); ++i) {
    const CommandPoint& point = commands_[i].newest();
    if (!has_same_bits(point.displacement_m, recorded.displacement_m[i]) ||
        !has_same_bits(point.velocity_m_per_s, recorded.velocity_m_per_s[i])) {
      return false;
    }
    measurement_ = {};
    measurement_.substructure = static_cast<SubstructureIndex>(i);
    measurement_.step = recorded.step;
    measurement_.iteration = recorded.iteration;
    measurement_.force_n = recorded.force_n[i];
    if (ledger_.enter(measurement_, Instant{}) != LedgerEntry::accepted) return false;
  }
  if (!collect_forces(Instant{})) return false;
  record_answers();
  advance_source();
  if (recorded.is_trial) return true;
  recorded_steps_ = ++completed_steps_;
  fill_step_row(0.0);
  return true;
}

void Coordinator::record_answers() noexcept {
  if (record_.answers == nullptr) return;
  for (std::size_t i = 0; i < commands_.size(); ++i) {
    const CommandPoint& point = commands_[i].newest();
    const InterfaceVector& force_n = ledger_.answer(static_cast<SubstructureIndex>(i)).force_n;
    for (Eigen::Index k = 0; k < point.displacement_m.size(); ++k) {
      const std::array<double, 8> row{static_cast<double>(ledger_.step()),
                                      static_cast<double>(ledger_.iteration()),
                                      commands_[i].is_trial ? 1.0 : 0.0,
                                      static_cast<double>(i),
                                      static_cast<double>(k),
                                      point.displacement_m[k],
                                      point.velocity_m_per_s[k],
                                      force_n[k]};
      record_.answers->append(row);
    }
  }
}

bool Coordinator::everyone_goes_on() const noexcept {
  return std::ranges::all_of(settings_.substructures, [&](const CoupledSubstructure& substructure) {
    const Peer* peer = presence_.find(substructure.id);
    return peer != nullptr &&
           (peer->status.state == LifecycleState::ready || peer->status.state == LifecycleState::armed);
  });
}

TableLayout Coordinator::answers_layout() {
  return {"answers",
          {{"step", ""},
           {"iteration", ""},
           {"is_trial", ""},
           {"substructure", ""},
           {"interface_dof", ""},
           {"displacement_m", "m"},
           {"velocity_m_per_s", "m/s"},
           {"force_n", "N"}}};
}

}  // namespace hybridtest
