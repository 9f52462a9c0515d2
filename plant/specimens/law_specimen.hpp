#pragma once

#include <memory>
#include <vector>

#include "mechanics/laws/law.hpp"
#include "plant/specimens/specimen.hpp"

namespace hybridtest {

/// One law per actuator, none coupled to another.
class LawSpecimen final : public Specimen {
 public:
  /// @param laws   1 to kMaxInterfaceDofs; null: no force.
  /// @throws ConfigError for another number.
  explicit LawSpecimen(std::vector<std::unique_ptr<Law>> laws);

  [[nodiscard]] int dofs() const noexcept override { return static_cast<int>(laws_.size()); }
  void impose(const InterfaceVector& displacement_m, const InterfaceVector& velocity_m_per_s,
              InterfaceVector& force_n) noexcept override;
  void reset() noexcept override;

 private:
  std::vector<std::unique_ptr<Law>> laws_;
};

}  // namespace hybridtest
