#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "core/interface_vector.hpp"
#include "core/messages.hpp"
#include "core/time.hpp"

namespace hybridtest {

/// What takes the place of a force that missed its deadline.
enum class BridgeType : std::uint8_t {
  hold,               // the last measured force
  polynomial,         // through the last measured forces
  initial_stiffness,  // the last measured force, and the initial stiffness times the displacement since
};

/// How a test in real time goes on without an answer.
struct BridgingSettings {
  BridgeType type = BridgeType::polynomial;
  int order = 1;              // of the polynomial, 1 to 3
  Duration deadline{};        // of an answer, after the time at which it is expected
  int most_in_a_row = 3;      // more than these end the test
  bool start_anyway = false;  // also when the rehearsed round trip does not fit into a step
};

/// A step that was bridged, looked at when measured forces are there again.
struct BridgedStep {
  Step step = kNoStep;
  int in_a_row = 0;  // its place in the gap, from 1
  /// Work that the bridged force did beyond the measured one, on the motion of the structure; positive: the structure
  /// gained it. NaN when no measured force followed. [J]
  double energy_added_j = 0.0;
  /// The measured force came late; otherwise it was interpolated between those beside the gap.
  bool came_late = false;
};

/// The forces of one substructure in a test in real time: those that were measured, and what stands in for those that
/// were not. Does not allocate after construction.
///
/// A polynomial of order k goes through the last k + 1 measured forces, whether their steps follow each other or not
/// (Lagrange), and is evaluated at the step that lacks one. Until there are as many, the order is lower.
class ForceBridge {
 public:
  /// @param stiffness_n_per_m   initial, over the interface; used by BridgeType::initial_stiffness alone.
  ForceBridge(const BridgingSettings& settings, Eigen::MatrixXd stiffness_n_per_m, Eigen::Index dofs);

  /// The force of a step, measured in time. Steps in order, each once, with this or with bridge().
  void take(Step step, const InterfaceVector& displacement_m, const InterfaceVector& force_n) noexcept;
  /// Puts a force in the place of one that was not measured.
  /// @return valid until the next call. At least one force has been measured before.
  [[nodiscard]] const InterfaceVector& bridge(Step step, const InterfaceVector& displacement_m) noexcept;
  /// A force that came after its deadline: later bridges start from it.
  void take_late(Step step, const InterfaceVector& force_n) noexcept;

  /// Those since the last call whose gap is closed: the last step was measured.
  /// @param ends   closes the gap at the end of the test as well, without a force behind it.
  [[nodiscard]] std::span<const BridgedStep> closed(bool ends = false) noexcept;

 private:
  struct Entry {
    Step step = kNoStep;
    InterfaceVector displacement_m;
    InterfaceVector force_n;     // that the integrator took
    InterfaceVector measured_n;  // valid if is_measured
    bool is_measured = false;
    bool is_bridged = false;
  };

  Entry& append(Step step, const InterfaceVector& displacement_m) noexcept;
  /// The n-th newest, from 0.
  [[nodiscard]] Entry& newest(std::size_t n) noexcept {
    return entries_[(next_ + entries_.size() - 1 - n) % entries_.size()];
  }
  [[nodiscard]] std::size_t kept() const noexcept { return std::min(count_, entries_.size()); }
  void extrapolate(Step step) noexcept;
  [[nodiscard]] double energy_of(std::size_t n, std::size_t before, std::size_t after) noexcept;

  BridgingSettings settings_;
  Eigen::MatrixXd stiffness_n_per_m_;
  std::vector<Entry> entries_;  // ring
  std::size_t next_ = 0;
  std::size_t count_ = 0;
  std::size_t open_ = 0;  // steps of the gap at the end
  InterfaceVector force_n_;
  InterfaceVector difference_;
  std::vector<BridgedStep> closed_;
};

}  // namespace hybridtest
