#include "validation/studies/rths_benchmark/candidates.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include "compensation/adaptive_model_inverse.hpp"
#include "compensation/adaptive_time_series.hpp"
#include "compensation/conditional_adaptive_time_series.hpp"
#include "compensation/feedforward_lqg.hpp"
#include "compensation/no_force_compensation.hpp"
#include "core/config_error.hpp"
#include "core/text/nearest_name.hpp"
#include "core/text/shown.hpp"
#include "validation/studies/compensation_methods.hpp"
#include "validation/studies/rths_benchmark/constants.hpp"

namespace hybridtest::rths {
namespace {

constexpr std::string_view kPiSuffix = "+pi";

template <class Part>
auto maker_of(const typename Part::Parameters& parameters) {
  return [parameters] { return std::make_unique<Part>(parameters, kPeriodS); };
}

using CompensatorMaker = std::function<std::unique_ptr<Compensator>()>;
using ForceCompensatorMaker = std::function<std::unique_ptr<ForceCompensator>()>;

const ForceCompensatorMaker kMeasuredForce = [] { return std::make_unique<NoForceCompensation>(); };

ForceCompensatorMaker force_lead(double periods) {
  return [periods] { return make_force_lead(periods, kPeriodS); };
}

Candidate candidate_of(std::string name, Standing standing, Arrangement arrangement, std::string remark,
                       CompensatorMaker make, ForceCompensatorMaker make_force) {
  return {std::move(name),
          standing,
          arrangement,
          std::move(remark),
          [make = std::move(make), arrangement] { return std::make_unique<CompensatedPath>(make(), arrangement); },
          std::move(make_force)};
}

Standing standing_of(const CompensationMethod& method) {
  if (method.name == kOurs) return Standing::ours;
  if (method.is_ours) return Standing::our_variant;
  return method.name == "none" ? Standing::yardstick : Standing::published;
}

/// Every method of the studies; in the second arrangement only those that need no model of the bare plant.
void add_methods(Arrangement arrangement, std::vector<Candidate>& candidates) {
  const double delay_s = nominal_delay_s(arrangement);
  for (const CompensationMethod& method : compensation_methods()) {
    if (method.needs_model && arrangement == Arrangement::with_pi) continue;
    std::string name = method.name;
    if (arrangement == Arrangement::with_pi) name += kPiSuffix;
    candidates.push_back(candidate_of(
        std::move(name), standing_of(method), arrangement, method.remark,
        [make = method.make_compensator, delay_s] { return make(delay_s, kPeriodS); },
        [make = method.make_force_compensator, delay_s] { return make(delay_s, kPeriodS); }));
  }
}

TimeSeriesParameters model_start() {
  const auto inverse = TransferSystemModel{}.inverse_coefficients();
  TimeSeriesParameters parameters;
  parameters.a0 = inverse[0];
  parameters.a1_s = inverse[1];
  parameters.a2_s2 = inverse[2];
  return parameters;
}

void add_variants(std::vector<Candidate>& candidates) {
  const auto add = [&](std::string name, Standing standing, std::string remark, CompensatorMaker make,
                       ForceCompensatorMaker make_force) {
    candidates.push_back(candidate_of(std::move(name), standing, Arrangement::straight, std::move(remark),
                                      std::move(make), std::move(make_force)));
  };
  const std::string model_start_remark = "coefficients start at the inverse of the nominal plant model";
  add("adaptive_time_series_model_start", Standing::variant, model_start_remark,
      maker_of<AdaptiveTimeSeries>(model_start()), kMeasuredForce);
  add("conditional_adaptive_time_series_model_start", Standing::variant, model_start_remark,
      maker_of<ConditionalAdaptiveTimeSeries>(model_start()), kMeasuredForce);
  add("adaptive_time_series_model_start_force_lead", Standing::variant,
      model_start_remark + ", and the force lead of adaptive_model_inverse",
      maker_of<AdaptiveTimeSeries>(model_start()), force_lead(kLoopDelayPeriods));
  FeedforwardLqg::Parameters no_feedback;
  no_feedback.has_feedback = false;
  add("feedforward_inverse", Standing::published, "the feedforward of feedforward_lqg without its regulator",
      maker_of<FeedforwardLqg>(no_feedback), kMeasuredForce);
  add("adaptive_model_inverse_part_lead", Standing::our_variant, "with 0.4 periods of force lead instead of 1.5",
      maker_of<AdaptiveModelInverse>({}), force_lead(0.4));
  add("adaptive_model_inverse_no_lead", Standing::our_variant, "without a force compensator",
      maker_of<AdaptiveModelInverse>({}), kMeasuredForce);
  AdaptiveModelInverse::Parameters fixed;
  fixed.adapts = false;
  add("model_inverse_not_adaptive", Standing::our_variant, "adaptive_model_inverse with its estimation switched off",
      maker_of<AdaptiveModelInverse>(fixed), force_lead(kLoopDelayPeriods));
}

Candidate released_controller() {
  return {"released_controller",
          Standing::yardstick,
          Arrangement::straight,
          "proportional-integral control with a lead, as released with the benchmark",
          [] { return std::make_unique<ReleasedController>(); },
          kMeasuredForce};
}

}  // namespace

double nominal_delay_s(Arrangement arrangement) {
  constexpr double kFrequencyHz = 3.5;
  const std::complex<double> s{0.0, 2.0 * std::numbers::pi * kFrequencyHz};
  const auto coefficients = TransferSystemModel{}.inverse_coefficients();
  std::complex<double> inverse = 0.0;
  for (auto coefficient = coefficients.rbegin(); coefficient != coefficients.rend(); ++coefficient) {
    inverse = inverse * s + *coefficient;
  }
  if (arrangement == Arrangement::with_pi) {
    const std::complex<double> open_loop = (2.0 + 95.0 / s) / inverse;
    inverse = (1.0 + open_loop) / open_loop;
  }
  return std::arg(inverse) / s.imag() + 0.5 * kPeriodS;
}

std::vector<Candidate> all_candidates() {
  std::vector<Candidate> candidates{released_controller()};
  add_methods(Arrangement::straight, candidates);
  add_variants(candidates);
  add_methods(Arrangement::with_pi, candidates);
  return candidates;
}

std::vector<Candidate> chosen_candidates(const std::vector<std::string>& names) {
  std::vector<Candidate> candidates = all_candidates();
  std::vector<std::string> known;
  for (const Candidate& candidate : candidates) known.push_back(candidate.name);
  for (const std::string& name : names) {
    if (std::ranges::find(known, name) != known.end()) continue;
    const auto nearest = nearest_name(name, known);
    throw ConfigError{"--compensator " + name + ": no compensator of the study has this name" +
                      (nearest ? "; did you mean '" + *nearest + "'?" : "")};
  }
  if (names.empty()) return candidates;
  std::erase_if(candidates, [&](const Candidate& candidate) {
    return std::ranges::none_of(names, [&](const std::string& name) {
      return candidate.name == name || candidate.name == name + std::string{kPiSuffix};
    });
  });
  return candidates;
}

}  // namespace hybridtest::rths
