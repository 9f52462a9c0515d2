#include "validation/blind_batches/plant/foreign_laws.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>
#include <utility>

#include "validation/blind_batches/plant/specimen.hpp"

namespace hybridtest::blind {
namespace {

struct Numbers {
  double stiffness = 0.0;
  double yield_force = 0.0;
  double hardening = 0.0;

  [[nodiscard]] double yield_m() const { return yield_force / stiffness; }
};

Numbers numbers_of(const PlantEffect& effect) {
  return {effect.of("stiffness_n_per_m"), effect.of("yield_force_n"), effect.of("hardening_ratio")};
}

/// A smooth envelope, and reloading that heads for the farthest point reached on that side (as Clough and
/// Johnston, 1966, but in rates and without corners). Unloading softens with the ductility to the power `softening`.
class PeakSeeking {
 public:
  PeakSeeking(const Numbers& numbers, double softening) : numbers_{numbers}, softening_{softening} {
    for (const double side : {-1.0, 1.0}) {
      peak_x_[side > 0.0] = side * 0.2 * numbers.yield_m();
      peak_f_[side > 0.0] = envelope(peak_x_[side > 0.0]);
    }
  }

  [[nodiscard]] double force(double x) {
    const double step = x - x_;
    if (step == 0.0) return f_;
    const bool up = step > 0.0;
    const double farthest = std::max(-peak_x_[0], peak_x_[1]) / numbers_.yield_m();
    const double unloading = numbers_.stiffness * std::pow(std::max(1.0, farthest), -softening_);
    const double ahead = peak_x_[up] - x_;
    if (f_ * step < 0.0) {
      f_ += unloading * step;
    } else if (ahead * step <= step * step) {  // this step reaches the peak or goes on from it
      peak_x_[up] = x;
      peak_f_[up] = f_ = envelope(x);
    } else {
      f_ += std::clamp((peak_f_[up] - f_) / ahead, 0.0, unloading) * step;
    }
    x_ = x;
    return f_;
  }

 private:
  [[nodiscard]] double envelope(double x) const {
    return numbers_.hardening * numbers_.stiffness * x +
           (1.0 - numbers_.hardening) * numbers_.yield_force * std::tanh(x / numbers_.yield_m());
  }

  Numbers numbers_;
  double softening_;
  double peak_x_[2] = {};
  double peak_f_[2] = {};
  double x_ = 0.0;
  double f_ = 0.0;
};

/// Concrete that has to close before it carries: a lock whose slot grows with the largest displacement of either
/// side, beside steel that slips.
class SlipLock {
 public:
  SlipLock(const Numbers& numbers, double locked_share, double slot_share)
      : numbers_{numbers},
        locked_share_{locked_share},
        slot_share_{slot_share},
        steel_{{(1.0 - locked_share) * numbers.stiffness, (1.0 - locked_share) * numbers.yield_force, numbers.hardening,
                0.5}} {}

  /// @param left   share of stiffness and strength that is left.
  [[nodiscard]] double force(double x, double left = 1.0) {
    for (const double side : {-1.0, 1.0}) reached_[side > 0.0] = std::max(reached_[side > 0.0], side * x);
    const double rounding = 0.1 * numbers_.yield_m();
    const auto closed = [&](double along, double reached) {
      const double slot = slot_share_ * std::max(0.0, reached - numbers_.yield_m());
      return rounded_ramp(along - slot, rounding) - rounded_ramp(-slot, rounding);
    };
    const double locked = closed(std::max(0.0, x), reached_[1]) - closed(std::max(0.0, -x), reached_[0]);
    const double strength = locked_share_ * numbers_.yield_force;
    return left * strength *
               (std::tanh(locked / numbers_.yield_m()) + numbers_.hardening * locked / numbers_.yield_m()) +
           steel_.force(x, left, left);
  }

