#include "coordinator/preflight/free_vibration.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/random.hpp"

namespace hybridtest {
namespace {

constexpr int kSpanSteps = 5000;
constexpr int kSpans = 4;
/// Of the peak of a span over that of the one before: beats of a vibration that does not grow stay well below.
constexpr double kGrowth = 1.5;

using Peaks = std::array<double, 3>;

/// The acceleration shows growth of a fast mode that hardly moves.
void raise(Peaks& peaks, const MotionState& motion) {
  peaks[0] = std::max(peaks[0], motion.displacement_m.cwiseAbs().maxCoeff());
  peaks[1] = std::max(peaks[1], motion.velocity_m_per_s.cwiseAbs().maxCoeff());
  peaks[2] = std::max(peaks[2], motion.acceleration_m_per_s2.cwiseAbs().maxCoeff());
}

/// The commands of the last steps.
class CommandHistory {
 public:
  CommandHistory(Eigen::Index size, const std::vector<DelayedForce>& delayed) {
    double longest = 0.0;
    for (const DelayedForce& force : delayed) longest = std::max(longest, force.delay_steps);
    commands_.assign(static_cast<std::size_t>(longest) + 2, Eigen::VectorXd::Zero(size));
  }

  void push(const Eigen::VectorXd& command) {
    newest_ = (newest_ + 1) % commands_.size();
    commands_[newest_] = command;
  }
  [[nodiscard]] Eigen::VectorXd late(double delay_steps) const {
    const auto whole = static_cast<std::size_t>(std::max(0.0, std::floor(delay_steps)));
    const double part = delay_steps - static_cast<double>(whole);
    return (1.0 - part) * ago(whole) + part * ago(whole + 1);
  }

 private:
  [[nodiscard]] const Eigen::VectorXd& ago(std::size_t steps) const {
    return commands_[(newest_ + commands_.size() - steps) % commands_.size()];
  }

  std::vector<Eigen::VectorXd> commands_;
  std::size_t newest_ = 0;
};

}  // namespace

bool free_vibration_grows(Integrator& integrator, const Eigen::SparseMatrix<double>& stiffness_n_per_m,
                          const std::vector<DelayedForce>& delayed) {
  Random random{1};
  Eigen::VectorXd applied_n{stiffness_n_per_m.rows()};
  for (double& force_n : applied_n) force_n = random.uniform(0.5, 1.0) * (random.uniform(0.0, 1.0) < 0.5 ? -1.0 : 1.0);
  Eigen::VectorXd restoring_n{applied_n.size()};
  CommandHistory history{applied_n.size(), delayed};
  // Trials are no history; there are none where forces are late, since a specimen cannot be tried.
  const auto force_n = [&](const MotionState& command) -> const Eigen::VectorXd& {
    history.push(command.displacement_m);
    restoring_n = stiffness_n_per_m * command.displacement_m;
    for (const DelayedForce& force : delayed) restoring_n += force.stiffness_n_per_m * history.late(force.delay_steps);
    return restoring_n;
  };
  Peaks before{};
  Peaks now{};
  for (int span = 0; span < kSpans; ++span) {
    before = now;
    now = {};
    for (int step = 0; step < kSpanSteps; ++step) {
      complete_step(integrator, force_n, applied_n);
      applied_n.setZero();
      raise(now, integrator.completed());
    }
    if (!std::ranges::all_of(now, [](double peak) { return std::isfinite(peak); })) return true;
  }
  for (std::size_t i = 0; i < now.size(); ++i) {
    if (now[i] > kGrowth * before[i]) return true;
  }
  return false;
}

}  // namespace hybridtest
