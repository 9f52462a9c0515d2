#pragma once

#include <utility>
#include <vector>

#include "plant/specimens/specimen.hpp"
#include "plant/transfer_systems/transfer_system.hpp"

namespace hybridtest {

/// The test piece of transfer systems whose model holds it: its force is that of the last step of each of them, with
/// inertia and damping.
class SpecimenInTransferSystem final : public Specimen {
 public:
  /// @param transfer_systems   one per actuator, which outlive every call; none null.
  explicit SpecimenInTransferSystem(std::vector<const TransferSystem*> transfer_systems)
      : transfer_systems_{std::move(transfer_systems)} {}

  [[nodiscard]] int dofs() const noexcept override { return static_cast<int>(transfer_systems_.size()); }
  void impose(const SiteVector& /*displacement_m*/, const SiteVector& /*velocity_m_per_s*/,
              SiteVector& force_n) noexcept override {
    for (std::size_t i = 0; i < transfer_systems_.size(); ++i) {
      force_n[static_cast<Eigen::Index>(i)] = transfer_systems_[i]->specimen_force_n();
    }
  }
  void reset() noexcept override {}  // the transfer systems are reset on their own

 private:
  std::vector<const TransferSystem*> transfer_systems_;
};

}  // namespace hybridtest
