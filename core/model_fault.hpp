#pragma once

#include <cstdint>
#include <string>

namespace hybridtest {

/// Why a model of a numerical substructure failed. Sent as a number: new reasons go to the end.
enum class ModelFault : std::uint8_t {
  unknown,
  not_converged,  // value: last norm of its convergence test
  ended,          // its process; value: exit code, or 128 + signal
  silent,         // value: time without an answer [s]
  script,         // an error in its program
};

struct ModelFailure {
  ModelFault fault = ModelFault::unknown;
  double value = 0.0;
};

/// For messages, such as "its process was ended by signal 9".
[[nodiscard]] std::string describe(const ModelFailure& failure);

}  // namespace hybridtest
