#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "diagnosis/identification/effect_fit.hpp"
#include "diagnosis/identification/search.hpp"
#include "diagnosis/progress.hpp"

namespace hybridtest {

/// Held-out log predictive density of a fit, up to a constant that all fits share [nats].
///
/// Gaussian residuals with the variance of the held-out blocks. Neighbouring samples of a structured residual contain
/// the same information: the number of independent ones is that of the segment's noise (FitSegment::independent), the
/// same for all candidates. A channel that was judged before may lose by a candidate, and not gain. Wrong numbers of
/// the model that are needed elsewhere cost what cost_of_numbers() says.
[[nodiscard]] double held_out_score(const IdentificationProblem& problem, const FitOutcome& outcome);

/// Number of parameters of an effect that the recordings need: an optional one at its default is none.
/// @param position   in the fit's effects.
[[nodiscard]] double free_parameters(const IdentificationProblem& problem, const FitOutcome& fit, std::size_t position);

/// What a parameter beyond the first costs [nats]: half the logarithm of the samples that count, as in Schwarz's
/// criterion (Annals of Statistics 6, 1978), where they are few; at most kParameterPrior.
[[nodiscard]] double parameter_cost(const IdentificationProblem& problem);

/// Order of two fits that a recording cannot distinguish: without a sensor effect first, then with fewer
/// parameters, the wrong numbers of the specimen's own law being those of one effect [nats].
[[nodiscard]] double prior(const IdentificationProblem& problem, const FitOutcome& outcome);

/// Energy of the residual over all suspect segments, each relative to the variance of its output, held out.
struct GapEnergy {
  double total = 0.0;
  double floor = 0.0;
  double allowed = 0.0;  // the floor, and what no model is expected to reproduce

