#pragma once

#include <vector>

#include "validation/blind_batches/plant/history.hpp"
#include "validation/blind_batches/plant/random_stream.hpp"
#include "validation/blind_batches/plant/site.hpp"

namespace hybridtest::blind {

/// Which displacements are recorded besides the measured one and the force.
struct RecordedColumns {
  bool sent = false;
  bool target = false;
  bool command = false;
};

/// By what an effect is scaled to a site: largest values under the first fit excitation without any effect.
struct Scales {
  double displacement_m = 0.0;
  double velocity_m_per_s = 0.0;
  double acceleration_m_per_s2 = 0.0;
  double force_n = 0.0;
  double duration_s = 0.0;
};

/// Everything of a case that does not depend on its effect, and is drawn before it.
struct CaseSetting {
  Site site;
  RecordedColumns columns;
  std::vector<History> fit_m;  // what the coordinator sends; one or two
  History held_out_m;
  Scales scales;
};

/// Streams "site", "excitation" of (seed, index).
[[nodiscard]] CaseSetting draw_case_setting(std::uint64_t seed, std::uint64_t index);

/// Two significant digits, as a data sheet would have it.
[[nodiscard]] double rounded(double value, int digits = 2);

}  // namespace hybridtest::blind
