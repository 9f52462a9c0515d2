#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/messages.hpp"

namespace hybridtest {

/// What a memory says of a command that is repeated.
enum class Recall : std::uint8_t {
  answered,   // here is the answer
  pending,    // the same command; its answer is not there yet
  different,  // another displacement was commanded in this step
  forgotten,  // not in the memory
};

/// The last commands of a substructure and their answers, for a coordinator that is resumed from its recording and asks
/// for steps again that it had not recorded. A ring; everything is allocated at the start.
class AnswerMemory {
 public:
  AnswerMemory() = default;
  /// @param answers   0: remembers nothing.
  AnswerMemory(std::size_t answers, Eigen::Index dofs);

  /// How many answers take a stated amount of memory, 32 MiB. A coordinator loses what it had not flushed: 100 ms.
  [[nodiscard]] static std::size_t answers_for(Eigen::Index dofs) noexcept;

  /// A command that is being followed. In the order of steps and iterations.
  void keep_command(Step step, std::uint16_t iteration,
                    const Eigen::Ref<const Eigen::VectorXd>& displacement_m) noexcept;
  /// The answer to it. Without effect for a command that is not kept.
  void keep_answer(Step step, std::uint16_t iteration, double model_time_s,
                   const Eigen::Ref<const Eigen::VectorXd>& imposed_m,
                   const Eigen::Ref<const Eigen::VectorXd>& measured_m,
                   const Eigen::Ref<const Eigen::VectorXd>& force_n, MeasurementFlags flags) noexcept;

  /// @param answer   filled in where there is one: step, iteration, model time, displacements, force and flags.
  [[nodiscard]] Recall recall(const CommandPoint& point, std::uint16_t iteration,
                              ForceMeasurement& answer) const noexcept;
  /// The first of the points behind the newest one, up to the step `last`, with another displacement than the one that
  /// ended its step; nullptr when there is none.
  [[nodiscard]] const CommandPoint* first_other(const DisplacementCommand& command, Step last) const noexcept;
  /// Of the command that ended the step of the point, whatever its iteration. Forgotten counts as the same.
  [[nodiscard]] bool agrees_with(const CommandPoint& point) const noexcept;
  /// Displacement kept for the step of the point, and that of the point, where they differ first [m].
  [[nodiscard]] std::array<double, 2> difference(const CommandPoint& point) const noexcept;
  /// kNoStep when it is empty.
  [[nodiscard]] Step oldest_step() const noexcept;

 private:
  struct Entry {
    Step step = kNoStep;
    std::uint16_t iteration = 0;
    bool is_answered = false;
    MeasurementFlags flags = MeasurementFlags::none;
    double model_time_s = 0.0;
  };
  /// The newest entry of the step that fits, or a negative number.
  template <class Fits>
  [[nodiscard]] Eigen::Index find(Step step, Fits fits) const noexcept;
  [[nodiscard]] bool has_same_bits(Eigen::Index at, const CommandPoint& point) const noexcept;

  std::vector<Entry> entries_;
  std::size_t next_ = 0;
  std::size_t count_ = 0;
  // One column per entry:
  Eigen::MatrixXd commanded_m_;
  Eigen::MatrixXd imposed_m_;
  Eigen::MatrixXd measured_m_;
  Eigen::MatrixXd force_n_;
};

}  // namespace hybridtest
