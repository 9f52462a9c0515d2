#pragma once

#include <memory>
#include <string>
#include <utility>

#include "numerical_substructure/substructure_model.hpp"

namespace hybridtest {

/// A model whose forces and stiffness are multiplied by a factor; its history is unchanged.
class ScaledModel final : public SubstructureModel {
 public:
  /// @param model   not null.
  ScaledModel(std::unique_ptr<SubstructureModel> model, double factor) : model_{std::move(model)}, factor_{factor} {}

  [[nodiscard]] int interface_dofs() const noexcept override { return model_->interface_dofs(); }
  void start(const ModelSurroundings& surroundings) override { model_->start(surroundings); }
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
  [[nodiscard]] ModelAnswer begin_trial(const InterfaceVector& displacement_m, const InterfaceVector& velocity_m_per_s,
                                        InterfaceVector& force_n, Instant now) noexcept override {
    return scaled(model_->begin_trial(displacement_m, velocity_m_per_s, force_n, now), force_n);
  }
  [[nodiscard]] ModelAnswer begin_step(const InterfaceVector& displacement_m, const InterfaceVector& velocity_m_per_s,
                                       InterfaceVector& force_n, Instant now) noexcept override {
    return scaled(model_->begin_step(displacement_m, velocity_m_per_s, force_n, now), force_n);
  }
  [[nodiscard]] ModelAnswer take_answer(InterfaceVector& force_n, Instant now) noexcept override {
    return scaled(model_->take_answer(force_n, now), force_n);
  }
  [[nodiscard]] ModelFailure failure() const noexcept override { return model_->failure(); }
  [[nodiscard]] std::string failure_text() const override { return model_->failure_text(); }

 private:
  ModelAnswer scaled(ModelAnswer answer, InterfaceVector& force_n) const noexcept {
    if (answer == ModelAnswer::ready) force_n *= factor_;
    return answer;
  }

  std::unique_ptr<SubstructureModel> model_;
  double factor_;
};

}  // namespace hybridtest
