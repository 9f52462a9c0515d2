#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "core/interface_vector.hpp"
#include "core/model_fault.hpp"
#include "core/time.hpp"

namespace hybridtest {

/// What a model that computes outside this process may use.
struct ModelSurroundings {
  std::filesystem::path log;   // its output; empty: a temporary file
  std::function<void()> wake;  // called from another thread when an answer waits; empty: nobody waits, calls block
};

/// Whether a force is there.
enum class ModelAnswer : std::uint8_t { ready, pending, failed };

/// Restoring force of a numerical substructure at its interface, with history.
///
/// A model inside this process has its force at once: it implements trial() and commit(). One that computes outside
/// implements begin_trial() and begin_step() as well, and may leave the force pending.
class SubstructureModel {
 public:
  virtual ~SubstructureModel() = default;

  [[nodiscard]] virtual int interface_dofs() const noexcept = 0;
  /// Starts what the model needs outside this process. Once, before the first trial; the initial stiffness needs no
  /// start.
  /// @throws ConfigError where it does not start.
  virtual void start(const ModelSurroundings& /*surroundings*/) {}
  /// Restoring force [N] at the displacement [m] reached from the committed state.
  /// @param force_n   sized interface_dofs() by the caller.
  virtual void trial(const InterfaceVector& displacement_m, const InterfaceVector& velocity_m_per_s,
                     InterfaceVector& force_n) noexcept = 0;
  virtual void commit() noexcept = 0;
  virtual void revert() noexcept = 0;
  virtual void reset() noexcept = 0;
  /// interface_dofs() square, symmetric [N/m].
  [[nodiscard]] virtual InterfaceMatrix initial_stiffness_n_per_m() const = 0;

  /// As trial(). While it is pending, take_answer() asks again.
  [[nodiscard]] virtual ModelAnswer begin_trial(const InterfaceVector& displacement_m,
                                                const InterfaceVector& velocity_m_per_s, InterfaceVector& force_n,
                                                Instant /*now*/) noexcept {
    trial(displacement_m, velocity_m_per_s, force_n);
    return ModelAnswer::ready;
  }
  /// As trial() and commit().
  [[nodiscard]] virtual ModelAnswer begin_step(const InterfaceVector& displacement_m,
                                               const InterfaceVector& velocity_m_per_s, InterfaceVector& force_n,
                                               Instant /*now*/) noexcept {
    trial(displacement_m, velocity_m_per_s, force_n);
    commit();
    return ModelAnswer::ready;
  }
  /// Of what was begun and was pending.
  [[nodiscard]] virtual ModelAnswer take_answer(InterfaceVector& /*force_n*/, Instant /*now*/) noexcept {
    return ModelAnswer::ready;
  }
  /// After an answer that failed.
  [[nodiscard]] virtual ModelFailure failure() const noexcept { return {}; }
  /// What it wrote before it failed, for the user; may be empty.
  [[nodiscard]] virtual std::string failure_text() const { return ""; }
};

}  // namespace hybridtest
