#pragma once

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "numerical_substructure/substructure_model.hpp"

namespace hybridtest {

/// The calls of a scripted substructure, in order.
struct SubstructureCalls {
  int trials = 0;
  int commits = 0;
  int reverts = 0;
  int resets = 0;
  std::vector<InterfaceVector> committed_m;  // displacement of each committed trial
};

/// A substructure made of a lambda that records its calls.
class ScriptedSubstructure final : public SubstructureModel {
 public:
  /// Restoring force [N] at a displacement [m]; `trial` counts from 0. May return another size.
  using Force = std::function<InterfaceVector(int trial, const InterfaceVector& displacement_m)>;

  /// @param calls   outlives the substructure.
  ScriptedSubstructure(int dofs, Force force, SubstructureCalls& calls)
      : dofs_{dofs}, force_{std::move(force)}, calls_{calls} {}

  [[nodiscard]] int interface_dofs() const noexcept override { return dofs_; }
  void trial(const InterfaceVector& displacement_m, const InterfaceVector&,
             InterfaceVector& force_n) noexcept override {
    tried_m_ = displacement_m;
    force_n = force_(calls_.trials++, displacement_m);
  }
  void commit() noexcept override {
    ++calls_.commits;
    calls_.committed_m.push_back(tried_m_);
  }
  void revert() noexcept override { ++calls_.reverts; }
  void reset() noexcept override { ++calls_.resets; }
  [[nodiscard]] InterfaceMatrix initial_stiffness_n_per_m() const override {
    return InterfaceMatrix::Identity(dofs_, dofs_);
  }

 private:
  int dofs_;
  Force force_;
  SubstructureCalls& calls_;
  InterfaceVector tried_m_;
};

/// Force of a linear spring at each degree of freedom.
[[nodiscard]] inline ScriptedSubstructure::Force linear_spring(double stiffness_n_per_m) {
  return [stiffness_n_per_m](int, const InterfaceVector& displacement_m) -> InterfaceVector {
    return stiffness_n_per_m * displacement_m;
  };
}

}  // namespace hybridtest
