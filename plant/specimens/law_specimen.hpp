#pragma once

#include <memory>
#include <vector>

#include "mechanics/laws/law.hpp"
#include "plant/specimens/specimen.hpp"

namespace hybridtest {

/// One law per actuator, none coupled to another.
class LawSpecimen final : public Specimen {
 public:
  /// @param laws   1 to kMaxSiteDofs; null: no force.
  /// @throws ConfigError for another number.
  explicit LawSpecimen(std::vector<std::unique_ptr<Law>> laws);

  [[nodiscard]] int dofs() const noexcept override { return static_cast<int>(laws_.size()); }
  void impose(const SiteVector& displacement_m, const SiteVector& velocity_m_per_s,
              SiteVector& force_n) noexcept override;
  void reset() noexcept override;

 private:
  std::vector<std::unique_ptr<Law>> laws_;
};

}  // namespace hybridtest