 private:
  Numbers numbers_;
  double locked_share_;
  double slot_share_;
  IwanStack steel_;
  double reached_[2] = {};
};

/// What a law is called by itself, and beside a model.
struct LawEntry {
  std::string_view fades_with;          // empty: it does not fade
  std::vector<const char*> laws;        // names that are right
  std::vector<const char*> effects;     // of the specimen, likewise
  std::vector<const char*> if_elastic;  // likewise beside an elastic model only
};

const std::map<std::string, LawEntry>& entries() {
  static const std::map<std::string, LawEntry> table{
      {"peak_seeking", {"", {"peak_oriented", "takeda"}, {}, {}}},
      {"softening_peak_seeking", {"", {"takeda", "peak_oriented"}, {}, {}}},
      {"slip_lock", {"", {"pinching", "bouc_wen_baber_noori"}, {"pinching"}, {}}},
      {"fading_slip_lock", {"energy", {"bouc_wen_baber_noori", "pinching"}, {}, {}}},
      {"fading_with_path", {"path", {"bouc_wen_baber_noori"}, {"stiffness_degradation", "strength_degradation"}, {}}},
      {"fading_with_energy",
       {"energy",
        {"bouc_wen_baber_noori"},
        {"stiffness_degradation_with_energy", "strength_degradation_with_energy"},
        {"yielding"}}},
      {"fading_with_peak",
       {"peak",
        {"peak_oriented", "takeda"},
        {"stiffness_degradation_with_peak", "strength_degradation_with_peak"},
        {}}},
      {"fading_with_time", {"time", {}, {"stiffness_degradation_with_time", "strength_degradation_with_time"}, {}}},
      {"tendon", {"", {"self_centring"}, {}, {}}},
      {"power_stack",
       {"", {"ramberg_osgood", "giuffre_menegotto_pinto", "bouc_wen"}, {}, {"yielding", "bouc_wen_hysteresis"}}},
  };
  return table;
}

}  // namespace

Spring foreign_law(const PlantEffect& effect) {
  const Numbers numbers = numbers_of(effect);
  if (effect.law == "peak_seeking" || effect.law == "softening_peak_seeking") {
    return [law = PeakSeeking{numbers, effect.of("softening")}](const MotionPoint& at) mutable {
      return law.force(at.displacement_m);
    };
  }
  if (effect.law == "tendon") {  // a tendon whose joint opens, and dissipators that slip
    const double slipping = 0.5 * effect.of("flag_ratio");
    return [numbers, slipping,
            steel = IwanStack{{slipping * numbers.stiffness, slipping * numbers.yield_force, 0.0, 0.4}}](
               const MotionPoint& at) mutable {
      const double u = at.displacement_m / numbers.yield_m();
      return numbers.yield_force *
                 ((1.0 - slipping) * ((1.0 - numbers.hardening) * std::tanh(u)) + numbers.hardening * u) +
             steel.force(at.displacement_m);
    };
  }
  if (effect.law == "power_stack") {  // slips spread over a decade
    const auto part = [&](double stiffness, double yield) {
      return IwanStack{
          {stiffness * numbers.stiffness, stiffness * yield * numbers.yield_force, numbers.hardening, 0.8}};
    };
    return [soft = part(0.5, 0.5), middle = part(0.3, 1.2), hard = part(0.2, 4.0)](const MotionPoint& at) mutable {
      const double x = at.displacement_m;
      return soft.force(x) + middle.force(x) + hard.force(x);
    };
  }
  const std::string_view with = entries().at(effect.law).fades_with;
  Fading fading{with, with.empty() ? 1.0 : effect.of("scale")};
  const auto stored_j = [numbers](double force, double left) {
    return 0.5 * force * force / (left * numbers.stiffness);
  };
  if (effect.law == "slip_lock" || effect.law == "fading_slip_lock") {
    return [fading, stored_j, law = SlipLock{numbers, effect.of("locked_share"), effect.of("slot_share")}](
               const MotionPoint& at) mutable {
      const double left = fading.left();
      const double force = law.force(at.displacement_m, left);
      fading.after(at, force, stored_j(force, left));
      return force;
    };
  }
  return [fading, stored_j, law = IwanStack{{numbers.stiffness, numbers.yield_force, numbers.hardening, 0.4}}](
             const MotionPoint& at) mutable {
    const double left = fading.left();
    const double force = law.force(at.displacement_m, left, std::sqrt(left));
    fading.after(at, force, stored_j(force, left));
    return force;
  };
}

const std::vector<std::string>& foreign_laws() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> of_table;
    for (const auto& [name, entry] : entries()) of_table.push_back(name);
    return of_table;
  }();
  return names;
}

