#pragma once

#include <complex>
#include <string>
#include <vector>

#include "validation/studies/compensator_character/loop_damping.hpp"
#include "validation/studies/compensator_character/noise_gain.hpp"
#include "validation/studies/study_progress.hpp"

namespace hybridtest::character {

/// The measured properties of one method.
struct Character {
  std::string name;
  MethodGroup group = MethodGroup::extrapolation;
  bool is_ours = false;
  std::vector<std::complex<double>> on_pure_delay;  // by frequency; empty where the method does not fit the stand
  std::vector<std::complex<double>> on_benchmark;   // by frequency
  NoiseGain noise;                                  // on the benchmark stand
  std::vector<double> loop_damping;                 // by omega_delay; empty where it does not fit
  StabilityLimit limit;
};

struct CharacterStudy {
  std::vector<double> frequencies_hz;
  std::vector<double> omega_delays;
  double structure_damping = 0.02;
  std::vector<Character> characters;
};

/// Measures every method of the studies.
[[nodiscard]] CharacterStudy run_character_study(unsigned threads, StudyProgress& progress);
/// Number of methods it measures.
[[nodiscard]] std::size_t character_study_size();

/// `frequency_response.csv`, `loop_damping.csv`, `noise_gain.csv`.
[[nodiscard]] std::string frequency_response_csv(const CharacterStudy& study);
[[nodiscard]] std::string loop_damping_csv(const CharacterStudy& study);
[[nodiscard]] std::string noise_gain_csv(const CharacterStudy& study);
/// `summary.md`: noise gains, limits and effective delays.
[[nodiscard]] std::string summary_markdown(const CharacterStudy& study);

/// Figures as SVG: amplitude, phase and effective delay by groups of methods.
[[nodiscard]] std::string pure_delay_figure(const CharacterStudy& study);
[[nodiscard]] std::string benchmark_figure(const CharacterStudy& study);
[[nodiscard]] std::string noise_figure(const CharacterStudy& study);
[[nodiscard]] std::string damping_figure(const CharacterStudy& study);

}  // namespace hybridtest::character
