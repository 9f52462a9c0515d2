#pragma once

#include <vector>

#include "diagnosis/diagnose.hpp"
#include "diagnosis/structure/structure_fit.hpp"

namespace hybridtest {

/// Whether the structure of a scenario gives the displacements that were commanded, and if not, which of its
/// numbers is wrong.
struct StructureDiagnosis {
  double nrmse = 0.0;        // of the displacements recomputed with the scenario as given
  double floor_nrmse = 0.0;  // rounding: of every step, integrated twice as a random walk, steps^1.5 / 2^53
  report::Verdict verdict = report::Verdict::none;  // none, named or unknown
  StructureFit fit;                                 // the causes; none in it for none and unknown
  std::vector<double> shares;                       // one per cause: of what they explain
  double gap_left = 1.0;                            // share of the gap's energy that the causes leave
};

/// Effects are taken one by one, the best first, for as long as each leaves a good part less. What is computed has
/// no noise: a right set of ratios leaves rounding and nothing else. Several wrong ones together come near many a
/// gap; they are not named.
[[nodiscard]] StructureDiagnosis diagnose_structure(const ComputedStructure& model,
                                                    const StructureRecording& recording);

/// Puts the interface `numerical_substructure` into a site's diagnosis: its place among the others, its causes, and
/// what both say together. Its effects do not go into Diagnosis::causes, which are of the site's model.
void add_structure(const StructureDiagnosis& structure, Diagnosis& diagnosis);

/// The causes as effects of a scenario.
[[nodiscard]] std::vector<EffectSetting> causes_of(const StructureDiagnosis& structure);

}  // namespace hybridtest
