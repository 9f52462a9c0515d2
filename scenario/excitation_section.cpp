#include "scenario/excitation_section.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "coordinator/excitation/force_history.hpp"
#include "coordinator/excitation/generated_signal.hpp"
#include "coordinator/excitation/read_ground_motion.hpp"
#include "coordinator/excitation/response_spectrum.hpp"
#include "core/config_error.hpp"
#include "scenario/named_file.hpp"

namespace hybridtest {
namespace {

using config::Section;

/// A factor written beside `scale_to` was found by an earlier reading of the same file.
constexpr double kSameFactor = 1e-9;
/// A duration that is whole steps up to rounding is.
constexpr double kWholeStep = 1e-9;
/// A quasi-static strain below this share of the motion of the support is rounding of the influence vectors.
constexpr double kNoStrain = 1e-9;

/// Each has a column in the table of steps.
constexpr std::size_t kGroundRecordsMax = 20;

/// The one of these keys that the section has; reports none and several.
std::size_t only_key(Section& section, const std::vector<std::string>& keys) {
  std::string listed;
  for (const std::string& key : keys) listed += (listed.empty() ? "" : ", ") + key;
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (!section.has_optional(keys[i])) continue;
    if (found) section.error(keys[i], "beside " + keys[*found] + "; expected one of " + listed);
    if (!found) found = i;
  }
  if (!found) section.error("", "expected one of " + listed);
  return found.value_or(0);
}

double read_ramp(Section& section, double duration_s) {
  const double ramp_s = section.number("ramp_s", kNotNegative, 0.0);
  if (2.0 * ramp_s <= duration_s) return ramp_s;
  section.error("ramp_s", fmt::format("the signal grows and fades over {:.6g} s each, but lasts {:.6g} s; expected at "
                                      "most half of that",
                                      ramp_s, duration_s));
  return 0.0;
}

/// A signal over time, and how long it lasts.
struct Signal {
  std::function<double(double time_s)> at;
  double duration_s = 0.0;
  std::string text;
};

/// Reads signals; the frequency that a step can show, and the time that is left, bound them.
class SignalReader {
 public:
  SignalReader(const TestSteps& test, Step release) : test_{test}, release_{release} {}

  /// @param amplitude   reads it from the section.
  Signal harmonic(Section section, const std::function<double(Section&)>& amplitude) const {
    HarmonicSignal signal;
    signal.amplitude = amplitude(section);
    signal.frequency_hz = section.number("frequency_hz", frequencies());
    signal.duration_s = left_s();
    if (section.has_optional("cycles")) {
      signal.duration_s = section.number("cycles", kPositive) / signal.frequency_hz;
      if (section.has_optional("duration_s")) section.error("duration_s", "beside cycles; expected one of the two");
    } else if (section.has_optional("duration_s")) {
      signal.duration_s = section.number("duration_s", kPositive);
    }
    signal.ramp_s = read_ramp(section, signal.duration_s);
    section.finish();
    return {[signal](double time_s) { return signal.at(time_s); }, signal.duration_s,
            fmt::format("harmonic of {:.6g} Hz", signal.frequency_hz)};
  }

  Signal sweep(Section section, const std::function<double(Section&)>& amplitude) const {
    SweepSignal signal;
    signal.amplitude = amplitude(section);
    signal.from_hz = section.number("from_hz", frequencies());
    signal.to_hz = section.number("to_hz", frequencies());
    signal.duration_s = section.number("duration_s", kPositive);
    signal.type = static_cast<SweepType>(section.choice("type", {"linear", "logarithmic"}, "linear"));
    signal.ramp_s = read_ramp(section, signal.duration_s);
    section.finish();
    return {[signal](double time_s) { return signal.at(time_s); }, signal.duration_s,
            fmt::format("sweep from {:.6g} to {:.6g} Hz", signal.from_hz, signal.to_hz)};
  }

