#include "diagnosis/identification/law_candidates.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <deque>
#include <memory>
#include <type_traits>
#include <typeinfo>

#include "core/assert.hpp"
#include "diagnosis/tuning.hpp"
#include "mechanics/laws/bilinear.hpp"
#include "mechanics/laws/bouc_wen.hpp"
#include "mechanics/laws/bouc_wen_baber_noori.hpp"
#include "mechanics/laws/elastomer.hpp"
#include "mechanics/laws/friction_pendulum.hpp"
#include "mechanics/laws/giuffre_menegotto_pinto.hpp"
#include "mechanics/laws/lead_rubber.hpp"
#include "mechanics/laws/mr_damper.hpp"
#include "mechanics/laws/peak_oriented.hpp"
#include "mechanics/laws/pinched_reloading.hpp"
#include "mechanics/laws/ramberg_osgood.hpp"
#include "mechanics/laws/self_centring.hpp"
#include "mechanics/laws/takeda.hpp"
#include "plant/effects/parameter_limits.hpp"
#include "plant/effects/recorded_input.hpp"

namespace hybridtest {
namespace {

using Values = std::span<const double>;
using Scale = ParameterScale;

/// Lists the numbers of a law as a scenario writes them.
class ParameterList final : public ParameterArchive {
 public:
  explicit ParameterList(std::vector<LawParameter>& list) : list_{list} {}
  void either(const Alternative& first, const Alternative& second) override {
    const Alternative& given = first.value != 0.0 ? first : second;
    list_.push_back({std::string{given.key}, given.value});
  }

 protected:
  void number(std::string_view key, double& value, const ParameterRule& /*rule*/, bool /*is_required*/) override {
    list_.push_back({std::string{key}, value});
  }
  void integer(std::string_view key, int& value, const ParameterRule& /*rule*/) override {
    list_.push_back({std::string{key}, static_cast<double>(value)});
  }
  // No law of the table has one.
  void boolean(std::string_view /*key*/, bool& /*value*/, const ParameterRule& /*rule*/) override {}
  void nested(std::string_view /*key*/, std::string_view /*what*/, const Visit& visit) override { visit(*this); }

