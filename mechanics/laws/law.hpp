#pragma once

namespace hybridtest {

/// A uniaxial force-displacement law with history, tried and then committed.
///
/// trial() may be called any number of times from the committed state; commit() makes the last
/// trial the committed state; revert() forgets it. Force in N, positive when it resists a
/// positive displacement in m.
class Law {
 public:
  virtual ~Law() = default;

  /// Force at `displacement_m` reached from the committed state with `velocity_m_per_s` at the end.
  [[nodiscard]] virtual double trial(double displacement_m, double velocity_m_per_s) noexcept = 0;
  virtual void commit() noexcept = 0;
  virtual void revert() noexcept = 0;
  /// Back to the virgin state.
  virtual void reset() noexcept = 0;
  /// Tangent at the virgin state [N/m], for stability limits and damping.
  [[nodiscard]] virtual double initial_stiffness_n_per_m() const noexcept = 0;
  /// Reversals over no more than this distance [m] are noise of the displacement. A law whose force changes for good
  /// where it turns stays on its branch then, and is elastic from the branch to the displacement and back. Kept by
  /// reset(). Other laws do as before.
  virtual void ignore_reversals_within(double /*distance_m*/) noexcept {}
};

}  // namespace hybridtest
