#include "plant/transfer_systems/delay.hpp"

namespace hybridtest {

double Delay::step(double command_m) noexcept {
  line_.push(command_m);
  return line_.delayed_smoothly();
}

}  // namespace hybridtest
