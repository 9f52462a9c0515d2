#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "mechanics/laws/law.hpp"
#include "plant/site_model.hpp"

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

/// Likewise of the law of a replacement, whose size scales its force: what is stored is of unit size.
[[nodiscard]] std::unique_ptr<Law> remembering(const EffectSetting& replacement, LawMemory& of_unit);
[[nodiscard]] std::unique_ptr<Law> remembered(const EffectSetting& replacement,
                                              std::shared_ptr<const LawMemory> of_unit);

/// What replacements gave along the paths of segments, for all sizes of the same shape: those used last. For any
/// threads.
class LawMemories {
 public:
  explicit LawMemories(std::size_t most) : most_{most} {}

  /// null: not there.
  [[nodiscard]] std::shared_ptr<const LawMemory> find(const EffectSetting& replacement, std::size_t segment);
  void keep(const EffectSetting& replacement, std::size_t segment, std::shared_ptr<LawMemory> memory);

 private:
  struct Entry {
    EffectSetting unit;
    std::size_t segment = 0;
    std::shared_ptr<LawMemory> memory;
    std::uint64_t last_use = 0;
  };
  [[nodiscard]] std::vector<Entry>::iterator entry_of(const EffectSetting& replacement, std::size_t segment);

  std::mutex mutex_;
  std::size_t most_;
  std::vector<Entry> entries_;
  std::uint64_t uses_ = 0;
};

}  // namespace hybridtest
