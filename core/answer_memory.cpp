#include "core/answer_memory.hpp"

#include <algorithm>
#include <cstring>

namespace hybridtest {
namespace {

constexpr std::size_t kMemoryBytes = std::size_t{32} << 20U;
constexpr std::size_t kAnswersMost = 8192;
constexpr std::size_t kAnswersLeast = 64;
constexpr std::size_t kVectorsPerAnswer = 4;

}  // namespace

AnswerMemory::AnswerMemory(std::size_t answers, Eigen::Index dofs) : entries_(answers) {
  const auto columns = static_cast<Eigen::Index>(answers);
  for (Eigen::MatrixXd* one : {&commanded_m_, &imposed_m_, &measured_m_, &force_n_}) one->setZero(dofs, columns);
}

std::size_t AnswerMemory::answers_for(Eigen::Index dofs) noexcept {
  const auto bytes = kVectorsPerAnswer * sizeof(double) * static_cast<std::size_t>(std::max<Eigen::Index>(dofs, 1));
  return std::clamp(kMemoryBytes / bytes, kAnswersLeast, kAnswersMost);
}

void AnswerMemory::keep_command(Step step, std::uint16_t iteration,
                                const Eigen::Ref<const Eigen::VectorXd>& displacement_m) noexcept {
  if (entries_.empty() || displacement_m.size() != commanded_m_.rows()) return;
  entries_[next_] = {.step = step, .iteration = iteration};
  commanded_m_.col(static_cast<Eigen::Index>(next_)) = displacement_m;
  next_ = (next_ + 1) % entries_.size();
  count_ = std::min(count_ + 1, entries_.size());
}

void AnswerMemory::keep_answer(Step step, std::uint16_t iteration, double model_time_s,
                               const Eigen::Ref<const Eigen::VectorXd>& imposed_m,
                               const Eigen::Ref<const Eigen::VectorXd>& measured_m,
                               const Eigen::Ref<const Eigen::VectorXd>& force_n, MeasurementFlags flags) noexcept {
  const Eigen::Index at = find(step, [&](const Entry& entry) { return entry.iteration == iteration; });
  if (at < 0) return;
  Entry& entry = entries_[static_cast<std::size_t>(at)];
  entry.is_answered = true;
  entry.flags = flags;
  entry.model_time_s = model_time_s;
  imposed_m_.col(at) = imposed_m;
  measured_m_.col(at) = measured_m;
  force_n_.col(at) = force_n;
}

Recall AnswerMemory::recall(const CommandPoint& point, std::uint16_t iteration,
                            ForceMeasurement& answer) const noexcept {
  const Eigen::Index at = find(point.step, [&](const Entry& entry) { return entry.iteration == iteration; });
  if (at < 0) return Recall::forgotten;
  if (!has_same_bits(at, point)) return Recall::different;
  const Entry& entry = entries_[static_cast<std::size_t>(at)];
  if (!entry.is_answered) return Recall::pending;
  answer.step = entry.step;
  answer.iteration = entry.iteration;
  answer.model_time_s = entry.model_time_s;
  answer.flags = entry.flags;
  answer.imposed_displacement_m = imposed_m_.col(at);
  answer.measured_displacement_m = measured_m_.col(at);
  answer.force_n = force_n_.col(at);
  return Recall::answered;
}

const CommandPoint* AnswerMemory::first_other(const DisplacementCommand& command, Step last) const noexcept {
  for (int i = 1; i < command.point_count; ++i) {
    const CommandPoint& point = command.points[static_cast<std::size_t>(i)];
    if (point.step <= last && !agrees_with(point)) return &point;
  }
  return nullptr;
}

bool AnswerMemory::agrees_with(const CommandPoint& point) const noexcept {
  const Eigen::Index at = find(point.step, [](const Entry&) { return true; });
  return at < 0 || has_same_bits(at, point);
}

std::array<double, 2> AnswerMemory::difference(const CommandPoint& point) const noexcept {
  const Eigen::Index at = find(point.step, [](const Entry&) { return true; });
  if (at < 0 || point.displacement_m.size() != commanded_m_.rows()) return {};
  for (Eigen::Index k = 0; k < commanded_m_.rows(); ++k) {
    if (std::memcmp(&commanded_m_(k, at), &point.displacement_m[k], sizeof(double)) != 0) {
      return {commanded_m_(k, at), point.displacement_m[k]};
    }
  }
  return {};
}

Step AnswerMemory::oldest_step() const noexcept {
  if (count_ == 0) return kNoStep;
  return entries_[(next_ + entries_.size() - count_) % entries_.size()].step;
}

template <class Fits>
Eigen::Index AnswerMemory::find(Step step, Fits fits) const noexcept {
  for (std::size_t back = 1; back <= count_; ++back) {
    const std::size_t at = (next_ + entries_.size() - back) % entries_.size();
    if (entries_[at].step < step) break;  // in the order of steps
    if (entries_[at].step == step && fits(entries_[at])) return static_cast<Eigen::Index>(at);
  }
  return -1;
}

bool AnswerMemory::has_same_bits(Eigen::Index at, const CommandPoint& point) const noexcept {
  if (point.displacement_m.size() != commanded_m_.rows()) return false;
  // Not ==, for which 0 is -0.
  return std::memcmp(commanded_m_.col(at).data(), point.displacement_m.data(),
                     sizeof(double) * static_cast<std::size_t>(commanded_m_.rows())) == 0;
}

}  // namespace hybridtest
