#pragma once

#include "validation/blind_batches/plant/blind_case.hpp"

/// Which other causes would have left the same trace in this very recording.
namespace hybridtest::blind {

/// Where a cause shows: a displacement sensor at the transfer system when the command was recorded.
[[nodiscard]] Residual residual_of(const std::string& interface, const RecordedColumns& columns);

/// What a stage puts out with the effects less what the user's model says, without noise.
[[nodiscard]] History true_gap(Residual residual, const Site& site, const TrueSignals& signals);

/// Causes of the catalogue whose signature, as large as fits best, leaves less than 0.3 of the
/// floor of the gap. Their amounts are found by repeated linear fits of one number.
/// @param floor   rms.
[[nodiscard]] std::vector<Cause> collinear_causes(const CaseSetting& setting, Residual residual, const History& gap,
                                                  double floor, RandomStream& random);

/// Largest share of the gap's mean square that a single cause of the catalogue explains.
[[nodiscard]] double best_explained(const CaseSetting& setting, Residual residual, const History& gap,
                                    RandomStream& random);

}  // namespace hybridtest::blind
