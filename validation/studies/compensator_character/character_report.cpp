// Tables and figures of the character study.

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

#include "report/plotting/dot_figure.hpp"
#include "report/plotting/line_figure.hpp"
#include "validation/studies/compensator_character/character_study.hpp"
#include "validation/studies/compensator_character/frequency_response.hpp"

namespace hybridtest::character {
namespace {

constexpr std::array<std::pair<MethodGroup, const char*>, 3> kGroups{{
    {MethodGroup::extrapolation, "extrapolating commands"},
    {MethodGroup::adaptive, "adaptive or by a model"},
    {MethodGroup::force, "on forces"},
}};

using Responses = std::vector<std::complex<double>> Character::*;

double degrees(std::complex<double> response) { return std::arg(response) * 180.0 / std::numbers::pi; }

/// Effective delays near a frequency, for the summary.
std::string delay_at(const CharacterStudy& study, const Character& character, Responses responses, double wanted_hz) {
  if ((character.*responses).empty()) return "–";
  std::size_t nearest = 0;
  for (std::size_t i = 0; i < study.frequencies_hz.size(); ++i) {
    if (std::abs(study.frequencies_hz[i] - wanted_hz) < std::abs(study.frequencies_hz[nearest] - wanted_hz))
      nearest = i;
  }
  const std::complex<double> response = (character.*responses)[nearest];
  if (!std::isfinite(response.real())) return "diverges";
  return fmt::format("{:+.2f} ms, {:.3f}", 1e3 * effective_delay_s(response, study.frequencies_hz[nearest]),
                     std::abs(response));
}

plot::Axis frequency_axis() { return {.label = "frequency [Hz]", .is_logarithmic = true, .low = 0.5, .high = 20.0}; }

std::string response_figure(const CharacterStudy& study, Responses responses, double delay_ms_shown) {
  plot::LineFigure figure{.panels = {}, .columns = 3, .panel_width = 420.0, .panel_height = 240.0};
  const auto row = [&](const plot::Axis& y, auto value_of) {
    for (const auto& [group, group_name] : kGroups) {
      plot::Panel panel{.title = group_name, .x = frequency_axis(), .y = y, .lines = {}};
      for (const Character& character : study.characters) {
        const bool is_yardstick = character.name == "none";
        if ((character.group != group && !is_yardstick) || (character.*responses).empty()) continue;
        plot::Line line{.name = character.name,
                        .x = study.frequencies_hz,
                        .y = {},
                        .is_background = is_yardstick,
                        .is_emphasised = character.is_ours};
        for (std::size_t i = 0; i < study.frequencies_hz.size(); ++i) {
          line.y.push_back(value_of((character.*responses)[i], study.frequencies_hz[i]));
        }
        panel.lines.push_back(std::move(line));
      }
      figure.panels.push_back(std::move(panel));
    }
  };
  row({.label = "amplitude", .is_logarithmic = false, .low = 0.4, .high = 2.0},
      [](std::complex<double> response, double) { return std::abs(response); });
  row({.label = "phase [degrees]", .is_logarithmic = false, .low = -60.0, .high = 60.0},
      [](std::complex<double> response, double) { return degrees(response); });
  row({.label = "effective delay [ms]", .is_logarithmic = false, .low = -0.4 * delay_ms_shown, .high = delay_ms_shown},
      [](std::complex<double> response, double frequency_hz) {
        return 1e3 * effective_delay_s(response, frequency_hz);
      });
  return to_svg(figure);
}

}  // namespace

std::string frequency_response_csv(const CharacterStudy& study) {
  std::string text = "compensator,stand,frequency_hz,amplitude,phase_degrees,effective_delay_ms\n";
  const auto add = [&](const Character& character, Responses responses, std::string_view stand) {
    for (std::size_t i = 0; i < (character.*responses).size(); ++i) {
      const std::complex<double> response = (character.*responses)[i];
      text += fmt::format("{},{},{:.4f},", character.name, stand, study.frequencies_hz[i]);
      text += std::isfinite(response.real())
                  ? fmt::format("{:.6f},{:.4f},{:.4f}\n", std::abs(response), degrees(response),
                                1e3 * effective_delay_s(response, study.frequencies_hz[i]))
                  : "nan,nan,nan\n";
    }
  };
  for (const Character& character : study.characters) {
    add(character, &Character::on_pure_delay, "pure_delay");
    add(character, &Character::on_benchmark, "benchmark_actuator");
  }
  return text;
}

std::string loop_damping_csv(const CharacterStudy& study) {
  std::string text = "compensator,omega_delay,damping_ratio\n";
  for (const Character& character : study.characters) {
    for (std::size_t i = 0; i < character.loop_damping.size(); ++i) {
      text += fmt::format("{},{:.5f},{:.6f}\n", character.name, study.omega_delays[i], character.loop_damping[i]);
    }
  }
  return text;
}

std::string noise_gain_csv(const CharacterStudy& study) {
  std::string text =
      "compensator,target_to_command,displacement_to_command,force_to_force,displacement_to_force_n_per_m\n";
  for (const Character& character : study.characters) {
    const NoiseGain& noise = character.noise;
    text += fmt::format("{},{:.4f},{:.4f},{:.4f},{:.5g}\n", character.name, noise.target_to_command,
                        noise.displacement_to_command, noise.force_to_force, noise.displacement_to_force_n_per_m);
  }
  return text;
}

std::string summary_markdown(const CharacterStudy& study) {
  std::string text = fmt::format(
      "# Properties of each compensator\n\nEffective delay and amplitude of the force that the structure receives, "
      "relative to the force that belongs to the target; noise gains (root mean square out over in); the first omega "
      "delay at which a structure with {:g} % damping and all of its stiffness in the specimen becomes unstable.\n\n"
      "| compensator | pure delay of 20 ms, 1 Hz | 3.5 Hz | 10 Hz | benchmark actuator, 1 Hz | 3.5 Hz | 10 Hz | target "
      "noise to "
      "command | displacement noise to command | force noise to force | stable below omega delay |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n",
      100.0 * study.structure_damping);
  for (const Character& character : study.characters) {
    text += fmt::format("| {} |", character.name);
    for (const Responses responses : {&Character::on_pure_delay, &Character::on_benchmark}) {
      for (const double frequency_hz : {1.0, 3.5, 10.0}) {
        text += fmt::format(" {} |", delay_at(study, character, responses, frequency_hz));
      }
    }
    const NoiseGain& noise = character.noise;
    text += fmt::format(" {:.3g} | {:.3g} | {:.3g} | {} |\n", noise.target_to_command, noise.displacement_to_command,
                        noise.force_to_force,
                        character.loop_damping.empty() ? "–"
                        : character.limit.is_reached   ? fmt::format("{:.2f}", character.limit.omega_delay)
                                                       : fmt::format("over {:.2f}", character.limit.omega_delay));
  }
  return text;
}

std::string pure_delay_figure(const CharacterStudy& study) {
  return response_figure(study, &Character::on_pure_delay, 25.0);
}

std::string benchmark_figure(const CharacterStudy& study) {
  return response_figure(study, &Character::on_benchmark, 30.0);
}

std::string noise_figure(const CharacterStudy& study) {
  plot::DotFigure figure{
      .title = "Noise gain: root mean square out over in",
      .axis = {.label = "gain", .is_logarithmic = true},
      .marks = {"target to command", "displacement sensor to command", "load cell to structure's force"},
      .rows = {}};
  for (const Character& character : study.characters) {
    const NoiseGain& noise = character.noise;
    figure.rows.push_back({character.name,
                           {noise.target_to_command, noise.displacement_to_command, noise.force_to_force},
                           "",
                           character.is_ours});
  }
  return to_svg(figure);
}

std::string damping_figure(const CharacterStudy& study) {
  plot::LineFigure figure{.panels = {}, .columns = 3, .panel_width = 420.0, .panel_height = 300.0};
  for (const auto& [group, group_name] : kGroups) {
    plot::Panel panel{.title = group_name,
                      .x = {.label = "ω × delay [rad]", .is_logarithmic = true, .low = 0.02, .high = 2.5},
                      .y = {.label = "damping ratio [%]", .is_logarithmic = false, .low = -10.0, .high = 10.0},
                      .lines = {}};
    for (const Character& character : study.characters) {
      const bool is_yardstick = character.name == "none";
      if ((character.group != group && !is_yardstick) || character.loop_damping.empty()) continue;
      plot::Line line{.name = character.name,
                      .x = study.omega_delays,
                      .y = {},
                      .is_background = is_yardstick,
                      .is_emphasised = character.is_ours};
      for (const double damping : character.loop_damping) line.y.push_back(100.0 * damping);
      panel.lines.push_back(std::move(line));
    }
    figure.panels.push_back(std::move(panel));
  }
  return to_svg(figure);
}

}  // namespace hybridtest::character