  /// At each step, with time 0 `start_s` after the release.
  [[nodiscard]] std::vector<double> at_steps(const std::function<double(double time_s)>& history,
                                             double start_s) const {
    const double begin_s = static_cast<double>(release_) * test_.step_s + start_s;
    return hybridtest::at_steps([&](double time_s) { return history(time_s - begin_s); }, test_.step_s,
                                test_.last_step);
  }

  [[nodiscard]] double left_s() const { return static_cast<double>(test_.last_step - release_) * test_.step_s; }
  [[nodiscard]] double step_s() const { return test_.step_s; }

 private:
  /// Four steps in a cycle.
  [[nodiscard]] Range frequencies() const { return {.low = 0.0, .high = 0.25 / test_.step_s, .low_open = true}; }

  TestSteps test_;
  Step release_;
};

/// [m/s2]
double ground_amplitude(Section& section) {
  if (only_key(section, {"amplitude_g", "amplitude_m_per_s2"}) == 0) {
    return kStandardGravity_m_per_s2 * section.number("amplitude_g");
  }
  return section.number("amplitude_m_per_s2",
                        {.low = -kGroundAcceleration_m_per_s2_max, .high = kGroundAcceleration_m_per_s2_max});
}

double force_amplitude(Section& section) {
  return section.number("amplitude_n", {.low = -kForce_n_max, .high = kForce_n_max});
}

/// The factor that brings the motion to what `scale_to` asks for, at most once: read back, it stands in the file.
double read_scale_to(Section section, const GroundMotion& motion) {
  const bool is_spectral = only_key(section, {"peak_g", "spectral_acceleration_g"}) == 1;
  const double wanted_g = section.number(is_spectral ? "spectral_acceleration_g" : "peak_g", kPositive);
  double found_m_per_s2 = 0.0;
  if (is_spectral) {
    const double period_s = section.number("period_s", {.low = 0.01, .high = 60.0});
    const double damping_ratio = section.number("damping_ratio", kZeroToBelowOne, kSpectrumDamping);
    if (!motion.acceleration_m_per_s2.empty()) {
      found_m_per_s2 = spectrum_ordinate(motion, period_s, damping_ratio).pseudo_acceleration_m_per_s2;
    }
  } else {
    found_m_per_s2 = motion.peak_m_per_s2();
  }
  double factor = 1.0;
  if (found_m_per_s2 > 0.0) {
    factor = wanted_g * kStandardGravity_m_per_s2 / found_m_per_s2;
    const double written = section.number("factor", kAnyNumber, factor);
    if (std::abs(written - factor) > kSameFactor * factor) {
      section.error("factor",
                    fmt::format("the motion needs the factor {:.12g} to get there, not {:.12g}; remove factor, "
                                "or check that the file is the one that it was found for",
                                factor, written));
    }
    factor = written;
  } else if (!motion.acceleration_m_per_s2.empty()) {
    section.error("", "the motion is zero everywhere and cannot be scaled");
  }
  section.finish();
  return factor;
}

/// Reads one record after the other.
class RecordReader {
 public:
  RecordReader(const SignalReader& signals, const DofTable& dofs, const std::filesystem::path& directory,
               std::vector<NamedFile>& files)
      : signals_{signals}, dofs_{dofs}, directory_{directory}, files_{files} {}

  GroundRecord read(Section& section) {
    GroundRecord record;
    const std::size_t kind =
        section.has("harmonic") || section.has("sweep") ? only_key(section, {"ground_motion", "harmonic", "sweep"}) : 0;
    GroundMotion motion = kind == 0 ? from_file(section, record) : generated(section, kind == 1, record);
    double start_s = 0.0;
    if (section.has_optional("start_s")) start_s = section.number("start_s", kNotNegative);
    record.facts = motion.facts();
    if (motion.dt_s > 0.0) {
      if (motion.peak_m_per_s2() > kGroundAcceleration_m_per_s2_max) {
        section.error("", "the largest acceleration after scaling is above 1e6 m/s2; check the unit and the scale");
      }
      record.end = motion_end(motion);
      record.acceleration_m_per_s2 = signals_.at_steps([&](double time_s) { return motion.at(time_s); }, start_s);
    }
    if (section.has_optional("support")) {
      record.support = section.text("support");
      if (!section.has("influence")) {
        section.error("support",
                      "a support that moves alone needs influence: the displacement of each degree of freedom "
                      "per unit of displacement of this support");
      }
    }
    record.influence = read_influence(section, dofs_);
    return record;
  }

