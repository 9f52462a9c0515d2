#pragma once

#include <functional>
#include <string>
#include <vector>

namespace hybridtest {

/// What a process took, as the system counts it.
struct ProcessCost {
  int exit_code = 0;  // 128 + signal when a signal ended it
  double processor_s = 0.0;
  double memory_mb = 0.0;  // the most that it had at once
};

/// Some work in a process of its own. Its memory begins with that of the caller, which should be small.
[[nodiscard]] ProcessCost cost_of(const std::function<void()>& work);

/// A program, without its output.
[[nodiscard]] ProcessCost cost_of_program(const std::vector<std::string>& command);

}  // namespace hybridtest
