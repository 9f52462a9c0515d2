#include "validation/studies/compensator_character/character_study.hpp"

#include "validation/studies/compensator_character/frequency_response.hpp"
#include "validation/studies/parallel_runs.hpp"

namespace hybridtest::character {
namespace {

constexpr double kFrequencyHzMin = 0.5;
constexpr double kFrequencyHzMax = 20.0;
constexpr int kFrequencies = 28;
constexpr double kOmegaDelayMin = 0.02;
constexpr double kOmegaDelayMax = 2.5;
constexpr int kOmegaDelays = 50;

std::vector<std::complex<double>> responses(const CompensationMethod& method, const StandKind& stand,
                                            const std::vector<double>& frequencies_hz) {
  std::vector<std::complex<double>> found;
  if (method.needs_model && !stand.fits_model) return found;
  for (const double frequency_hz : frequencies_hz) found.push_back(measured_response(method, stand, frequency_hz));
  return found;
}

Character measured(const CompensationMethod& method, const CharacterStudy& study) {
  Character character;
  character.name = method.name;
  character.group = method.group;
  character.is_ours = method.is_ours;
  character.on_pure_delay = responses(method, pure_delay_stand(), study.frequencies_hz);
  character.on_benchmark = responses(method, benchmark_stand(), study.frequencies_hz);
  character.noise = measured_noise_gain(method, benchmark_stand());
  if (method.needs_model) return character;
  for (const double omega_delay : study.omega_delays) {
    character.loop_damping.push_back(measured_loop_damping(method, omega_delay, study.structure_damping));
  }
  character.limit = stability_limit(study.omega_delays, character.loop_damping);
  return character;
}

}  // namespace

std::size_t character_study_size() { return compensation_methods().size(); }

CharacterStudy run_character_study(unsigned threads, StudyProgress& progress) {
  const std::vector<CompensationMethod> methods = compensation_methods();
  CharacterStudy study;
  study.frequencies_hz = logarithmic_frequencies(kFrequencyHzMin, kFrequencyHzMax, kFrequencies);
  study.omega_delays = logarithmic_frequencies(kOmegaDelayMin, kOmegaDelayMax, kOmegaDelays);
  study.characters.resize(methods.size());
  run_in_parallel(methods.size(), threads, [&](std::size_t i) {
    study.characters[i] = measured(methods[i], study);
    progress.completed(methods[i].name);
  });
  return study;
}

}  // namespace hybridtest::character