 private:
  GroundMotion from_file(Section& section, GroundRecord& record) {
    record.text = section.text("ground_motion");
    const std::optional<std::filesystem::path> file = named_file(section, "ground_motion", directory_);
    GroundMotionOptions options;
    const bool is_scaled_to = section.has_optional("scale_to");
    if (!is_scaled_to) options.scale = section.number("scale", kAnyNumber, 1.0);
    if (is_scaled_to && section.has("scale")) {
      static_cast<void>(section.number("scale"));
      section.error("scale", "beside scale_to; expected one of the two");
    }
    if (section.has("dt_s")) options.dt_s = section.number("dt_s", kPositive);
    if (section.has("unit")) {
      options.unit = static_cast<AccelerationUnit>(section.choice("unit", {"g", "m_per_s2", "cm_per_s2"}));
    }
    GroundMotion motion;
    if (file) {
      record.file = *file;
      files_.push_back({.file = *file, .written = record.text, .is_digested = false});
      try {
        motion = read_ground_motion(*file, options);
      } catch (const ConfigError& error) {
        section.error("ground_motion", error.what());
      }
    }
    record.end_as_read = motion_end(motion);
    correct(section, motion, record);
    if (!is_scaled_to) return motion;
    record.factor_found = read_scale_to(section.section("scale_to"), motion);
    motion.multiply(*record.factor_found);
    record.end_as_read.velocity_m_per_s *= *record.factor_found;
    record.end_as_read.displacement_m *= *record.factor_found;
    return motion;
  }

  static void correct(Section& section, GroundMotion& motion, GroundRecord& record) {
    if (auto section_found = section.optional_section("high_pass")) {
      HighPassFilter high_pass;
      high_pass.frequency_hz = section_found->number("frequency_hz", {.low = 1e-3, .high = 1e3});
      high_pass.order = static_cast<int>(section_found->integer("order", 1, kHighPassOrderMax, high_pass.order));
      section_found->finish();
      record.is_corrected = true;
      try {
        if (motion.dt_s > 0.0) filter(motion, high_pass);
      } catch (const ConfigError& error) {
        section_found->error("frequency_hz", error.what());
      }
    }
    if (section.has_optional("baseline")) {
      const auto correction =
          static_cast<BaselineCorrection>(section.choice("baseline", {"none", "mean", "linear", "quadratic"}));
      correct_baseline(motion, correction);
      record.is_corrected = record.is_corrected || correction != BaselineCorrection::none;
    }
  }

  GroundMotion generated(Section& section, bool is_harmonic, GroundRecord& record) {
    const Signal signal = is_harmonic ? signals_.harmonic(section.section("harmonic"), ground_amplitude)
                                      : signals_.sweep(section.section("sweep"), ground_amplitude);
    record.text = signal.text;
    GroundMotion motion{.dt_s = signals_.step_s(), .start_s = 0.0, .acceleration_m_per_s2 = {}};
    const double length_s = std::min(signal.duration_s, signals_.left_s());
    const auto points = static_cast<std::int64_t>(std::floor(length_s / motion.dt_s + kWholeStep));
    motion.acceleration_m_per_s2 = at_steps(signal.at, motion.dt_s, points);
    return motion;
  }

