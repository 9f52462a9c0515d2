#pragma once

#include <span>

#include "diagnosis/recording.hpp"
#include "plant/site_model.hpp"

namespace hybridtest {

/// Noise of the sensors of a site in a recording: what enters the structure with the measured force, and the
/// compensators with the measured displacement. Of several degrees of freedom the root mean square.
///
/// White noise is that of the channel by itself (typical_white_noise()). Coloured noise is in what the completed model
/// leaves (noise_parts()), of a force for the displacement that the model predicts from the command: that has no noise
/// of the displacement reading, which does not enter the structure. What follows from the motion (Discrepancy) is taken
/// off before; where that is half or more, what is left is no noise, and the noise is taken as white.
/// @param completed   the model with the causes that were found, one per degree of freedom.
[[nodiscard]] SensorNoise noise_of_sensors(std::span<const SiteModel> completed, const Recording& recording);

}  // namespace hybridtest