 private:
  std::vector<LawParameter>& list_;
};

/// A parameter of a search with its range.
struct Searched {
  std::string_view name;
  std::string_view unit;
  std::string_view what;
  ParameterScale scale;
  double low;
  double high;
  double neutral = kNoNeutral;
};

// The range of the stiffness is that of its unit only: the parameter is linear.
constexpr Searched kStiffness{"stiffness_n_per_m", "N/m", "before yielding", Scale::stiffness_n_per_m, 0.0, 5.0, 0.0};
constexpr Searched kYield{"yield_displacement_m", "m", "strength over stiffness", Scale::displacement_m, 0.02, 1.5};
constexpr Searched kHardening{"hardening_ratio", "", "stiffness after yielding over before", Scale::one, 0.0, 0.6};
// A column under an axial load and a wall that rocks lose force after yielding.
constexpr Searched kAfterYielding{"hardening_ratio", "",   "stiffness after yielding over before; negative: softens",
                                  Scale::one,        -0.3, 0.6};
constexpr Searched kCurvature{"r0", "", "R0, the larger the sharper the corner", Scale::one, 1.5, 25.0};
constexpr Searched kExponent{"n", "", "the larger, the sharper the yielding", Scale::one, 1.0, 8.0};
constexpr Searched kLoopShare{"loop_share", "", "beta over beta + gamma", Scale::one, 0.2, 1.0};
// Per unit of the energy of one elastic cycle to yielding, k uy^2: after a hundred of them nothing is left.
constexpr Searched kStrengthLoss{"strength_loss", "", "d_nu k uy^2", Scale::one, 0.0, 0.5};
constexpr Searched kStiffnessLoss{"stiffness_loss", "", "d_eta k uy^2", Scale::one, 0.0, 2.0};
constexpr Searched kPinching{"pinching", "", "zeta_s", Scale::one, 0.0, 0.98};
constexpr Searched kPinchingRate{"pinching_rate", "", "p k uy^2", Scale::one, 0.005, 10.0};
constexpr Searched kPinchingLevel{"pinching_level", "", "q", Scale::one, 0.0, 0.6};
constexpr Searched kPinchingWidth{"pinching_width", "", "psi over uy", Scale::one, 0.1, 3.0};
constexpr Searched kWidthRate{"width_rate", "", "d_psi k uy", Scale::one, 0.0, 0.2};
constexpr Searched kWidthShare{"width_share", "", "lambda", Scale::one, 0.1, 2.0};

constexpr Searched kRoundness{"exponent", "", "n, the larger, the sharper the yielding", Scale::one, 1.5, 30.0};
constexpr Searched kFlag{"flag_ratio", "", "beta", Scale::one, 0.0, 1.0};
constexpr Searched kUnloading{"unloading_exponent", "", "alpha", Scale::one, 0.0, 0.9};
constexpr Searched kCracking{"cracking_ratio", "", "cracking force over yield force", Scale::one, 0.0, 0.9, 0.0};
constexpr Searched kCracked{"cracked_ratio", "", "stiffness after cracking over before", Scale::one, 0.1, 1.0};
constexpr Searched kBreakForce{"pinching_force_ratio", "", "kf", Scale::one, 0.02, 1.0};
constexpr Searched kBreakDisplacement{"pinching_displacement_ratio", "", "kd", Scale::one, 0.0, 1.0};
// Yield displacement over the capacity: the part that is lost in an elastic, perfectly plastic cycle of ductility 1.25.
constexpr Searched kLossOfStrength{"strength_loss", "", "uy over L of strength", Scale::one, 0.0, 0.1};
constexpr Searched kLossOfUnloading{"unloading_loss", "", "uy over L of unloading", Scale::one, 0.0, 0.1};
constexpr Searched kLossOfReloading{"reloading_loss", "", "uy over L of reloading", Scale::one, 0.0, 0.1};

constexpr Searched kIsotropic{"isotropic_hardening", "", "a1 and a3 for a2 = a4 = 1", Scale::one, 0.0, 0.5};
constexpr Searched kHeating{"heating", "", "uy over L", Scale::one, 0.0, 0.5};

// What slides.
constexpr Searched kFriction{"friction_force_n", "N", "while it slides fast", Scale::force_n, 0.0, 1.5, 0.0};
constexpr Searched kPresliding{"presliding_displacement_m", "m",  "from rest until it slides",
                               Scale::displacement_m,       1e-3, 0.5};
// Down to a restoring force of a thousandth of the friction, which is that of a flat dish.
constexpr Searched kRestoring{"restoring_per_m", "1/m", "1 / (mu R)", Scale::per_m, 1e-3, 30.0, 0.0};
constexpr Searched kSlowRatio{"slow_friction_ratio", "", "mu_slow over mu_fast", Scale::one, 0.0, 1.0};
constexpr Searched kFrictionRate{"friction_rate_s_per_m", "s/m", "a", Scale::s_per_m, 1.0, 100.0};
constexpr Searched kHysteretic{"hysteretic_displacement_m", "m", "xh", Scale::displacement_m, 1e-3, 0.5};
constexpr Searched kSpringShare{"spring_per_m", "1/m", "k over Fh", Scale::per_m, 0.0, 10.0, 0.0};
constexpr Searched kDashpotShare{"dashpot_s_per_m", "s/m", "c over Fh", Scale::s_per_m, 0.0, 20.0};

// Filled rubber.
constexpr Searched kPayneDisplacement{"payne_displacement_m", "m",  "that overcomes the filler",
                                      Scale::displacement_m,  0.01, 1.0};
constexpr Searched kLargeMotionShare{"large_motion_ratio", "",   "stiffness in large motions over that in small ones",
                                     Scale::one,           0.02, 1.0};
constexpr Searched kStiffening{"stiffening_displacement_m", "m", "at which the cubic part is as large as the linear",
                               Scale::displacement_m,       0.3, 30.0};
constexpr Searched kMullins{"mullins_softening", "", "d", Scale::one, 0.0, 0.8};
constexpr Searched kMullinsDisplacement{"mullins_displacement_m", "m", "xm", Scale::displacement_m, 0.05, 3.0};

Bilinear::Parameters bilinear(Values v) {
  return {.stiffness_n_per_m = v[0], .yield_force_n = v[0] * v[1], .hardening_ratio = v[2]};
}

GiuffreMenegottoPinto::Parameters giuffre_menegotto_pinto(Values v) {
  const double isotropic = v.size() > 4 ? v[4] : 0.0;
  return {.stiffness_n_per_m = v[0],
          .yield_force_n = v[0] * v[1],
          .hardening_ratio = v[2],
          .r0 = v[3],
          .a1 = isotropic,
          .a3 = isotropic};
}

LeadRubber::Parameters lead_rubber(Values v) {
  return {.rubber_stiffness_n_per_m = v[2] * v[0],
          .lead_strength_n = (1.0 - v[2]) * v[0] * v[1],
          .yield_displacement_m = v[1],
          .heating_path_m = v[3] > 0.0 ? v[1] / v[3] : 0.0};  // 0: no heating
}

/// Weight, curvature and friction coefficient show in the force as W / R and mu W alone: of the coefficient of a slider
/// of PTFE on steel.
FrictionPendulum::Parameters friction_pendulum(Values v) {
  return {.weight_n = v[0] / tuning::kSliderFriction,
          .radius_m = 1.0 / (tuning::kSliderFriction * v[2]),
          .friction_coefficient = tuning::kSliderFriction,
          .slow_friction_ratio = v[3],
          .friction_rate_s_per_m = v[4],
          .presliding_displacement_m = v[1]};
}

MrDamper::Parameters mr_damper(Values v) {
  return {.damping_n_s_per_m = v[0] * v[3],
          .stiffness_n_per_m = v[0] * v[2],
          .hysteretic_force_n = v[0],
          .hysteretic_displacement_m = v[1]};
}

Elastomer::Parameters elastomer(Values v) {
  const double large_n_per_m = v[0] * v[2];
  return {.stiffness_n_per_m = large_n_per_m,
          .stiffening_n_per_m3 = large_n_per_m / (v[3] * v[3]),
          .mullins_softening = v[4],
          .mullins_displacement_m = v[5],
          .payne_force_n = (v[0] - large_n_per_m) * v[1],
          .payne_displacement_m = v[1]};
}

BoucWen::Parameters bouc_wen(Values v) {
  const double both_per_m = std::pow(v[1], -v[3]);
  return {.stiffness_n_per_m = v[0],
          .alpha = v[2],
          .n = v[3],
          .gamma_per_m = (1.0 - v[4]) * both_per_m,
          .beta_per_m = v[4] * both_per_m};
}

BoucWenBaberNoori::Parameters bouc_wen_baber_noori(Values v) {
  const BoucWen::Parameters smooth = bouc_wen(v);
  const double energy_j = v[0] * v[1] * v[1];
  return {.stiffness_n_per_m = smooth.stiffness_n_per_m,
          .alpha = smooth.alpha,
          .n = smooth.n,
          .gamma_per_m = smooth.gamma_per_m,
          .beta_per_m = smooth.beta_per_m,
          .strength_degradation_per_j = v[5] / energy_j,
          .stiffness_degradation_per_j = v[6] / energy_j,
          .pinching = v[7],
          .pinching_rate_per_j = v[8] / energy_j,
          .pinching_level = v[9],
          .pinching_width_m = v[10] * v[1],
          .width_rate_m_per_j = v[11] * v[1] / energy_j,
          .width_share = v[12]};
}

RambergOsgood::Parameters ramberg_osgood(Values v) {
  return {.stiffness_n_per_m = v[0], .yield_force_n = v[0] * v[1], .exponent = v[2]};
}

SelfCentring::Parameters self_centring(Values v) {
  return {.stiffness_n_per_m = v[0],
          .activation_force_n = v[0] * v[1],
          .hardening_ratio = v[2],
          .flag_ratio = v.size() > 3 ? v[3] : 0.0};
}

Takeda::Parameters takeda(Values v) {
  // Without cracking one, and the yield displacement is strength over stiffness.
  const double cracking = v.size() > 4 ? v[4] : 0.0;
  const double cracked = v.size() > 5 ? v[5] : 1.0;
  Takeda::Parameters parameters;
  parameters.stiffness_n_per_m = v[0];
  parameters.yield_force_n = v[0] * v[1] * cracked / (1.0 - cracking + cracking * cracked);
  parameters.hardening_ratio = v[2];
  parameters.cracking_force_n = cracking * parameters.yield_force_n;
  parameters.cracked_ratio = cracked;
  parameters.unloading_exponent = v[3];
  return parameters;
}

/// Takes the backbone, and from `losses` on the losses of strength, unloading and reloading stiffness, if there are
/// any.
template <class Parameters>
void set_deterioration(Values v, std::size_t losses, Parameters& parameters) {
  const auto capacity_m = [&](std::size_t i) {
    return i < v.size() && v[i] > 0.0 ? v[1] / v[i] : 0.0;  // 0: no loss
  };
  parameters.stiffness_n_per_m = v[0];
  parameters.yield_force_n = v[0] * v[1];
  parameters.hardening_ratio = v[2];
  parameters.strength_capacity_m = capacity_m(losses);
  parameters.unloading_capacity_m = capacity_m(losses + 1);
  parameters.reloading_capacity_m = capacity_m(losses + 2);
}

PeakOriented::Parameters peak_oriented(Values v) {
  PeakOriented::Parameters parameters;
  set_deterioration(v, 3, parameters);
  return parameters;
}

PinchedReloading::Parameters pinching(Values v) {
  PinchedReloading::Parameters parameters;
  set_deterioration(v, 5, parameters);
  parameters.pinching_force_ratio = v[3];
  parameters.pinching_displacement_ratio = v[4];
  return parameters;
}

/// The functions of a replacement by a law with these parameters.
template <class Part, auto kParameters>
constexpr LawReplacement replacement(std::string_view law, std::string_view in_words) {
  return {.law = law,
          .in_words = in_words,
          .make = [](Values values) -> std::unique_ptr<Law> {
            // The stiffness scales the force: without it there is none.
            if (values[0] == 0.0) return nullptr;
            if constexpr (std::is_same_v<Part, BoucWen>) {
              return std::make_unique<Part>(kParameters(values), BoucWen::Integration::table);
            } else if constexpr (std::is_constructible_v<Part, typename Part::Parameters, double>) {
              return std::make_unique<Part>(kParameters(values), tuning::kLawSubsteps);
            } else {
              return std::make_unique<Part>(kParameters(values));
            }
          },
          .written =
              [](Values values) {
                std::vector<LawParameter> list;
                ParameterList archive{list};
                typename Part::Parameters parameters = kParameters(values);
                parameters.serialize(archive);
                return list;
              }};
}

constexpr LawReplacement kBilinear = replacement<Bilinear, bilinear>("bilinear", "yields");
constexpr LawReplacement kGiuffre = replacement<GiuffreMenegottoPinto, giuffre_menegotto_pinto>(
    "giuffre_menegotto_pinto", "yields with rounded corners");
constexpr LawReplacement kLeadRubber =
    replacement<LeadRubber, lead_rubber>("lead_rubber", "yields and loses strength as it heats up");
constexpr LawReplacement kFrictionPendulum = replacement<FrictionPendulum, friction_pendulum>(
    "friction_pendulum",
    "slides on a dish with a friction that grows with the velocity (W / R and mu W can be told, R is given as 1 m)");
constexpr LawReplacement kMrDamper =
    replacement<MrDamper, mr_damper>("mr_damper", "is a magnetorheological damper at one current");
constexpr LawReplacement kElastomer = replacement<Elastomer, elastomer>(
    "elastomer", "is softer below the largest displacement so far and in large motions, like filled rubber");
constexpr LawReplacement kRambergOsgood =
    replacement<RambergOsgood, ramberg_osgood>("ramberg_osgood", "softens smoothly without a plateau");
constexpr LawReplacement kSelfCentring =
    replacement<SelfCentring, self_centring>("self_centring", "returns to zero with a flag-shaped loop");
constexpr LawReplacement kNonlinearElastic =
    replacement<SelfCentring, self_centring>("self_centring", "softens and comes back the same way, without a loop");
constexpr LawReplacement kTakeda = replacement<Takeda, takeda>(
    "takeda", "reloads towards its largest displacement and unloads the softer, the further it went");
constexpr LawReplacement kTakedaCracked = replacement<Takeda, takeda>(
    "takeda", "cracks, reloads towards its largest displacement and unloads the softer, the further it went");
constexpr LawReplacement kPeakOriented =
    replacement<PeakOriented, peak_oriented>("peak_oriented", "reloads towards its largest displacement");
constexpr LawReplacement kPeakOrientedLoss = replacement<PeakOriented, peak_oriented>(
    "peak_oriented", "reloads towards its largest displacement and degrades with the energy that it dissipates");
constexpr LawReplacement kPinchingLaw =
    replacement<PinchedReloading, pinching>("pinching", "pinches and reloads towards its largest displacement");
constexpr LawReplacement kPinchingLoss =
    replacement<PinchedReloading, pinching>("pinching", "pinches and degrades with the energy that it dissipates");
constexpr LawReplacement kBoucWen = replacement<BoucWen, bouc_wen>("bouc_wen", "has a smooth hysteresis");
constexpr LawReplacement kBaberNoori = replacement<BoucWenBaberNoori, bouc_wen_baber_noori>(
    "bouc_wen_baber_noori", "pinches and degrades smoothly with the energy that it dissipates");

/// The laws that may unload with less than their initial stiffness. Others only curve.
constexpr std::array<std::string_view, 4> kSoftening{"takeda", "peak_oriented", "pinching", "bouc_wen_baber_noori"};

/// Builds the table. Parameters stand in deques: entries point at them.
struct Table {
  std::deque<std::vector<EffectParameter>> parameters;
  std::vector<LawCandidate> laws;

