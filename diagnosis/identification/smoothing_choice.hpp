#pragma once

#include <cstddef>
#include <vector>

#include "diagnosis/identification/segment.hpp"
#include "diagnosis/progress.hpp"
#include "diagnosis/recording.hpp"
#include "plant/site_model.hpp"

namespace hybridtest {

/// The segments of one degree of freedom that a model predicts, along the chain. If the modelled force depends on
/// velocity or acceleration, which displacement sensors measure badly, force and motion are smoothed equally
/// (smoothed_alike()). The deviation is chosen so that the prediction is nearest to the recorded force: less smoothing
/// leaves noise in the derivatives, more smoothing reduces their peaks.
/// @param completed   the model whose force decides on the smoothing: the same, or with the causes that were found.
/// @param progress    told of each smoothing that is tried.
[[nodiscard]] std::vector<Segment> modelled_segments(const SiteModel& model, const Recording& recording,
                                                     std::size_t dof, std::size_t position, const SiteModel& completed,
                                                     const PartProgress& progress = {});
[[nodiscard]] std::vector<Segment> modelled_segments(const SiteModel& model, const Recording& recording,
                                                     std::size_t dof, std::size_t position);

/// The same for a search of causes: force and motion are smoothed equally, too, where a mass that the model lacks would
/// explain most of its residual.
[[nodiscard]] std::vector<Segment> segments_to_search(const SiteModel& model, const Recording& recording,
                                                      std::size_t dof, std::size_t position,
                                                      const PartProgress& progress = {});

/// What the prediction of a force changes by where the motion alone is smoothed, just as far as it helps: until it is
/// about as near to the recorded force as it gets, beside a spring and a damper that the model may lack. So much the
/// noise that rides on the motion has changed it, coloured noise too. One value per sample; empty where nothing helps,
/// and of other channels.
[[nodiscard]] std::vector<double> change_by_smoothing(const SiteModel& model, const Segment& segment);

/// Segment::smoothing_error beside effects that take the place of something in the model: as much larger or less than
/// the model's own as what the same smoothing once more does to both.
[[nodiscard]] double smoothing_error_beside(const SiteModel& model, std::span<const EffectSetting> effects,
                                            const Segment& segment);

}  // namespace hybridtest
