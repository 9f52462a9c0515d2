#pragma once

#include "core/parameters/parameter_archive.hpp"
#include "mechanics/laws/law.hpp"
#include "mechanics/laws/presliding_element.hpp"

namespace hybridtest {

/// Dry friction (Coulomb, 1785), elastoplastic before it slides; see PreslidingElement.
class Friction final : public Law {
 public:
  struct Parameters {
    double friction_force_n = 0.0;
    double presliding_displacement_m = 1e-5;

    void serialize(ParameterArchive& archive) {
      archive.required("friction_force_n", friction_force_n, {kNotNegative, "while sliding"});
      archive.optional("presliding_displacement_m", presliding_displacement_m,
                       {kPositive, "from rest until it slides"});
    }
  };

  /// @throws ConfigError for values outside these ranges.
  explicit Friction(const Parameters& parameters);

  [[nodiscard]] double trial(double displacement_m, double velocity_m_per_s) noexcept override;
  void commit() noexcept override { committed_ = trial_; }
  void revert() noexcept override { trial_ = committed_; }
  void reset() noexcept override;
  [[nodiscard]] double initial_stiffness_n_per_m() const noexcept override;

 private:
  Parameters parameters_;
  PreslidingElement committed_;
  PreslidingElement trial_;
};

}  // namespace hybridtest
