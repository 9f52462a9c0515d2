#pragma once

#include <cstddef>
#include <vector>

#include "validation/blind_batches/plant/plant.hpp"

/// A hybrid test as a whole: a shear building, of which one or two storeys stand in the laboratory, under a ground
/// motion. The command follows the measured force through the loop.
namespace hybridtest::blind {

/// Storeys from the ground up, 1 to 3. The lowest ones are tested.
struct ShearBuilding {
  History mass_kg;
  History stiffness_n_per_m;             // of every storey
  double damping_per_mass_per_s = 0.0;   // Rayleigh's two factors
  double damping_per_stiffness_s = 0.0;  // of the initial stiffness of all storeys
};

/// Equal masses, with the given stiffnesses; damping at the lowest and the highest mode.
[[nodiscard]] ShearBuilding shear_building(const History& stiffness_n_per_m, double lowest_hz, double damping_ratio);

/// Lowest natural frequency, in Hz, of such a building with masses of 1 kg.
[[nodiscard]] double lowest_hz_of_unit_masses(const History& stiffness_n_per_m);

/// A storey in the laboratory, with all that its real site has.
struct TestedStorey {
  Site site;
  PlantEffects effects;
};

/// Filtered white noise (Kanai, 1957; Tajimi, 1960; high-pass as Clough and Penzien) below an envelope (Jennings,
/// Housner and Tsai, 1968), or pulses of an epicentre in front of it; peak 1 m/s2. At rest for `rest_s` at either end.
[[nodiscard]] History ground_motion(double rate_hz, double duration_s, double rest_s, RandomStream& random);

/// The test. Between two samples the structure moves exactly under a load that goes on as it did (matrix
/// exponential); its displacement of the next sample is sent to the sites, whose measured forces come back.
/// @returns a recording for each tested storey; values are not finite when the loop is unstable.
[[nodiscard]] std::vector<PlantRecording> run_closed_loop(const ShearBuilding& building,
                                                          const std::vector<TestedStorey>& tested,
                                                          const History& ground_m_per_s2, RandomStream& noise);

}  // namespace hybridtest::blind
