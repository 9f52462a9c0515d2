#include "validation/blind_batches/plant/blind_case.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include "validation/blind_batches/plant/collinearity.hpp"
#include "validation/blind_batches/plant/effect_catalogue.hpp"
#include "validation/blind_batches/plant/foreign_laws.hpp"
#include "validation/blind_batches/plant/plant.hpp"

namespace hybridtest::blind {

Residual residual_of(const std::string& interface, const RecordedColumns& columns) {
  if (interface == "network") return Residual::network;
  if (interface == "compensator") return Residual::compensator;
  if (interface == "transfer_system") return Residual::transfer_system;
  if (interface == "displacement_sensor" && columns.command) return Residual::transfer_system;
  return Residual::specimen;
}

History true_gap(Residual residual, const Site& site, const PlantEffects& model, const TrueSignals& signals) {
  const auto less = [&](const History& output, const History& input) {
    return difference(output, stage_output(residual, site, model, input));
  };
  switch (residual) {
    case Residual::network: return less(signals.target_m, signals.sent_m);
    case Residual::compensator: return less(signals.command_m, signals.target_m);
    case Residual::transfer_system: return less(signals.read_m, signals.command_m);
    case Residual::specimen: return less(signals.read_n, signals.read_m);
  }
  return {};
}

namespace {

/// Digital stages have no noise; this value represents their rounding.
constexpr double kFloorMin = 1e-6;
/// Gaps over their floor that effects are made to have.
constexpr double kSeverities[] = {0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0};
/// No effect is made larger than this share of what the stage gives out.
constexpr double kLargestShare = 0.4;
/// The share of an effect that wrong numbers must leave, or there are none.
constexpr double kLeftByBesides = 0.33;

PlantEffects all_of(const RealSite& real) {
  PlantEffects all = real.besides;
  all.insert(all.end(), real.effects.begin(), real.effects.end());
  return all;
}

/// Of a recording against the true and the user's model, driven by what was measured.
struct Residuals {
  History true_model;
  History user_model;
  double floor = 0.0;  // rms of what noise alone leaves, by the quieter of the two models
};

Residuals residuals_of(Residual residual, const Site& site, const RealSite& real, const TrueSignals& signals,
                       const PlantRecording& recording) {
  const PlantEffects all = all_of(real);
  const auto less = [&](const History& output, const History& true_input, const History& user_input) {
    Residuals result;
    result.true_model = difference(output, stage_output(residual, site, all, true_input));
    result.user_model = difference(output, stage_output(residual, site, {}, user_input));
    // The true model may amplify noise that does not hide its effect.
    const History right_numbers = difference(output, stage_output(residual, site, real.besides, user_input));
    const double of_noise = rms(difference(right_numbers, true_gap(residual, site, real.besides, signals)));
    result.floor = std::max(std::min(rms(result.true_model), of_noise), kFloorMin * rms(output));
    return result;
  };
  switch (residual) {
    case Residual::network: return less(recording.target_m, recording.sent_m, recording.sent_m);
    case Residual::compensator: return less(recording.command_m, recording.target_m, recording.target_m);
    case Residual::transfer_system: return less(recording.measured_m, recording.command_m, recording.command_m);
    case Residual::specimen: break;
  }
  // The true model contains the effects of the displacement sensor, but not its noise.
  History moved = difference(recording.measured_m, signals.read_m);
  add(moved, sampled(signals.motion.displacement_m));
  return less(recording.measured_n, moved, recording.measured_m);
}

double variance_removed(const Residuals& residuals) {
  const double ratio = rms(residuals.true_model) / std::max(rms(residuals.user_model), 1e-300);
  return 1.0 - ratio * ratio;
}

/// Numbers of the model that are wrong by 1 to 5 %; none of them in every fifth case.
PlantEffects draw_besides(const Site& site, const Scales& scales, RandomStream& random) {
  if (random.chance(0.2)) return {};
  const auto off = [&] { return random.uniform(0.01, 0.05) * random.sign(); };
  PlantEffects besides;
  if (site.specimen.kind != LawKind::none) {
    besides.push_back({"specimen", "stiffness_error", {{"stiffness_ratio", 1.0 + off()}}});
  }
  const double damping = scales.force_n / scales.velocity_m_per_s;
  besides.push_back({"specimen", "viscous_damping", {{"damping_n_s_per_m", std::abs(off()) * damping}}});
  const TransferModel& actuator = site.transfer_system;
  const char* interface = "transfer_system";
  if (actuator.kind == TransferKind::delay) {
    besides.push_back({interface, "delay", {{"delay_s", actuator.delay_s * off()}}});
  } else if (actuator.kind == TransferKind::first_order) {
    besides.push_back({interface, "bandwidth_error", {{"true_bandwidth_hz", actuator.bandwidth_hz * (1.0 + off())}}});
  } else if (actuator.kind == TransferKind::second_order) {
    const double real_hz = actuator.natural_frequency_hz * (1.0 + off());
    besides.push_back({interface, "bandwidth_error", {{"true_natural_frequency_hz", real_hz}}});
  }
  besides.push_back({interface, "gain", {{"gain", 1.0 + off()}}});
  return besides;
}

PlantEffect draw_from(const std::vector<CatalogueEntry>& catalogue, const CaseSetting& setting, RandomStream& random,
                      double amount) {
  const std::vector<CatalogueEntry> entries = fitting(catalogue, setting);
  // Few recordings have the columns that show the network; in those its effects are drawn more often.
  std::vector<double> weights;
  for (const CatalogueEntry& entry : entries) weights.push_back(entry.interface == "network" ? 2.5 : 1.0);
  const CatalogueEntry& entry = entries[random.weighted(weights)];
  return {entry.interface, entry.name, entry.draw(random, setting, amount)};
}

/// Beyond what the library searches, where there is such a value that a site can have.
void exceed_library(PlantEffect& effect, const Scales& scales, RandomStream& random) {
  const auto set = [&](const char* name, double value) {
    if (const auto found = effect.parameters.find(name); found != effect.parameters.end()) found->second = value;
  };
  if (effect.interface == "network") set("delay_s", random.uniform(0.2, 0.35));
  if (effect.interface == "network") set("offset_s", random.uniform(0.2, 0.35));
  if (effect.interface == "transfer_system" && effect.name == "delay") set("delay_s", random.uniform(0.1, 0.15));
  if (effect.name == "lag") set("time_constant_s", random.uniform(0.1, 0.2));
  set("skew_s", random.uniform(0.1, 0.15));
  set("bias_m", scales.displacement_m * random.sign() * random.uniform(0.5, 0.8));
  set("bias_n", scales.force_n * random.sign() * random.uniform(0.5, 0.8));
  if (effect.name == "gain") set("gain", random.uniform(1.5, 2.0));
  if (effect.name == "stiction") set("catching_up_hz", random.uniform(10.0, 20.0));
}

/// Two of one name are one effect. A mass on a frame would swing, which is a third.
bool may_be_together(const PlantEffect& one, const PlantEffect& other) {
  const auto are = [&](const char* a, const char* b) { return one.name == a && other.name == b; };
  return one.name != other.name && !are("inertia", "compliance") && !are("compliance", "inertia");
}

/// Draws what the real site has, as large over the floor as it is asked to be.
class RealSiteDraw {
 public:
  RealSiteDraw(const CaseSetting& setting, RealSite& real, std::uint64_t seed, std::uint64_t index)
      : setting_{setting}, real_{real}, random_{seed, index, "effect"}, trial_noise_{seed, index, "trial"} {
    measure();
  }

