#include "runtime/incarnation.hpp"

#include <random>

namespace hybridtest {

Incarnation draw_incarnation() {
  std::random_device device;
  const auto high = static_cast<Incarnation>(device());
  return (high << 32U | device()) | 1U;
}

}  // namespace hybridtest
