#pragma once

#include <memory>
#include <utility>

#include "numerical_substructure/substructure_model.hpp"

namespace hybridtest {

/// A model whose forces and stiffness are multiplied by a factor; its history is unchanged.
class ScaledModel final : public SubstructureModel {
 public:
  /// @param model   not null.
  ScaledModel(std::unique_ptr<SubstructureModel> model, double factor) : model_{std::move(model)}, factor_{factor} {}

  [[nodiscard]] int interface_dofs() const noexcept override { return model_->interface_dofs(); }
  void trial(const InterfaceVector& displacement_m, const InterfaceVector& velocity_m_per_s,
             InterfaceVector& force_n) noexcept override {
    model_->trial(displacement_m, velocity_m_per_s, force_n);
    force_n *= factor_;
  }
  void commit() noexcept override { model_->commit(); }
  void revert() noexcept override { model_->revert(); }
  void reset() noexcept override { model_->reset(); }
  [[nodiscard]] InterfaceMatrix initial_stiffness_n_per_m() const override {
    return factor_ * model_->initial_stiffness_n_per_m();
  }

 private:
  std::unique_ptr<SubstructureModel> model_;
  double factor_;
};

}  // namespace hybridtest