  void operator()() {
    switch (random_.weighted({0.12, 0.10, 0.29, 0.14, 0.12, 0.11, 0.12})) {
      case 0: return;
      case 1: return add(TruthClass::named, drawn(wrong_numbers()));
      case 2: return add(TruthClass::named, drawn(named_effects()));
      case 3:
        if (setting_.site.specimen.kind != LawKind::elastic && setting_.site.specimen.kind != LawKind::bilinear) {
          return add(TruthClass::named, drawn(named_effects()));
        }
        real_.kind = TruthClass::law;
        real_.effects.push_back(draw_foreign_law(setting_, random_));
        std::erase_if(real_.besides, [](const PlantEffect& e) { return e.name == "stiffness_error"; });
        return;
      case 4: {
        add(TruthClass::pair, drawn(named_effects()));
        while (real_.effects.size() < 2) {
          PlantEffect second = drawn(named_effects());
          if (may_be_together(second, real_.effects.front())) add(TruthClass::pair, std::move(second));
        }
        return;
      }
      case 5: {
        add(TruthClass::partial, drawn(named_effects()));
        add(TruthClass::partial, drawn(foreign_effects()));
        return;
      }
      default: return add(TruthClass::unknown, drawn(foreign_effects()));
    }
  }

 private:
  /// Where nothing but the wrong numbers acts.
  void measure() {
    signals_ = run_plant(setting_.site, real_.besides, setting_.fit_m.front());
    signatures_.emplace(setting_.site, setting_.columns, real_.besides, signals_);
    floors_.clear();
  }

