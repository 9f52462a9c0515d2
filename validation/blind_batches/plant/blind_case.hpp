#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "validation/blind_batches/plant/closed_loop.hpp"
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

/// A hybrid test whose command follows the measured force.
struct LoopSetting {
  ShearBuilding building;
  std::vector<History> fit_ground_m_per_s2;  // one or two
  History held_out_ground_m_per_s2;
  std::optional<Site> other;  // a second tested storey, recorded beside
  bool other_is_first = false;
};

/// Everything of a case that does not depend on its effect, and is drawn before it.
struct CaseSetting {
  Site site;  // where the effect acts
  RecordedColumns columns;
  std::vector<History> fit_m;  // what the coordinator sends, in a loop without any effect and noise; one or two
  History held_out_m;
  Scales scales;
  std::optional<LoopSetting> loop;  // empty: the motion was planned
};

/// Streams "site", "excitation" of (seed, index).
[[nodiscard]] CaseSetting draw_case_setting(std::uint64_t seed, std::uint64_t index);

/// The test in a closed loop; of the other tested storey the model is right.
/// @returns the recording of the storey with the effect first, then of the other, if there
/// is one.
[[nodiscard]] std::vector<PlantRecording> run_test(const CaseSetting& setting, const PlantEffects& effects,
                                                   const History& ground_m_per_s2, RandomStream& noise);

/// Whether no storey has moved several times as far as was planned.
[[nodiscard]] bool is_stable(const std::vector<PlantRecording>& recordings, double stroke_m);

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

enum class TruthClass {
  none,     // at most wrong numbers of a few percent
  named,    // one effect of the library, or a number of the model that is clearly wrong
  law,      // a specimen of another law than the model's
  pair,     // two effects of the library
  partial,  // one of the library and one that is not
  unknown,  // one that is not in the library
};

/// Of a cause: right when the answer tells no law.
inline constexpr const char* kUnsaidLaw = "unsaid";

/// An answer that can be right.
struct Cause {
  std::string interface;
  std::string effect;
  std::string law = {};  // of `hysteresis_law` and `yielding`; empty: any

  friend bool operator==(const Cause&, const Cause&) = default;
};

/// The sealed truth in the key.
struct Truth {
  TruthClass kind = TruthClass::none;
  PlantEffects effects;
  PlantEffects besides;  // numbers of the model that are wrong by a few percent, at the storey of the effect
  // One for each of `effects`.
  std::vector<double> effect_gaps_to_floor;           // as gap_to_floor
  std::vector<std::vector<Cause>> effect_acceptable;  // as acceptable
  bool is_separable = true;  // no other cause of the library explains an effect as well as it does itself
  /// Every cause that counts as right: the true ones, and those whose signature explains the gap
  /// of this recording as well as the truth does. Empty for none and unknown.
  std::vector<Cause> acceptable;
  /// Causes that explain at least half of the gap's mean square and leave more than the floor: right in an answer
  /// `partial` only.
  std::vector<Cause> acceptable_in_part;
  /// The wrong numbers and what looks like them: neither right nor wrong.
  std::vector<Cause> tolerated;
  Residual residual = Residual::specimen;  // where the gap is measured
  /// rms of the true gap over the rms of the noise floor; first fit recording, largest effect; of the gap only what
  /// no wrong number of the model takes up.
  double gap_to_floor = 0.0;
  double held_out_gap_to_floor = 0.0;
  double variance_removed = 0.0;  // by the true model, of the user model's residual, held out
};

/// One case: the input of the diagnosis, and the truth.
struct BlindCase {
  CaseSetting setting;
  std::vector<PlantRecording> fit;
  PlantRecording held_out;
  std::vector<PlantRecording> other_fit;  // of the other tested storey, if there is one
  PlantRecording other_held_out;
  Truth truth;
};

/// What the real site has beside the user's model.
struct RealSite {
  TruthClass kind = TruthClass::none;
  PlantEffects effects = {};
  PlantEffects besides = {};  // wrong numbers, not to be found
};

/// A given site with given effects.
[[nodiscard]] BlindCase make_case(CaseSetting setting, RealSite real, std::uint64_t seed, std::uint64_t index);

/// Draws all of it; the same for the same seed and index anywhere.
[[nodiscard]] BlindCase draw_case(std::uint64_t seed, std::uint64_t index);

/// Where a cause shows: a displacement sensor at the transfer system when the command was recorded.
[[nodiscard]] Residual residual_of(const std::string& interface, const RecordedColumns& columns);

/// Output of a stage with the effects minus that of the same stage with `model` alone, without noise.
[[nodiscard]] History true_gap(Residual residual, const Site& site, const PlantEffects& model,
                               const TrueSignals& signals);

}  // namespace hybridtest::blind
