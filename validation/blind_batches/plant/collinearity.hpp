#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "validation/blind_batches/plant/blind_case.hpp"
#include "validation/blind_batches/plant/effect_catalogue.hpp"

/// Other causes that would give the same gap in this recording.
namespace hybridtest::blind {

/// Makes the effect `factor` times as strong, to first order, within what a site can have.
void strengthen(PlantEffect& effect, double factor, const Scales& scales);

/// What an effect changes in the output of one stage, whose recorded inputs stay as they are. Coarser than the plant
/// itself: a quarter of its steps.
class Signatures {
 public:
  /// @param besides   wrong numbers that the real site has anyway.
  Signatures(const Site& site, const RecordedColumns& columns, PlantEffects besides, const TrueSignals& signals);

  /// At the rate of the recording.
  [[nodiscard]] History of(const PlantEffect& effect) const;
  /// The part of a signature that no change of the wrong numbers could give.
  [[nodiscard]] History beyond_besides(Residual residual, History signature) const;

 private:
  [[nodiscard]] History output(Residual residual, const PlantEffects& effects) const;

  Site site_;
  RecordedColumns columns_;
  PlantEffects besides_;
  const TrueSignals& signals_;
  History fine_command_m_;
  MotionHistory motion_;
  std::map<Residual, History> without_;                  // output with the besides alone
  std::map<Residual, std::vector<History>> directions_;  // orthonormal, of the besides
};

struct LookAlikes {
  std::vector<Cause> same;       // leave less than 0.3 of the floor, as large as fits best
  std::vector<Cause> half;       // explain at least half of the mean square, but not that
  std::vector<Cause> tolerated;  // give what the wrong numbers give
};

/// @param gap     what an effect changes at the residual. Empty: only what is tolerated.
/// @param floor   rms.
[[nodiscard]] LookAlikes look_alikes(const CaseSetting& setting, const Signatures& signatures, Residual residual,
                                     const History& gap, double floor, RandomStream& random);

}  // namespace hybridtest::blind
