#pragma once

#include <optional>
#include <span>
#include <vector>

#include "diagnosis/identification/search_table.hpp"
#include "plant/effects/effect_type.hpp"
#include "plant/site_model.hpp"

namespace hybridtest {

/// A law that may take the place of the specimen's own, with its search ranges.
///
/// Searched are the initial stiffness, or the friction of what slides, in which the force is linear (variable
/// projection), the displacement at which it yields or slides, and ratios: so the ranges fit any specimen, and the
/// stiffness that the user's model has plays no part. written() gives the law's own parameters.
struct LawCandidate {
  EffectType type;
  std::vector<SearchRange> ranges;  // one per parameter of the effect
  // Searched only where no simpler law explains the gap; from the result of this one. null: searched by itself.
  const EffectType* refines = nullptr;
  // Where the search begins for the parameters that it has beyond that law's.
  std::vector<double> start;
  // It unloads the softer, the more it went through.
  bool softens = false;
  // Of a special device, and searched only where everything else leaves something to explain.
  bool is_special = false;
};

/// Laws of increasing detail. Beside a spring, a law that yields is called `yielding`: it is what the user's model
/// lacks, and not another form of it. Every other law is a `hysteresis_law`.
/// @param law_is_spring   of the user's model.
[[nodiscard]] std::span<const LawCandidate> law_candidates(bool law_is_spring);

/// The entry of a replacement.
[[nodiscard]] const LawCandidate& law_candidate(const EffectType& replacement);

/// Whether both are laws, and of one name: one has parameters that the other has not.
[[nodiscard]] bool are_the_same_law(const EffectType& one, const EffectType& other) noexcept;

/// Whether a law that replaces the model's has the same form: it differs in its numbers alone.
[[nodiscard]] bool has_own_form(const SiteModel& model, const EffectSetting& replacement);

/// The search range of a parameter of an effect, of a law or of a formula; nothing: it is not searched.
[[nodiscard]] std::optional<SearchRange> range_of(const EffectType& effect, const EffectParameter& parameter);

}  // namespace hybridtest