  double floor_at(Residual residual) {
    const auto found = floors_.find(residual);
    if (found != floors_.end()) return found->second;
    RandomStream noise = trial_noise_;
    const PlantRecording recording = record(setting_.site, signals_, noise);
    RealSite clean;
    clean.besides = real_.besides;
    return floors_[residual] = residuals_of(residual, setting_.site, clean, signals_, recording).floor;
  }

  PlantEffect drawn(const std::vector<CatalogueEntry>& catalogue) {
    return draw_from(catalogue, setting_, random_, random_.log_uniform(0.01, 0.3));
  }

  void add(TruthClass kind, PlantEffect effect) {
    real_.kind = kind;
    const double severity = kSeverities[random_.index(std::size(kSeverities))];
    const bool is_beyond = random_.chance(0.08) && !setting_.loop;
    const Residual residual = residual_of(effect.interface, setting_.columns);
    // A number that is wrong twice would have another size than the key says.
    const auto is_same = [&](const PlantEffect& beside) {
      return beside.interface == effect.interface && beside.name == effect.name;
    };
    if (std::erase_if(real_.besides, is_same) > 0) measure();
    History whole = signatures_->of(effect);
    if (rms(signatures_->beyond_besides(residual, whole)) < kLeftByBesides * rms(whole)) {
      // The wrong numbers would hide it: they are right where it acts.
      std::erase_if(real_.besides, [&](const PlantEffect& beside) {
        return residual_of(beside.interface, setting_.columns) == residual;
      });
      measure();
    }
    if (is_beyond) {
      exceed_library(effect, setting_.scales, random_);
    } else if (residual == Residual::transfer_system || residual == Residual::specimen) {
      size(effect, residual, severity);
    }
    real_.effects.push_back(std::move(effect));
  }

  void size(PlantEffect& effect, Residual residual, double severity) {
    const double floor = floor_at(residual);
    const double output = rms(residual == Residual::specimen ? signals_.read_n : signals_.read_m);
    const double wanted = std::min(severity * floor, kLargestShare * output);
    for (int round = 0; round < 3; ++round) {
      const double gap = rms(signatures_->beyond_besides(residual, signatures_->of(effect)));
      if (gap == 0.0 || std::abs(wanted / gap - 1.0) < 0.15) return;
      const double factor = std::isfinite(gap) ? std::clamp(wanted / gap, 0.02, 50.0) : 0.2;
      strengthen(effect, factor, setting_.scales);
    }
  }