  explicit Table(bool law_is_spring) {
    laws.reserve(32);  // entries point at each other
    const std::string_view name = law_is_spring ? "yielding" : "hysteresis_law";
    add(name, kBilinear, "elastic to Fy, then with the stiffness b k", "Simo and Hughes (1998)",
        {kStiffness, kYield, kAfterYielding});
    const std::string_view form = "hysteresis_law";
    add(form, kLeadRubber, "F = kr x + Q z, Q = Q0 / (1 + s / L) after the plastic path s",
        "Kalpakidis and Constantinou (2009)", {kStiffness, kYield, kHardening, kHeating});
    refine({0.01});
    add(name, kGiuffre, "curved from k to b k at Fy", "Menegotto and Pinto (1973)",
        {kStiffness, kYield, kAfterYielding, kCurvature});
    add(name, kGiuffre, "curved from k to b k at Fy, which grows with the largest displacement",
        "Filippou et al. (1983)", {kStiffness, kYield, kAfterYielding, kCurvature, kIsotropic});
    refine({0.01});
    add(form, kRambergOsgood, "x / xy = F / Fy + (F / Fy)^n on the first branch", "Ramberg and Osgood (1943)",
        {kStiffness, kYield, kRoundness});
    add(form, kSelfCentring, "flag of height beta Fa above Fa", "Christopoulos et al. (2002)",
        {kStiffness, kYield, kAfterYielding, kFlag});
    add(form, kNonlinearElastic, "elastic to Fa, then elastic with the stiffness b k", "Christopoulos et al. (2002)",
        {kStiffness, kYield, kAfterYielding});
    add(form, kTakeda, "unloads with k (xy / xmax)^alpha", "Takeda, Sozen and Nielsen (1970)",
        {kStiffness, kYield, kHardening, kUnloading});
    add(form, kTakedaCracked, "cracks, yields, unloads with k (xy / xmax)^alpha", "Takeda, Sozen and Nielsen (1970)",
        {kStiffness, kYield, kHardening, kUnloading, kCracking, kCracked});
    refine({0.3, 0.5});
    std::vector<Searched> oriented{kStiffness, kYield, kHardening};
    add(form, kPeakOriented, "reloads in a line to the largest displacement", "Clough (1966)", oriented);
    oriented.insert(oriented.end(), {kLossOfStrength, kLossOfUnloading, kLossOfReloading});
    add(form, kPeakOrientedLoss, "reloads in a line to the largest displacement, degrades with energy",
        "Ibarra, Medina and Krawinkler (2005)", oriented);
    refine({0.01, 0.01, 0.01});
    std::vector<Searched> bent{kStiffness, kYield, kHardening, kBreakForce, kBreakDisplacement};
    add(form, kPinchingLaw, "reloads to the largest displacement by way of a break point",
        "Ibarra, Medina and Krawinkler (2005)", bent);
    bent.insert(bent.end(), {kLossOfStrength, kLossOfUnloading, kLossOfReloading});
    add(form, kPinchingLoss, "reloads by way of a break point, degrades with energy",
        "Ibarra, Medina and Krawinkler (2005)", bent);
    refine({0.01, 0.01, 0.01});
    const std::vector<Searched> smooth{kStiffness, kYield, kHardening, kExponent, kLoopShare};
    add(form, kBoucWen, "F = alpha k x + (1 - alpha) k z", "Bouc (1967), Wen (1976)", smooth);
    std::vector<Searched> pinched = smooth;
    pinched.insert(pinched.end(), {kStrengthLoss, kStiffnessLoss, kPinching, kPinchingRate, kPinchingLevel,
                                   kPinchingWidth, kWidthRate, kWidthShare});
    add(form, kBaberNoori, "F = alpha k x + (1 - alpha) k z, z degrades and pinches", "Baber and Noori (1986)",
        pinched);
    // Half-way between none and much of each, so that a search sees the slopes of all.
    refine({0.01, 0.05, 0.6, 0.1, 0.1, 0.3, 0.01, 0.3});
    add(form, kFrictionPendulum, "F = W x / R + mu(v) W z", "Constantinou, Mokha and Reinhorn (1990)",
        {kFriction, kPresliding, kRestoring, kSlowRatio, kFrictionRate});
    special({.family = EffectFamily::rate, .needs_time = true});
    add(form, kMrDamper, "F = c v + k x + Fh z", "Spencer et al. (1997)",
        {kFriction, kHysteretic, kSpringShare, kDashpotShare});
    special({.family = EffectFamily::rate, .follows_derivatives = true, .needs_time = true});
    add(form, kElastomer, "F = eta (k x + k3 x^3) + Fp z", "Ogden and Roxburgh (1999), Berg (1998)",
        {kStiffness, kPayneDisplacement, kLargeMotionShare, kStiffening, kMullins, kMullinsDisplacement});
    special({.family = EffectFamily::amplitude});
  }

