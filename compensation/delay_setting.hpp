#pragma once

namespace hybridtest {

/// The delay that somebody set a compensator to make up for, which may be another one than is believed.
struct DelaySetting {
  double set_s = 0.0;   // [s]
  double most_s = 0.0;  // [s] that it may be; 0: the compensator has no such setting
};

}  // namespace hybridtest
