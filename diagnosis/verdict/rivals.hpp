#pragma once

#include <optional>
#include <vector>

#include "diagnosis/verdict/causes.hpp"

namespace hybridtest {

/// Looks for effects that these recordings cannot tell from a chosen one: of the causes, that with the largest share
/// that has any. Each is fitted in its place, beside the other causes. It is a rival if
///
/// - the model replays the same with either: the difference is a twentieth of what the chosen effect changes, at most
///   (tuning::kSameSignature), or a tenth (tuning::kHardlyLeft) where the recordings do not speak for the chosen one,
///   and the other causes stay as they are, but for one that goes with the chosen one (go_together());
/// - the recordings do not resolve that difference: the held-out log density loses no more than the standard error of
///   that loss (Vehtari, Gelman and Gabry, Stat. Comput. 27, 2017) or than decides between two effects, or no model is
///   expected to reproduce the difference (tuning::kModelAllowance). Numbers at other channels that would have to be
///   off for it cost no more than decides;
/// - numbers of the model that it needs beside it change no more than those beside the chosen effect; or else they are
///   slightly off only, or as they are beside the chosen effect, and change less than it does. A force that is read a
///   sample late, for example, makes a flexible frame under a spring a gain and a delay of a part of that sample;
/// - nothing refutes it (refutation()), none of its parameters is at a limit, and it has no more of them. Whether
///   it may be absent is judged with the chosen effect surely absent, in whose place it is.
///
/// Laws in place of the specimen's own are not among them: their scores decide. With rivals a name becomes a set, and
/// so does what leaves little enough.
/// @param coarse   the same problem at a lower rate, for the searches.
void find_rivals(const IdentificationProblem& problem, const IdentificationProblem& coarse, const Selection& selection,
                 const VerdictPolicy& policy, const PartProgress& progress, Judgement& judgement);

/// The numbers of the specimen's law go together: a gain of the load cell in the place of its strength leaves another
/// stiffness than the one beside that strength.
[[nodiscard]] bool go_together(const EffectType& one, const EffectType& other) noexcept;

/// A displacement transducer that lags shows at two channels: the motion seems late, as by a delay or a bandwidth of
/// the actuator, and the force early, as by damping of the specimen. The channels are judged one after the other, which
/// finds these two. The one lag is a rival of the damping if the recordings do not tell it from both together.
/// @param whole   all channels, judged together.
/// @param found   the effects of all channels.
/// @return the lag first, beside all that it does not stand for; nothing where found effects do not look like one.
[[nodiscard]] std::optional<Candidate> lag_of_transducer(IdentificationProblem whole,
                                                         const std::vector<EffectSetting>& found,
                                                         const VerdictPolicy& policy);

}  // namespace hybridtest