  const CaseSetting& setting_;
  RealSite& real_;
  RandomStream random_;
  RandomStream trial_noise_;
  TrueSignals signals_;
  std::optional<Signatures> signatures_;
  std::map<Residual, double> floors_;
};

void add_new(std::vector<Cause>& causes, const std::vector<Cause>& more) {
  for (const Cause& cause : more) {
    if (std::ranges::find(causes, cause) == causes.end()) causes.push_back(cause);
  }
}

bool is_foreign(const PlantEffect& effect) {
  return std::ranges::any_of(foreign_effects(), [&](const CatalogueEntry& entry) {
    return entry.interface == effect.interface && entry.name == effect.name;
  });
}

/// Another effect that is the same delay of every sample: no recording tells which of the two it is.
std::optional<Cause> twin_of(const PlantEffect& effect) {
  if (effect.interface != "network") return {};
  if (effect.name == "latency") return Cause{"network", "clock_offset"};
  if (effect.name == "clock_offset") return Cause{"network", "latency"};
  return {};
}

/// Other names of the same physics: a delay of every sample by one clock, an addition to a law that makes another law
/// of it, a law with another number.
std::vector<Cause> also_named(const PlantEffect& effect, LawKind users) {
  static const std::vector<Cause> kYielding{{"specimen", "hysteresis_law", "bilinear"},
                                            {"specimen", "hysteresis_law", "giuffre_menegotto_pinto"},
                                            {"specimen", "hysteresis_law", "bouc_wen"},
                                            {"specimen", "hysteresis_law", "ramberg_osgood"}};
  if (const std::optional<Cause> twin = twin_of(effect)) return {*twin};
  if (effect.name == "yielding") {
    std::vector<Cause> causes = kYielding;
    causes.push_back({"specimen", "yielding", kUnsaidLaw});
    for (const Cause& law : kYielding) causes.push_back({"specimen", "yielding", law.law});
    return causes;
  }
  if (effect.name == "bouc_wen_hysteresis" && users == LawKind::elastic) return kYielding;
  if (effect.name == "strength_error") return {{"specimen", "hysteresis_law", "bilinear"}, {"specimen", "yielding"}};
  if (effect.name == "stiffness_error" && users == LawKind::bilinear)
    return {{"specimen", "hysteresis_law", "bilinear"}};
  if (effect.name == "pinching") {
    return {{"specimen", "hysteresis_law", "pinching"}, {"specimen", "hysteresis_law", "bouc_wen_baber_noori"}};
  }
  if (effect.name == "strength_degradation") return {{"specimen", "hysteresis_law", "bouc_wen_baber_noori"}};
  // Its orifice opens, and the model's damping is off besides: a power between the first and the second.
  if (effect.name == "quadratic_damping") return {{"specimen", "nonlinear_viscous_damping"}};
  return {};
}

/// What is right, of a case with these signals.
class Judge {
 public:
  Judge(BlindCase& blind_case, const RealSite& real, const TrueSignals& first, const TrueSignals& held_out,
        RandomStream random)
      : case_{blind_case},
        truth_{blind_case.truth},
        real_{real},
        first_{first},
        held_out_{held_out},
        signatures_{blind_case.setting.site, blind_case.setting.columns, real.besides, first},
        random_{random} {}

  void operator()() {
    for (const PlantEffect& effect : real_.effects) weigh(effect);
    settle_class();
    for (const PlantEffect& effect : real_.effects) {
      if (real_.kind == TruthClass::partial && is_foreign(effect)) {
        truth_.effect_acceptable.emplace_back();  // the part that stays unknown
      } else {
        name(effect);
      }
    }
    tolerate();
  }

 private:
  [[nodiscard]] Residual residual_of_effect(const PlantEffect& effect) const {
    return residual_of(effect.interface, case_.setting.columns);
  }

  History gap_of(const PlantEffect& effect) const {
    return signatures_.beyond_besides(residual_of_effect(effect), signatures_.of(effect));
  }

