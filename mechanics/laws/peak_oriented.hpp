#pragma once

#include "mechanics/laws/deteriorating_hysteresis.hpp"

namespace hybridtest {

/// Spring that reloads in a straight line towards the largest displacement it has seen (Clough, PCA report, 1966), as a
/// reinforced concrete member in bending does. With the keys beyond the first three, the backbone is capped and
/// deteriorates: the modified Ibarra-Medina-Krawinkler model with peak-oriented response. For the equations see
/// DeterioratingHysteresis.
class PeakOriented final : public DeterioratingHysteresis {
 public:
  /// @throws ConfigError for values outside their ranges, or capping without a post-capping displacement.
  explicit PeakOriented(const Parameters& parameters) : DeterioratingHysteresis{parameters, Form{}} {}
};

}  // namespace hybridtest