  void add(std::string_view name, const LawReplacement& law, std::string_view equation, std::string_view source,
           const std::vector<Searched>& searched) {
    std::vector<EffectParameter>& list = parameters.emplace_back();
    LawCandidate candidate;
    for (const Searched& one : searched) {
      list.push_back({.name = one.name,
                      .unit = one.unit,
                      .what = one.what,
                      .low = one.low < 0.0 ? -kUnbounded : 0.0,
                      .high = kUnbounded,
                      .neutral = one.neutral,
                      .is_linear = list.empty()});
      candidate.ranges.push_back({.interface = EffectInterface::specimen,
                                  .effect = name,
                                  .parameter = one.name,
                                  .scale = one.scale,
                                  .low = one.low,
                                  .high = one.high});
    }
    candidate.type = {.interface = EffectInterface::specimen,
                      .name = name,
                      .equation = equation,
                      .source = source,
                      .traits = {.family = EffectFamily::amplitude},
                      .parameters = list,
                      .replacement = &law};
    candidate.softens = std::ranges::find(kSoftening, law.law) != kSoftening.end();
    laws.push_back(std::move(candidate));
  }
  /// The last law refines the one before it.
  void refine(std::vector<double> start) {
    laws.back().refines = &laws[laws.size() - 2].type;
    laws.back().start = std::move(start);
  }
  void special(const EffectTraits& traits) {
    laws.back().type.traits = traits;
    laws.back().is_special = true;
  }
};

const Table& table(bool law_is_spring) {
  static const Table beside_spring{true};
  static const Table beside_law{false};
  return law_is_spring ? beside_spring : beside_law;
}

}  // namespace

std::span<const LawCandidate> law_candidates(bool law_is_spring) { return table(law_is_spring).laws; }

const LawCandidate& law_candidate(const EffectType& replacement) {
  for (const bool law_is_spring : {true, false}) {
    for (const LawCandidate& candidate : table(law_is_spring).laws) {
      if (&candidate.type == &replacement) return candidate;
    }
  }
  HYBRIDTEST_ASSERT(false && "every replacement is in the table");
  std::abort();
}

bool are_the_same_law(const EffectType& one, const EffectType& other) noexcept {
  return one.replacement != nullptr && other.replacement != nullptr && one.replacement->law == other.replacement->law;
}

bool has_own_form(const SiteModel& model, const EffectSetting& replacement) {
  if (!model.make_law) return false;
  SiteModel replaced = model;
  add_effect(replaced, replacement);
  const std::unique_ptr<Law> law = law_of(replaced);
  const std::unique_ptr<Law> own = model.make_law();
  const Law& first = *law;
  const Law& second = *own;
  return typeid(first) == typeid(second);
}

std::optional<SearchRange> range_of(const EffectType& effect, const EffectParameter& parameter) {
  if (effect.formula != nullptr) {
    // The user gives it in SI; what a rig takes for an input is none of it.
    if (parameter.name == kNominalInput.name) return {};
    return SearchRange{.interface = effect.interface,
                       .effect = effect.name,
                       .parameter = parameter.name,
                       .low = parameter.low,
                       .high = parameter.high};
  }
  if (effect.replacement == nullptr) {
    const SearchRange* const range = search_range(effect, parameter);
    return range == nullptr ? std::optional<SearchRange>{} : *range;
  }
  const std::vector<SearchRange>& ranges = law_candidate(effect).ranges;
  const auto range = std::ranges::find(ranges, parameter.name, &SearchRange::parameter);
  return range == ranges.end() ? std::optional<SearchRange>{} : *range;
}

}  // namespace hybridtest
