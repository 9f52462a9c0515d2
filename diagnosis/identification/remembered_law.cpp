#include "diagnosis/identification/remembered_law.hpp"

#include <algorithm>
#include <utility>

namespace hybridtest {
namespace {

class RememberingLaw final : public Law {
 public:
  RememberingLaw(std::unique_ptr<Law> law, LawMemory& memory) : law_{std::move(law)}, memory_{memory} {}

  double trial(double displacement_m, double velocity_m_per_s) noexcept override {
    const double force_n = law_->trial(displacement_m, velocity_m_per_s);
    memory_.displacement_m.push_back(displacement_m);
    memory_.velocity_m_per_s.push_back(velocity_m_per_s);
    memory_.force_n.push_back(force_n);
    return force_n;
  }
  void commit() noexcept override { law_->commit(); }
  void revert() noexcept override { law_->revert(); }
  void reset() noexcept override { law_->reset(); }
  [[nodiscard]] double initial_stiffness_n_per_m() const noexcept override { return law_->initial_stiffness_n_per_m(); }
  void ignore_reversals_within(double distance_m) noexcept override { law_->ignore_reversals_within(distance_m); }

 private:
  std::unique_ptr<Law> law_;
  LawMemory& memory_;
};

class LawFromMemory final : public Law {
 public:
  LawFromMemory(std::function<std::unique_ptr<Law>()> make, std::shared_ptr<const LawMemory> memory)
      : make_{std::move(make)}, memory_{std::move(memory)} {}

  double trial(double displacement_m, double velocity_m_per_s) noexcept override {
    const bool on_the_path = law_ == nullptr && next_ < memory_->displacement_m.size() &&
                             memory_->displacement_m[next_] == displacement_m &&
                             memory_->velocity_m_per_s[next_] == velocity_m_per_s;
    if (on_the_path) return memory_->force_n[next_++];
    if (law_ == nullptr) take_along();
    return law_->trial(displacement_m, velocity_m_per_s);
  }
  void commit() noexcept override {
    if (law_ != nullptr) law_->commit();
  }
  void revert() noexcept override {
    if (law_ != nullptr) law_->revert();
  }
  void reset() noexcept override {
    law_.reset();
    next_ = 0;
  }
  [[nodiscard]] double initial_stiffness_n_per_m() const noexcept override {
    return make_()->initial_stiffness_n_per_m();
  }
  void ignore_reversals_within(double distance_m) noexcept override { least_reversal_m_ = distance_m; }

 private:
  void take_along() noexcept {
    law_ = make_();
    law_->ignore_reversals_within(least_reversal_m_);
    for (std::size_t i = 0; i < next_; ++i) {
      static_cast<void>(law_->trial(memory_->displacement_m[i], memory_->velocity_m_per_s[i]));
      law_->commit();
    }
  }

  std::function<std::unique_ptr<Law>()> make_;
  std::shared_ptr<const LawMemory> memory_;
  std::unique_ptr<Law> law_;  // after the path differs from the remembered one
  double least_reversal_m_ = 0.0;
  std::size_t next_ = 0;
};

/// A law whose force is so many times that of another one.
class ScaledLaw final : public Law {
 public:
  ScaledLaw(std::unique_ptr<Law> law, double times) : law_{std::move(law)}, times_{times} {}

  double trial(double displacement_m, double velocity_m_per_s) noexcept override {
    return times_ * law_->trial(displacement_m, velocity_m_per_s);
  }
  void commit() noexcept override { law_->commit(); }
  void revert() noexcept override { law_->revert(); }
  void reset() noexcept override { law_->reset(); }
  [[nodiscard]] double initial_stiffness_n_per_m() const noexcept override {
    return times_ * law_->initial_stiffness_n_per_m();
  }
  void ignore_reversals_within(double distance_m) noexcept override { law_->ignore_reversals_within(distance_m); }

 private:
  std::unique_ptr<Law> law_;
  double times_;
};

EffectSetting of_unit_size(const EffectSetting& replacement) {
  EffectSetting unit = replacement;
  unit.values[0] = 1.0;
  return unit;
}

}  // namespace

std::unique_ptr<Law> remembering(std::unique_ptr<Law> law, LawMemory& memory) {
  return std::make_unique<RememberingLaw>(std::move(law), memory);
}

std::unique_ptr<Law> from_memory(std::function<std::unique_ptr<Law>()> make, std::shared_ptr<const LawMemory> memory) {
  return std::make_unique<LawFromMemory>(std::move(make), std::move(memory));
}

std::unique_ptr<Law> remembered(const EffectSetting& replacement, std::shared_ptr<const LawMemory> of_unit) {
  const auto make = [unit = of_unit_size(replacement)] { return unit.type->replacement->make(unit.values); };
  return std::make_unique<ScaledLaw>(from_memory(make, std::move(of_unit)), replacement.values[0]);
}

std::unique_ptr<Law> remembering(const EffectSetting& replacement, LawMemory& of_unit) {
  const EffectSetting unit = of_unit_size(replacement);
  return std::make_unique<ScaledLaw>(remembering(unit.type->replacement->make(unit.values), of_unit),
                                     replacement.values[0]);
}

std::shared_ptr<const LawMemory> LawMemories::find(const EffectSetting& replacement, std::size_t segment) {
  const std::scoped_lock lock{mutex_};
  const auto entry = entry_of(replacement, segment);
  if (entry == entries_.end()) return nullptr;
  entry->last_use = ++uses_;
  return entry->memory;
}

void LawMemories::keep(const EffectSetting& replacement, std::size_t segment, std::shared_ptr<LawMemory> memory) {
  const std::scoped_lock lock{mutex_};
  if (entry_of(replacement, segment) != entries_.end()) return;
  if (entries_.size() >= most_) entries_.erase(std::ranges::min_element(entries_, {}, &Entry::last_use));
  entries_.push_back({of_unit_size(replacement), segment, std::move(memory), ++uses_});
}

std::vector<LawMemories::Entry>::iterator LawMemories::entry_of(const EffectSetting& replacement, std::size_t segment) {
  return std::ranges::find_if(entries_, [&](const Entry& entry) {
    return entry.segment == segment && entry.unit.type == replacement.type &&
           std::equal(entry.unit.values.begin() + 1, entry.unit.values.end(), replacement.values.begin() + 1);
  });
}

}  // namespace hybridtest
