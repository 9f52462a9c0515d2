#pragma once

#include <functional>
#include <memory>
#include <string>

#include "numerical_substructure/opensees/driver_channel.hpp"
#include "numerical_substructure/opensees/opensees_settings.hpp"
#include "numerical_substructure/substructure_model.hpp"

namespace hybridtest {

/// A substructure whose model is a script of OpenSees, which runs in a child process. It is in static equilibrium under
/// the displacements of its interface and the loads of the script. Displacements and forces are counted from the state
/// in which the script leaves the model.
class OpenSeesModel final : public SubstructureModel {
 public:
  /// Starts a driver and its model. @throws ConfigError.
  using OpenChannel = std::function<std::unique_ptr<DriverChannel>(const ModelSurroundings& surroundings)>;

  /// With OpenSees as the driver, see opensees_channel().
  explicit OpenSeesModel(OpenSeesSettings settings);
  OpenSeesModel(OpenSeesSettings settings, OpenChannel open);

  [[nodiscard]] int interface_dofs() const noexcept override { return static_cast<int>(settings_.interface.size()); }
  void start(const ModelSurroundings& surroundings) override;
  /// Blocks until the answer is there. Not finite where the model failed.
  void trial(const InterfaceVector& displacement_m, const InterfaceVector& velocity_m_per_s,
             InterfaceVector& force_n) noexcept override;
  /// Blocks likewise.
  void commit() noexcept override;
  void revert() noexcept override {}  // a trial leaves no trace
  /// Starts a new process, where steps have been taken.
  void reset() noexcept override;
  /// Of the settings, or asked from the model in a process of its own.
  [[nodiscard]] InterfaceMatrix initial_stiffness_n_per_m() const override;

  [[nodiscard]] ModelAnswer begin_trial(const InterfaceVector& displacement_m, const InterfaceVector& velocity_m_per_s,
                                        InterfaceVector& force_n, Instant now) noexcept override;
  [[nodiscard]] ModelAnswer begin_step(const InterfaceVector& displacement_m, const InterfaceVector& velocity_m_per_s,
                                       InterfaceVector& force_n, Instant now) noexcept override;
  [[nodiscard]] ModelAnswer take_answer(InterfaceVector& force_n, Instant now) noexcept override;
  [[nodiscard]] ModelFailure failure() const noexcept override { return failure_; }
  [[nodiscard]] std::string failure_text() const override;

 private:
  [[nodiscard]] ModelAnswer begin(DriverRequest request, const InterfaceVector& displacement_m,
                                  InterfaceVector& force_n, Instant now) noexcept;
  /// @param limit   of the wait, see DriverChannel::take().
  [[nodiscard]] ModelAnswer take(InterfaceVector& force_n, Duration limit) noexcept;
  ModelAnswer fail(ModelFailure failure, InterfaceVector& force_n) noexcept;
  void open();

  OpenSeesSettings settings_;
  OpenChannel open_;
  ModelSurroundings surroundings_;
  std::unique_ptr<DriverChannel> channel_;
  bool has_history_ = false;  // a step was taken since the process started
  InterfaceVector tried_m_;
  std::vector<double> displacements_;  // in the units of the script; kept, so that its memory is used again
  DriverReply reply_;
  Instant overdue_{};
  ModelFailure failure_;
  bool has_failed_ = false;
};

/// Waits for the model to stand.
/// @throws ConfigError with what the script said.
void require_ready(DriverChannel& channel, const OpenSeesSettings& settings);

/// Central differences at the interface of the model as the script leaves it, in a process that ends again. A second
/// call with the same script returns what the first one found.
/// @throws ConfigError where there is no OpenSees, or the script fails.
[[nodiscard]] InterfaceMatrix opensees_stiffness_n_per_m(const OpenSeesSettings& settings);

/// Units of the displacement [m or rad] and force [N or N m] at a degree of freedom, of one of the script.
[[nodiscard]] double displacement_unit(const OpenSeesSettings& settings, std::size_t dof) noexcept;
[[nodiscard]] double force_unit(const OpenSeesSettings& settings, std::size_t dof) noexcept;

}  // namespace hybridtest
