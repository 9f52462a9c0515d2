#include "core/model_fault.hpp"

#include <array>
#include <cstdio>

namespace hybridtest {
namespace {

constexpr double kFirstSignal = 129.0;

std::string with_number(const char* format, double value) {
  std::array<char, 256> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

}  // namespace

std::string describe(const ModelFailure& failure) {
  switch (failure.fault) {
    case ModelFault::not_converged:
      return with_number(
          "it finds no equilibrium at this displacement, also in smaller parts and with other algorithms (residual "
          "%.3g); shorten the step, or give the script a convergence test or an algorithm that suits the model",
          failure.value);
    case ModelFault::ended:
      if (failure.value >= kFirstSignal) {
        return with_number("its process was ended by signal %.0f", failure.value - kFirstSignal + 1.0);
      }
      return with_number("its process ended by itself with exit code %.0f", failure.value);
    case ModelFault::silent:
      return with_number(
          "its process has not answered for %.3g s; a model that takes longer needs a larger model.answer_timeout_s",
          failure.value);
    case ModelFault::script: return "its script or its analysis reported an error";
    case ModelFault::unknown: break;
  }
  return "it failed";
}

}  // namespace hybridtest
