#include "plant/specimens/law_specimen.hpp"

#include <string>
#include <utility>

#include "core/config_error.hpp"

namespace hybridtest {

LawSpecimen::LawSpecimen(std::vector<std::unique_ptr<Law>> laws) : laws_{std::move(laws)} {
  if (laws_.empty() || laws_.size() > kMaxSiteDofs) {
    throw ConfigError{"a specimen of " + std::to_string(laws_.size()) + " laws; expected 1 to " +
                      std::to_string(kMaxSiteDofs) + ", one per actuator"};
  }
}

void LawSpecimen::impose(const SiteVector& displacement_m, const SiteVector& velocity_m_per_s,
                         SiteVector& force_n) noexcept {
  for (std::size_t i = 0; i < laws_.size(); ++i) {
    const auto dof = static_cast<Eigen::Index>(i);
    force_n[dof] = 0.0;
    if (laws_[i] == nullptr) continue;
    force_n[dof] = laws_[i]->trial(displacement_m[dof], velocity_m_per_s[dof]);
    laws_[i]->commit();
  }
}

void LawSpecimen::reset() noexcept {
  for (const auto& law : laws_) {
    if (law != nullptr) law->reset();
  }
}

}  // namespace hybridtest