  double floor_at(Residual residual) {
    const auto found = floors_.find(residual);
    if (found != floors_.end()) return found->second;
    const double floor = residuals_of(residual, case_.setting.site, real_, first_, case_.fit.front()).floor;
    return floors_[residual] = floor;
  }

  /// How large the effect is, and where the largest of them is.
  void weigh(const PlantEffect& effect) {
    const Residual residual = residual_of_effect(effect);
    const double ratio = rms(gap_of(effect)) / floor_at(residual);
    truth_.effect_gaps_to_floor.push_back(ratio);
    if (ratio <= truth_.gap_to_floor) return;
    const Site& site = case_.setting.site;
    const Residuals later = residuals_of(residual, site, real_, held_out_, case_.held_out);
    const Signatures signatures{site, case_.setting.columns, real_.besides, held_out_};
    truth_.residual = residual;
    truth_.gap_to_floor = ratio;
    truth_.held_out_gap_to_floor = rms(signatures.beyond_besides(residual, signatures.of(effect))) / later.floor;
    truth_.variance_removed = variance_removed(later);
  }

  /// Of two kinds of effect, one that is below the floor is not there.
  void settle_class() {
    truth_.kind = real_.kind;
    if (real_.kind != TruthClass::partial) return;
    if (truth_.effect_gaps_to_floor[1] < 1.0) truth_.kind = TruthClass::named;
    if (truth_.effect_gaps_to_floor[0] < 1.0) truth_.kind = TruthClass::unknown;
  }

  /// What is right about one effect.
  void name(const PlantEffect& effect) {
    const Residual residual = residual_of_effect(effect);
    const LawKind users = case_.setting.site.specimen.kind;
    const LookAlikes alike =
        look_alikes(case_.setting, signatures_, residual, gap_of(effect), floor_at(residual), random_);
    const Cause itself{effect.interface, effect.name};
    std::vector<Cause> right;
    if (real_.kind == TruthClass::law) {
      right = names_of_law(effect.law, users);
      add_new(truth_.acceptable_in_part, parts_of_law(users));
    } else if (!is_foreign(effect)) {
      if (effect.name != "yielding") right = {itself};  // which has its laws
      add_new(right, also_named(effect, users));
    }
    // What a library effect imitates to the floor has its name, as no recording can tell.
    if (is_foreign(effect) && !alike.same.empty()) truth_.kind = TruthClass::named;
    std::vector<Cause> others = alike.same;
    std::erase(others, itself);
    add_new(right, others);
    truth_.is_separable = truth_.is_separable && others.empty() && !twin_of(effect);
    add_new(truth_.kind == TruthClass::unknown ? truth_.acceptable_in_part : truth_.acceptable, right);
    add_new(truth_.acceptable_in_part, alike.half);
    truth_.effect_acceptable.push_back(std::move(right));
  }

  void tolerate() {
    for (const PlantEffect& beside : real_.besides) {
      add_new(truth_.tolerated, {{beside.interface, beside.name}});
      const Residual residual = residual_of_effect(beside);
      if (!looked_.insert(residual).second) continue;
      add_new(truth_.tolerated, look_alikes(case_.setting, signatures_, residual, {}, 0.0, random_).tolerated);
    }
    const auto is_right = [&](const Cause& cause) {
      return std::ranges::find(truth_.acceptable, cause) != truth_.acceptable.end();
    };
    std::erase_if(truth_.tolerated, is_right);
    std::erase_if(truth_.acceptable_in_part, is_right);
  }