  GapEnergy& operator+=(const GapEnergy& other) noexcept;
  /// The remaining gap above the floor.
  [[nodiscard]] double excess() const noexcept { return total > floor ? total - floor : 0.0; }
  /// Whether an energy is clear of the floor: of this gap, or of a part of it.
  [[nodiscard]] bool is_clear(double energy) const noexcept;
  /// Whether a further effect could explain something.
  [[nodiscard]] bool is_clear() const noexcept { return is_clear(total); }
};
[[nodiscard]] GapEnergy gap_energy(const IdentificationProblem& problem, const FitOutcome& outcome);
/// Of one segment.
[[nodiscard]] GapEnergy gap_energy(const FitSegment& segment, const SegmentResult& result);

/// An effect of the library, fitted.
struct Candidate {
  const EffectType* type = nullptr;
  FitOutcome fit;           // alone or, if needed, together with slightly wrong parameters of the model
  double score = 0.0;       // on held-out blocks, with prior() and the penalty for free nuisance parameters
  double held_out = 0.0;    // held_out_score() alone; of a leader with what was found beside it
  double parameters = 0.0;  // number of free ones
  // That it is the first cause, against the others of a library; it stays with the candidate when these are put in
  // another order.
  double probability = 0.0;
};

/// Receives the number of finished fits and of all fits; called from any thread, one call at a time.
using FitProgress = std::function<void(std::size_t done, std::size_t all)>;

/// Runs `fit(i)` for every i below `count`, and counts them; see Workers::for_each().
void fit_each(const Workers& workers, std::size_t count, const std::function<void(std::size_t)>& fit,
              const FitProgress& progress);

/// Whether the effect acts on a suspect segment with a gap, and has anything that is searched.
[[nodiscard]] bool is_judged(const IdentificationProblem& problem, const EffectType& effect);

/// The effects that a diagnosis can judge on the suspect segments, and the laws that are searched by themselves, but
/// for those of special devices and the fluid damper.
[[nodiscard]] std::vector<const EffectType*> judged_effects(const IdentificationProblem& problem);

/// Gain of a candidate on held-out blocks above which it explains something [nats]: log(n / a) for n judged effects and
/// the rate a of false alarms. By Markov's inequality a predictive density that is wrong exceeds the right one by the
/// factor n / a with a probability of at most a / n, whatever the candidate (Vovk and Wang, Annals of Statistics 49,
/// 2021: e-values).
[[nodiscard]] double decisive_gain(const IdentificationProblem& problem);

/// The wrong numbers of the model that a fit with nuisance parameters found at the suspect segments, as effects; of
/// several recordings the mean. What it needs elsewhere is a matter of the channel there.
[[nodiscard]] std::vector<EffectSetting> wrong_numbers(const IdentificationProblem& problem, const FitOutcome& fit);

/// Every judged effect and law fitted, best score first; those that cannot be fitted are omitted, and those that the
/// recordings refute by themselves (refutation()).
/// @param coarse   the same problem at a lower rate, where every effect is searched over its whole range; those
///                 that come near the best are fitted again to `problem` from there.
[[nodiscard]] std::vector<Candidate> fit_library(const IdentificationProblem& problem,
                                                 const IdentificationProblem& coarse, const PartProgress& progress);

/// Every law of the specimen in place of its own but those of special devices, each by itself, best first: the detailed
/// ones searched over their whole ranges from what the library holds of the simpler law that they refine. Refuted ones
/// are omitted.
[[nodiscard]] std::vector<Candidate> fit_all_laws(const IdentificationProblem& problem,
                                                  const IdentificationProblem& coarse,
                                                  const std::vector<Candidate>& library);

/// The laws of special devices (LawCandidate::is_special), each by itself, best first. Omitted are refuted ones, and
/// those of which a parameter that cannot be absent is at the limit of its range: a rubber without Mullins effect is
/// none.
[[nodiscard]] std::vector<Candidate> fit_special_laws(const IdentificationProblem& problem,
                                                      const IdentificationProblem& coarse,
                                                      const PartProgress& progress);

/// Scores of the same fits after the noise of the problem has changed, best first.
void score_again(const IdentificationProblem& problem, std::vector<Candidate>& candidates);

/// Whether two fits change the prediction in the same shape and size, and need the same of the numbers of the model:
/// nothing on these recordings splits them.
[[nodiscard]] bool are_alike(const FitOutcome& first, const FitOutcome& second);

[[nodiscard]] bool is_of_sensor(const EffectType& effect) noexcept;

/// A number of the model, or the damping that every model leaves out.
[[nodiscard]] bool is_number(const IdentificationProblem& problem, const EffectType& type);

/// A stiffness or strength of the specimen's law. A law in place of the specimen's own has its own.
[[nodiscard]] bool is_of_law(const EffectType& effect) noexcept;

/// Effects fitted together, the one in question told by its type; nothing where they cannot be the cause.
[[nodiscard]] std::optional<Candidate> fit_together(const IdentificationProblem& problem, const EffectType* type,
                                                    const std::vector<EffectSetting>& start,
                                                    decltype(refit_effects)& fit);

/// Where a sensor's effect leads, and one of a stage changes the prediction alike, the stage's comes first.
void put_stage_before_sensor(std::vector<Candidate>& candidates);

/// The problem with these effects in its model. The scales, floors and free numbers stay.
[[nodiscard]] IdentificationProblem beside_effects(const IdentificationProblem& problem,
                                                   const std::vector<EffectSetting>& effects);

/// What is free beside effects that are screened: nothing; the numbers of the model; and what was found, too, for small
/// changes, since by itself it has taken up part of another effect.
enum class Beside : std::uint8_t { as_found, numbers_free, all_giving_way };

/// Every judged effect but those in `base` fitted together with them, best score first. All are screened
/// on `coarse` with what `freedom` leaves free; the most promising ones, and the numbers of the model that may be
/// wrong, are searched there with everything free, as a second effect may move the first one far; those that come near
/// the best are fitted to `problem` from there.
[[nodiscard]] std::vector<Candidate> fit_beside(const IdentificationProblem& problem,
                                                const IdentificationProblem& coarse,
                                                const std::vector<EffectSetting>& base, Beside freedom,
                                                const PartProgress& progress);

}  // namespace hybridtest
