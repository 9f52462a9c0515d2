#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/verdict/library_fits.hpp"

namespace hybridtest {

/// Whether an effect fitted together with others may as well be absent, or the recordings refute it by themselves. It
/// may be absent where the 95 % interval of what it is proportional to, or of its only parameter, holds the value at
/// which it is: of what a model lacks besides other effects the interval that is reported, else the one beside numbers
/// of the model that are right.
/// @param position   in the fit's effects.
[[nodiscard]] bool is_needless(const IdentificationProblem& problem, const FitOutcome& fit, std::size_t position);

/// Whether the interval that is reported (95 %) of what an effect is proportional to, or of its only parameter, holds
/// the value at which it is absent, whatever its fit gains; of a law, while its shape is held. Never of an effect that
/// the model has.
/// @param position   in the fit's effects.
[[nodiscard]] bool may_be_absent(const IdentificationProblem& problem, const FitOutcome& fit, std::size_t position);

/// Whether an effect is a self-centring law whose loop is closed (it has no flag, or its interval of 95 % holds one of
/// no height), and none of the others has a loop: what is left of it is a force that bends, as that of a load cell at
/// its limit does.
/// @param position   in the fit's effects.
[[nodiscard]] bool is_law_without_loop(const IdentificationProblem& problem, const FitOutcome& fit,
                                       std::size_t position);

/// Whether the others take back all but a tenth of what an effect changes, as a damping does of a lag: of such two the
/// recordings show the difference, and neither.
/// @param position   in the fit's effects.
[[nodiscard]] bool is_cancelled(const IdentificationProblem& problem, const FitOutcome& fit, std::size_t position);

/// Whether a friction that the model has slides no later than it does there. What the user calls a friction is one,
/// however late it slides.
/// @param position   in the fit's effects.
[[nodiscard]] bool slides_as_in_model(const IdentificationProblem& problem, const FitOutcome& fit,
                                      std::size_t position);

/// Where the values of a dry friction have its presliding displacement; nothing for other effects and for laws.
[[nodiscard]] std::optional<std::size_t> presliding_of(const EffectType& type);

/// Why a candidate cannot be the cause, whatever its fit gains: the recordings refute it by themselves. In words, with
/// values; empty when nothing speaks against it. Refuted are
///
/// - a limit of a load cell, of stroke or of velocity that readings pass, or that none comes near;
/// - a bias or drift of a sensor, when readings at rest are nearer to none than to that one;
/// - a candidate whose own interval (95 %), of what it is proportional to or of its only parameter, holds the value at
///   which it is absent;
/// - a column that is shorter than ten times its drift;
/// - a further effect with a parameter at the end of its search range, see is_cut_off();
/// - one of which the others beside it take back all but a tenth;
/// - a fracture so early that the recordings do not show what the part carried before;
/// - dry friction that sticks over more than half of the path: that is an elastoplastic spring.
[[nodiscard]] std::string refutation(const IdentificationProblem& problem, const Candidate& candidate);

/// A parameter of an effect stands at the end of its search range at which the effect is largest, and the range ends
/// there by choice: neither the parameter nor the model does.
[[nodiscard]] bool is_cut_off(const IdentificationProblem& problem, const FitOutcome& fit, std::size_t position);

/// Drops what is refuted; the order of the others stays.
void drop_refuted(const IdentificationProblem& problem, std::vector<Candidate>& candidates);

}  // namespace hybridtest