  BlindCase& case_;
  Truth& truth_;
  const RealSite& real_;
  const TrueSignals& first_;
  const TrueSignals& held_out_;
  Signatures signatures_;
  RandomStream random_;
  std::map<Residual, double> floors_;
  std::set<Residual> looked_;
};

/// Records every motion, in a loop or as planned. @returns whether all are stable.
bool record_motions(BlindCase& result, const RealSite& real, RandomStream noise) {
  CaseSetting& setting = result.setting;
  const PlantEffects effects = all_of(real);
  const double stroke_m = setting.scales.displacement_m;
  result.fit.clear();
  result.other_fit.clear();
  const auto record_one = [&](std::size_t i, bool is_held_out) {
    std::vector<PlantRecording> recordings;
    if (setting.loop) {
      const LoopSetting& loop = *setting.loop;
      const History& ground = is_held_out ? loop.held_out_ground_m_per_s2 : loop.fit_ground_m_per_s2[i];
      recordings = run_test(setting, effects, ground, noise);
    } else {
      const History& sent = is_held_out ? setting.held_out_m : setting.fit_m[i];
      recordings.push_back(record(setting.site, run_plant(setting.site, effects, sent), noise));
    }
    return recordings;
  };
  for (std::size_t i = 0; i <= setting.fit_m.size(); ++i) {
    const bool is_held_out = i == setting.fit_m.size();
    std::vector<PlantRecording> recordings = record_one(i, is_held_out);
    if (!is_stable(recordings, stroke_m)) return false;
    (is_held_out ? result.held_out : result.fit.emplace_back()) = std::move(recordings.front());
    if (recordings.size() < 2) continue;
    (is_held_out ? result.other_held_out : result.other_fit.emplace_back()) = std::move(recordings.back());
  }
  return true;
}

constexpr std::uint64_t kCasesMax = 10'000;

/// A drawn test that cannot be recorded, whatever its effects.
struct UnstableSetting : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Effects that make a test unstable are halved until it is stable; at last there are none.
/// @throws UnstableSetting where that is not enough.
void record_case(BlindCase& result, RealSite& real, std::uint64_t seed, std::uint64_t index) {
  for (int attempt = 0; !record_motions(result, real, {seed, index, "noise"}); ++attempt) {
    if (attempt < 3 && real.kind != TruthClass::law) {
      for (PlantEffect& effect : real.effects) strengthen(effect, 0.5, result.setting.scales);
    } else if (!real.effects.empty()) {
      real.effects.clear();
      real.kind = TruthClass::none;
    } else if (!real.besides.empty()) {
      real.besides.clear();
    } else {
      throw UnstableSetting{"a test without effects is unstable with its noise"};
    }
  }
  for (std::size_t i = 0; i < result.fit.size(); ++i) result.setting.fit_m[i] = result.fit[i].sent_m;
  result.setting.held_out_m = result.held_out.sent_m;
}

}  // namespace

BlindCase make_case(CaseSetting setting, RealSite real, std::uint64_t seed, std::uint64_t index) {
  BlindCase result;
  result.setting = std::move(setting);
  record_case(result, real, seed, index);
  const Site& site = result.setting.site;
  const TrueSignals first = run_plant(site, all_of(real), result.setting.fit_m.front());
  const TrueSignals held_out = run_plant(site, all_of(real), result.setting.held_out_m);
  result.truth.effects = real.effects;
  result.truth.besides = real.besides;
  Judge{result, real, first, held_out, RandomStream{seed, index, "collinearity"}}();
  return result;
}

BlindCase draw_case(std::uint64_t seed, std::uint64_t index) {
  // A setting that is unstable by itself is drawn anew: no case has an index as high as the next draws.
  for (std::uint64_t draw = index;; draw += kCasesMax) {
    CaseSetting setting = draw_case_setting(seed, draw);
    RandomStream numbers{seed, draw, "besides"};
    RealSite real;
    real.besides = draw_besides(setting.site, setting.scales, numbers);
    RealSiteDraw{setting, real, seed, draw}();
    try {
      return make_case(std::move(setting), std::move(real), seed, draw);
    } catch (const UnstableSetting&) {
      continue;
    }
  }
}

}  // namespace hybridtest::blind
