#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "mechanics/laws/law.hpp"

namespace hybridtest {

/// The forces of a law along one path.
struct LawMemory {
  std::vector<double> displacement_m;
  std::vector<double> velocity_m_per_s;
  std::vector<double> force_n;
};

/// Stores the forces of `law`. @param memory   must outlive the law.
[[nodiscard]] std::unique_ptr<Law> remembering(std::unique_ptr<Law> law, LawMemory& memory);

/// Returns stored forces as long as the path is the same. From the first difference it evaluates the law itself,
/// after stepping it along the path so far. Most effects do not change the displacement of the specimen's own
/// law, and laws with a history cost most of the computing time.
/// Steps are tried once and committed, as a stage does.
[[nodiscard]] std::unique_ptr<Law> from_memory(std::function<std::unique_ptr<Law>()> make,
                                               std::shared_ptr<const LawMemory> memory);

}  // namespace hybridtest
