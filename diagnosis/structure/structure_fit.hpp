#pragma once

#include <vector>

#include "diagnosis/structure/computed_structure.hpp"

namespace hybridtest {

/// An error of the structure with what the record says of it.
struct FittedRatio {
  const StructureEffect* effect = nullptr;
  double value = 0.0;
  double standard_error = 0.0;  // of a remainder that is worth so many independent samples a second
  bool at_bound = false;        // of the effect's search range
};

struct StructureFit {
  std::vector<FittedRatio> ratios;
  double nrmse = 0.0;  // of the recomputed displacements, over that of the recorded ones

  [[nodiscard]] StructureErrors errors() const;
};

/// Ratios with which the recomputed displacements come closest to the recorded ones, least squares over the whole
/// record and every degree of freedom, within the effects' search ranges. Gauss-Newton with differences of 1e-6,
/// halved while it does not descend.
/// @param start   the effects to fit, and from where.
[[nodiscard]] StructureFit fit_structure(const ComputedStructure& model, const StructureRecording& recording,
                                         std::vector<FittedRatio> start);

}  // namespace hybridtest