  const SignalReader& signals_;
  const DofTable& dofs_;
  const std::filesystem::path& directory_;
  std::vector<NamedFile>& files_;
};

/// Reads the list `forces`.
class ForceReader {
 public:
  ForceReader(const SignalReader& signals, const DofTable& dofs, const std::filesystem::path& directory,
              std::vector<NamedFile>& files)
      : signals_{signals}, dofs_{dofs}, directory_{directory}, files_{files} {}

  std::vector<AppliedForce> read(Section& entry) {
    std::vector<AppliedForce> forces;
    const std::size_t kind = only_key(entry, {"force_history", "harmonic", "sweep"});
    if (kind == 0) {
      forces = from_file(entry);
    } else {
      const Signal signal = kind == 1 ? signals_.harmonic(entry.section("harmonic"), force_amplitude)
                                      : signals_.sweep(entry.section("sweep"), force_amplitude);
      AppliedForce force = placed(entry);
      force.text = signal.text + " on " + force.text;
      force.load.force_n = signals_.at_steps(signal.at, start_of(entry));
      forces.push_back(std::move(force));
    }
    entry.finish();
    for (AppliedForce& force : forces) {
      for (const double value : force.load.force_n) force.peak_n = std::max(force.peak_n, std::abs(value));
    }
    return forces;
  }

 private:
  static double start_of(Section& entry) {
    return entry.has_optional("start_s") ? entry.number("start_s", kNotNegative) : 0.0;
  }

  /// A force at `dof`, or at several with factors.
  AppliedForce placed(Section& entry) {
    AppliedForce force;
    if (only_key(entry, {"dof", "dofs"}) == 0) {
      force.load.dofs = {dof_position(entry, "dof", dofs_)};
      force.load.factors = {1.0};
      force.text = entry.text("dof");
      return force;
    }
    const Eigen::VectorXd factors = values_by_dof(entry.section("dofs"), dofs_);
    for (Eigen::Index dof = 0; dof < factors.size(); ++dof) {
      if (factors[dof] == 0.0) continue;
      force.load.dofs.push_back(dof);
      force.load.factors.push_back(factors[dof]);
    }
    force.text = std::to_string(force.load.dofs.size()) + " degrees of freedom";
    return force;
  }

  std::vector<AppliedForce> from_file(Section& entry) {
    const std::string written = entry.text("force_history");
    const std::optional<std::filesystem::path> file = named_file(entry, "force_history", directory_);
    const double scale = entry.number("scale", kAnyNumber, 1.0);
    const double start_s = start_of(entry);
    const bool is_placed = entry.has_optional("dof") || entry.has_optional("dofs");
    ForceHistory history;
    if (file) {
      files_.push_back({.file = *file, .written = written, .is_digested = false});
      try {
        history = read_force_history(*file);
      } catch (const ConfigError& error) {
        entry.error("force_history", error.what());
      }
    }
    std::vector<AppliedForce> forces;
    if (is_placed) {
      forces.push_back(placed(entry));
      if (history.columns.size() > 1) {
        entry.error("dof", "the file has " + std::to_string(history.columns.size()) +
                               " columns of forces; expected one, or leave dof out and name the columns after their "
                               "degrees of freedom");
      }
    }
    for (std::size_t column = 0; column < history.columns.size(); ++column) {
      if (!is_placed) {
        const std::optional<int> row = dofs_.find(history.columns[column]);
        if (!row)
          entry.error("force_history", written + ": column " + std::to_string(column + 2) + ": " +
                                           no_such_dof(history.columns[column], dofs_));
        AppliedForce force;
        force.text = history.columns[column];
        force.load.dofs = {row.value_or(0)};
        force.load.factors = {1.0};
        forces.push_back(std::move(force));
      }
      if (column >= forces.size()) break;
      AppliedForce& force = forces[column];
      force.text = written + " on " + force.text;
      const TimeHistory& values = history.histories[column];
      force.load.force_n = signals_.at_steps([&](double time_s) { return scale * values.at(time_s); }, start_s);
    }
    return forces;
  }

