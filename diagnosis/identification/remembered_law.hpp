#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "mechanics/laws/law.hpp"

namespace hybridtest {

/// What a law answered along one path.
struct LawMemory {
  std::vector<double> displacement_m;
  std::vector<double> velocity_m_per_s;
  std::vector<double> force_n;
};

/// Writes down what `law` answers. @param memory   must outlive the law.
[[nodiscard]] std::unique_ptr<Law> remembering(std::unique_ptr<Law> law, LawMemory& memory);

/// Answers from memory for as long as the path is the same, and by the law itself, taken along the path so
/// far, from where it is not: most effects leave the displacement that the specimen's own law sees
/// alone, and laws with a history cost more than everything else.
/// Steps are tried once and committed, as a stage does.
[[nodiscard]] std::unique_ptr<Law> from_memory(std::function<std::unique_ptr<Law>()> make,
                                               std::shared_ptr<const LawMemory> memory);

}  // namespace hybridtest
