#include "diagnosis/identification/remembered_law.hpp"

#include <cstddef>
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

 private:
  void take_along() noexcept {
    law_ = make_();
    for (std::size_t i = 0; i < next_; ++i) {
      static_cast<void>(law_->trial(memory_->displacement_m[i], memory_->velocity_m_per_s[i]));
      law_->commit();
    }
  }

  std::function<std::unique_ptr<Law>()> make_;
  std::shared_ptr<const LawMemory> memory_;
  std::unique_ptr<Law> law_;  // once the path has been left
  std::size_t next_ = 0;
};

}  // namespace

std::unique_ptr<Law> remembering(std::unique_ptr<Law> law, LawMemory& memory) {
  return std::make_unique<RememberingLaw>(std::move(law), memory);
}

std::unique_ptr<Law> from_memory(std::function<std::unique_ptr<Law>()> make, std::shared_ptr<const LawMemory> memory) {
  return std::make_unique<LawFromMemory>(std::move(make), std::move(memory));
}

}  // namespace hybridtest