  const SignalReader& signals_;
  const DofTable& dofs_;
  const std::filesystem::path& directory_;
  std::vector<NamedFile>& files_;
};

}  // namespace

Step ExcitationScenario::release_step() const noexcept {
  return free_vibration ? free_vibration->steps.ramp + free_vibration->steps.hold : 0;
}

AppliedLoad ExcitationScenario::load(const LinearStructure& structure) const {
  std::vector<GroundLoad> ground;
  for (const GroundRecord& record : records) {
    ground.push_back({-(structure.mass_kg * record.influence), record.acceleration_m_per_s2});
  }
  std::vector<ForceLoad> loads;
  for (const AppliedForce& force : forces) loads.push_back(force.load);
  return {std::move(ground), std::move(loads)};
}

GroundMotion ExcitationScenario::applied_motion(const GroundRecord& record, double step_s) const {
  return {.dt_s = step_s, .start_s = 0.0, .acceleration_m_per_s2 = record.acceleration_m_per_s2};
}

ExcitationScenario read_excitation(Section section, const DofTable& dofs, const TestSteps& test,
                                   const std::filesystem::path& directory, std::vector<NamedFile>& files) {
  ExcitationScenario excitation;
  if (section.has_optional("free_vibration")) {
    excitation.free_vibration = read_free_vibration(section.section("free_vibration"), dofs, test);
  }
  const SignalReader signals{test, excitation.release_step()};
  RecordReader records{signals, dofs, directory, files};
  const bool has_forces = section.has_optional("forces");
  if (section.has_optional("records")) {
    for (Section& entry : section.sections("records")) {
      excitation.records.push_back(records.read(entry));
      entry.finish();
    }
    if (excitation.records.empty() || excitation.records.size() > kGroundRecordsMax) {
      section.error("records", "expected 1 to " + std::to_string(kGroundRecordsMax) + " records");
    }
  } else if (section.has("ground_motion") || section.has("harmonic") || section.has("sweep") ||
             (!has_forces && !excitation.free_vibration)) {
    excitation.records.push_back(records.read(section));
  }
  if (has_forces) {
    ForceReader reader{signals, dofs, directory, files};
    for (Section& entry : section.sections("forces")) {
      for (AppliedForce& force : reader.read(entry)) excitation.forces.push_back(std::move(force));
    }
  }
  section.finish();
  return excitation;
}

void read_interface_support(Section& entry, std::string_view key, const InterfaceDof& interface,
                            const ExcitationScenario& excitation) {
  const auto moves = [](const GroundRecord& record) { return !record.support.empty(); };
  const bool stands_on_ground = interface.relative_to == InterfaceDof::kGround;
  const bool supports_move = std::ranges::any_of(excitation.records, moves);
  std::string support;
  if (entry.has_optional("support")) {
    support = entry.text("support");
    if (!stands_on_ground) entry.error("support", "beside relative_to: this interface does not stand on a support");
  } else if (supports_move && stands_on_ground) {
    entry.error(key,
                "supports move on their own, and this interface stands on one of them; expected support, the one "
                "that it stands on");
    return;
  }
  for (const GroundRecord& record : excitation.records) {
    if (!moves(record) || interface.dof >= record.influence.size()) continue;
    double strain = record.influence[interface.dof];
    if (stands_on_ground) strain -= support == record.support ? 1.0 : 0.0;
    if (!stands_on_ground) strain -= record.influence[interface.relative_to];
    if (std::abs(strain) <= kNoStrain) continue;
    entry.error(
        key, fmt::format("a displacement of the support '{}' strains this substructure by {:.6g} of it at rest, by the "
                         "influence of the record. The test computes displacements relative to the supports and would "
                         "leave that out; expected a substructure that its supports do not strain: keep this part in "
                         "structure.stiffness, or move all supports together (without the key support)",
                         record.support, strain));
  }
}

}  // namespace hybridtest
