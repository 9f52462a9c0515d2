#pragma once

#include <map>
#include <numbers>
#include <string>
#include <vector>

namespace hybridtest::blind {

inline constexpr double kTwoPi = 2.0 * std::numbers::pi;

enum class TransferKind { ideal, delay, first_order, second_order };
enum class LawKind { none, elastic, bilinear, giuffre_menegotto_pinto, bouc_wen };

struct TransferModel {
  TransferKind kind = TransferKind::ideal;
  double delay_s = 0.0;               // delay and second_order
  double bandwidth_hz = 0.0;          // first_order, gain down by 3 dB
  double natural_frequency_hz = 0.0;  // second_order
  double damping_ratio = 0.0;
};

/// Keys and meaning as in docs/scenario.md.
struct LawModel {
  LawKind kind = LawKind::elastic;
  double stiffness_n_per_m = 0.0;
  double yield_force_n = 0.0;
  double hardening_ratio = 0.0;
  double r0 = 20.0;
  double cr1 = 0.925;
  double cr2 = 0.15;
  double alpha = 0.0;
  double gamma_per_m = 0.0;  // n = 1
  double beta_per_m = 0.0;
};

/// Delay 0: none. The points of the polynomial are spaced by the delay.
struct CompensatorModel {
  int order = 3;
  double delay_s = 0.0;
};

/// What the user believes of the site.
struct Site {
  TransferModel transfer_system;
  LawModel specimen;
  CompensatorModel compensator;
  double known_mass_kg = 0.0;  // effects that the user's model lists
  double known_damping_n_s_per_m = 0.0;
  double displacement_noise_m = 0.0;
  double force_noise_n = 0.0;
  double rate_hz = 0.0;  // of control and recording
};

using Parameters = std::map<std::string, double>;

/// Something that the real site has and the user's model has not. Units are part of the names of
/// its parameters, which docs/blind_batches.md describes.
struct PlantEffect {
  std::string interface;
  std::string name;
  Parameters parameters;

  [[nodiscard]] double of(const char* parameter) const { return parameters.at(parameter); }
};

using PlantEffects = std::vector<PlantEffect>;

}  // namespace hybridtest::blind
