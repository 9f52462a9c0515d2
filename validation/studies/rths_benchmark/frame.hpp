#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

#include "compensation/transfer_system_model.hpp"
#include "coordinator/excitation/ground_motion.hpp"
#include "validation/studies/rths_benchmark/constants.hpp"

namespace hybridtest::rths {

/// The three-storey frame of the benchmark, or its numerical part without the specimen:
///
///     M x'' + C x' + K x = -M_full 1 a_g - [f, 0, 0]'
///
/// f is the force of the specimen on floor 1. The load is that of the full mass, the specimen's included.
class Frame {
 public:
  using Floors = std::array<double, kFloors>;
  using State = std::array<double, 2 * kFloors>;  // displacements [m], velocities [m/s]

  /// @param case_number   1 to 4. @throws ConfigError for others.
  static Frame of_case(int case_number);

  /// Without mass, damping and stiffness of the specimen at floor 1.
  [[nodiscard]] Frame without(const TransferSystemModel& specimen) const noexcept;

  /// Whether matrices of 3 x 3 are the masses, the damping and the stiffness of this frame, to nine digits.
  [[nodiscard]] bool equals(const Eigen::Ref<const Eigen::Matrix3d>& mass_kg,
                            const Eigen::Ref<const Eigen::Matrix3d>& damping_n_s_per_m,
                            const Eigen::Ref<const Eigen::Matrix3d>& stiffness_n_per_m) const noexcept;

  /// [m/s2] at a state.
  [[nodiscard]] Floors acceleration(std::span<const double, 2 * kFloors> state, double ground_m_per_s2,
                                    double specimen_force_n) const noexcept;

  /// Advances by one sample period, with the ground motion interpolated at the stages and the force held.
  void step(State& state, const GroundMotion& motion, double time_s, double specimen_force_n) const noexcept;

 private:
  using Matrix = std::array<Floors, kFloors>;

  double mass_kg_ = 0.0;             // of each floor of the full structure
  double mass_of_floor_1_kg_ = 0.0;  // of this part
  Matrix damping_n_s_per_m_{};
  Matrix stiffness_n_per_m_{};
};

}  // namespace hybridtest::rths
