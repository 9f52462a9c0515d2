#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "validation/blind_batches/plant/plant.hpp"

namespace hybridtest::blind {

/// Which displacements are recorded besides the measured one and the force.
struct RecordedColumns {
  bool sent = false;
  bool target = false;
  bool command = false;
};

/// Scales of effects at a site: largest values under the first fit excitation without any effect.
struct Scales {
  double displacement_m = 0.0;
  double velocity_m_per_s = 0.0;
  double acceleration_m_per_s2 = 0.0;
  double force_n = 0.0;
  double duration_s = 0.0;
};

/// Everything of a case that does not depend on its effect, and is drawn before it.
struct CaseSetting {
  Site site;
  RecordedColumns columns;
  std::vector<History> fit_m;  // what the coordinator sends; one or two
  History held_out_m;
  Scales scales;
};

/// Streams "site", "excitation" of (seed, index).
[[nodiscard]] CaseSetting draw_case_setting(std::uint64_t seed, std::uint64_t index);

/// Two significant digits, as a data sheet would have it.
[[nodiscard]] double rounded(double value, int digits = 2);

struct ExcitationSettings {
  double rate_hz = 0.0;
  double duration_s = 0.0;
  double stroke_m = 0.0;          // largest displacement
  double velocity_m_per_s = 0.0;  // about the largest velocity: limits the frequencies
  double rest_s = 0.0;            // at either end; 0: none
};

/// A displacement history that begins and ends at zero: the drift of an oscillator under
/// filtered noise, a sine sweep, a growing sinusoid, a protocol of growing cycles, or band noise.
[[nodiscard]] History draw_excitation(const ExcitationSettings& settings, RandomStream& random);

enum class TruthClass { none, named, unknown, pair };

struct Cause {
  std::string interface;
  std::string effect;

  friend bool operator==(const Cause&, const Cause&) = default;
};

/// The sealed truth in the key.
struct Truth {
  TruthClass kind = TruthClass::none;
  PlantEffects effects;
  /// Every cause that counts as right: the true ones, and those whose signature explains the gap
  /// of this recording as well as the truth does. Empty for none and unknown.
  std::vector<Cause> acceptable;
  Residual residual = Residual::specimen;  // where the gap is measured
  double gap_to_floor = 0.0;               // rms of the true gap over the rms of the noise floor; first fit recording
  double held_out_gap_to_floor = 0.0;
  double variance_removed = 0.0;  // by the true model, of the user model's residual, held out
};

/// One case: the input of the diagnosis, and the truth.
struct BlindCase {
  CaseSetting setting;
  std::vector<PlantRecording> fit;
  PlantRecording held_out;
  Truth truth;
};

/// A given site with given effects.
[[nodiscard]] BlindCase make_case(CaseSetting setting, TruthClass kind, PlantEffects effects, std::uint64_t seed,
                                  std::uint64_t index);

/// Draws all of it; the same for the same seed and index anywhere.
[[nodiscard]] BlindCase draw_case(std::uint64_t seed, std::uint64_t index);

// Other causes that would give the same gap in this recording.

/// Where a cause shows: a displacement sensor at the transfer system when the command was recorded.
[[nodiscard]] Residual residual_of(const std::string& interface, const RecordedColumns& columns);

/// Output of a stage with the effects minus that of the user's model, without noise.
[[nodiscard]] History true_gap(Residual residual, const Site& site, const TrueSignals& signals);

/// Causes of the catalogue whose signature, as large as fits best, leaves less than 0.3 of the
/// floor of the gap. Their amounts are found by repeated linear fits of one number.
/// @param floor   rms.
[[nodiscard]] std::vector<Cause> collinear_causes(const CaseSetting& setting, Residual residual, const History& gap,
                                                  double floor, RandomStream& random);

/// Largest share of the gap's mean square that a single cause of the catalogue explains.
[[nodiscard]] double best_explained(const CaseSetting& setting, Residual residual, const History& gap,
                                    RandomStream& random);

}  // namespace hybridtest::blind