PlantEffect draw_foreign_law(const CaseSetting& setting, RandomStream& random) {
  const LawModel& users = setting.site.specimen;
  const bool is_elastic = users.kind == LawKind::elastic;
  PlantEffect effect{"specimen", "hysteresis_law", {}, foreign_laws()[random.index(foreign_laws().size())]};
  const auto nearly = [&](double number) { return number * (1.0 + random.sign() * random.uniform(0.01, 0.05)); };
  const double stroke_m = setting.scales.displacement_m;
  const LawEntry& entry = entries().at(effect.law);
  // A spring that only fades does not yield when the model does not; but what does not yield dissipates nothing.
  const bool only_fades = is_elastic && effect.law.starts_with("fading_with") && entry.fades_with != "energy";
  const double yield_m = only_fades ? 20.0 * stroke_m : stroke_m * random.uniform(0.2, 0.6);
  Parameters& p = effect.parameters;
  p["stiffness_n_per_m"] = nearly(users.stiffness_n_per_m);
  p["yield_force_n"] = is_elastic ? users.stiffness_n_per_m * yield_m : nearly(users.yield_force_n);
  p["hardening_ratio"] = is_elastic ? random.uniform(0.01, 0.1) : users.hardening_ratio;
  p["softening"] = effect.law == "peak_seeking" ? 0.0 : random.uniform(0.2, 0.5);
  p["flag_ratio"] = random.uniform(0.3, 0.9);
  p["locked_share"] = random.uniform(0.4, 0.85);
  p["slot_share"] = random.uniform(0.3, 0.8);
  const double most = random.uniform(0.05, 0.6);  // about what is lost in the end
  const double path_m = 8.0 * stroke_m;
  const double scale = entry.fades_with == "path"     ? path_m
                       : entry.fades_with == "peak"   ? stroke_m
                       : entry.fades_with == "energy" ? 0.5 * setting.scales.force_n * path_m
                                                      : setting.scales.duration_s;
  p["scale"] = -scale / std::log(1.0 - most);
  return effect;
}

std::vector<Cause> names_of_law(const std::string& law, LawKind users) {
  const LawEntry& entry = entries().at(law);
  std::vector<Cause> causes;
  for (const char* name : entry.laws) causes.push_back({"specimen", "hysteresis_law", name});
  for (const char* name : entry.effects) causes.push_back({"specimen", name});
  if (users == LawKind::elastic) {
    for (const char* name : entry.laws) causes.push_back({"specimen", "yielding", name});
    for (const char* name : entry.if_elastic) causes.push_back({"specimen", name});
  }
  return causes;
}

std::vector<Cause> parts_of_law(LawKind users) {
  std::vector<Cause> causes{{"specimen", "hysteresis_law"}};  // any
  for (const char* name : {"stiffness_error", "bouc_wen_hysteresis", "coulomb_friction", "pinching"}) {
    causes.push_back({"specimen", name});
  }
  for (const std::string lost : {"stiffness_degradation", "strength_degradation"}) {
    for (const char* with : {"", "_with_peak", "_with_energy", "_with_cycles", "_with_time"}) {
      causes.push_back({"specimen", lost + with});
    }
  }
  causes.push_back({"specimen", users == LawKind::elastic ? "yielding" : "strength_error"});
  return causes;
}

}  // namespace hybridtest::blind
