#include "coordinator/preflight/integrator_response.hpp"

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <vector>

namespace hybridtest {
namespace {

/// From one command to the next.
struct Stage {
  Eigen::MatrixXd transition;  // with the force K_I u
  Eigen::MatrixXd input;       // of a force beyond it
  Eigen::MatrixXd output;
};

/// The same structure with the step as the unit of time, so that the states have like magnitudes.
LinearStructure per_step(const LinearStructure& structure, double step_s) {
  LinearStructure scaled = structure;
  scaled.damping_n_s_per_m *= step_s;
  scaled.stiffness_n_per_m.resize(0, 0);
  scaled.initial_stiffness_n_per_m *= step_s * step_s;
  return scaled;
}

class StatesOf {
 public:
  explicit StatesOf(Integrator& integrator) {
    integrator.visit_state([&](Eigen::VectorXd& part) { parts_.push_back(&part); });
    for (const Eigen::VectorXd* part : parts_) size_ += part->size();
  }

  [[nodiscard]] Eigen::Index size() const noexcept { return size_; }
  void set_unit(Eigen::Index entry) {
    for (Eigen::VectorXd* part : parts_) {
      part->setZero();
      if (entry >= 0 && entry < part->size()) (*part)[entry] = 1.0;
      entry -= part->size();
    }
  }
  void set_zero() { set_unit(size_); }
  [[nodiscard]] Eigen::VectorXd read() const {
    Eigen::VectorXd state{size_};
    Eigen::Index at = 0;
    for (const Eigen::VectorXd* part : parts_) {
      state.segment(at, part->size()) = *part;
      at += part->size();
    }
    return state;
  }

 private:
  std::vector<Eigen::VectorXd*> parts_;
  Eigen::Index size_ = 0;
};

Eigen::VectorXd commanded(const Integrator& integrator) {
  const MotionState& motion = integrator.current();
  Eigen::VectorXd output{IntegratorResponse::kChannels * motion.displacement_m.size()};
  output << motion.displacement_m, motion.velocity_m_per_s, motion.acceleration_m_per_s2;
  return output;
}

std::vector<Stage> stages_of(Integrator& integrator, const LinearStructure& structure, int commands_per_step) {
  const Eigen::Index size = structure.size();
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(size);
  const auto known_n = [&](const MotionState& command) -> Eigen::VectorXd {
    return structure.initial_stiffness_n_per_m * command.displacement_m;
  };
  integrator.advance(none, none);  // the start, which differs from all other steps
  StatesOf states{integrator};
  const Eigen::Index count = states.size();
  std::vector<Stage> stages(static_cast<std::size_t>(commands_per_step),
                            {Eigen::MatrixXd{count, count}, Eigen::MatrixXd{count, size},
                             Eigen::MatrixXd{IntegratorResponse::kChannels * size, count}});
  for (Eigen::Index entry = 0; entry < count; ++entry) {
    for (Stage& stage : stages) {
      states.set_unit(entry);
      stage.output.col(entry) = commanded(integrator);
      complete_step(integrator, known_n, none);
      stage.transition.col(entry) = states.read();
    }
  }
  for (Eigen::Index coordinate = 0; coordinate < size; ++coordinate) {
    for (Stage& stage : stages) {
      states.set_zero();
      complete_step(
          integrator,
          [&](const MotionState& command) -> Eigen::VectorXd {
            return known_n(command) + Eigen::VectorXd::Unit(size, coordinate);
          },
          none);
      stage.input.col(coordinate) = states.read();
    }
  }
  return stages;
}

}  // namespace

IntegratorResponse::IntegratorResponse(const MakeIntegrator& make, const LinearStructure& structure, double step_s,
                                       int commands_per_step) {
  const LinearStructure scaled = per_step(structure, step_s);
  const auto integrator = make(scaled, 1.0, {});
  std::vector<Stage> stages = stages_of(*integrator, scaled, commands_per_step);
  const Eigen::Index size = structure.size();
  const Eigen::Index rows = kChannels * size;
  for (Stage& stage : stages) {
    stage.input *= step_s * step_s;
    stage.output.middleRows(size, size) /= step_s;
    stage.output.bottomRows(size) /= step_s * step_s;
  }
  const Eigen::Index count = stages.front().transition.rows();
  Eigen::MatrixXd transition = Eigen::MatrixXd::Identity(count, count);
  Eigen::MatrixXd input = Eigen::MatrixXd::Zero(count, commands_per_step * size);
  Eigen::MatrixXd output{commands_per_step * rows, count};
  direct_ = Eigen::MatrixXcd::Zero(commands_per_step * rows, commands_per_step * size);
  for (int command = 0; command < commands_per_step; ++command) {
    const Stage& stage = stages[static_cast<std::size_t>(command)];
    output.middleRows(command * rows, rows) = stage.output * transition;
    direct_.middleRows(command * rows, rows) = (stage.output * input).cast<std::complex<double>>();
    transition = (stage.transition * transition).eval();
    input = (stage.transition * input).eval();
    input.middleCols(command * size, size) = stage.input;
  }
  const Eigen::ComplexSchur<Eigen::MatrixXcd> schur{transition.cast<std::complex<double>>()};
  triangular_ = schur.matrixT();
  poles_ = triangular_.diagonal();
  input_ = schur.matrixU().adjoint() * input;
  output_ = output * schur.matrixU();
}

Eigen::MatrixXcd IntegratorResponse::at(std::complex<double> z) const {
  Eigen::MatrixXcd shifted = -triangular_;
  shifted.diagonal().array() += z;
  return output_ * shifted.triangularView<Eigen::Upper>().solve(input_) + direct_;
}

NumericalMode numerical_mode(const MakeIntegrator& make, int commands_per_step, double omega_dt) {
  LinearStructure mode;
  mode.mass_kg = Eigen::MatrixXd::Ones(1, 1).sparseView();
  mode.damping_n_s_per_m.resize(1, 1);
  mode.initial_stiffness_n_per_m = mode.mass_kg * (omega_dt * omega_dt);
  mode.influence = Eigen::VectorXd::Ones(1);
  const IntegratorResponse response{make, mode, 1.0, commands_per_step};
  // Of the roots the largest one that turns; states that only repeat another one have the root 0.
  std::complex<double> principal{0.0, 0.0};
  for (const auto& pole : response.poles()) {
    if (pole.imag() > 1e-12 && std::abs(pole) > std::abs(principal)) principal = pole;
  }
  if (principal == std::complex<double>{}) return {.period_error = std::numeric_limits<double>::quiet_NaN()};
  const double angle = std::arg(principal);
  return {.damping_ratio = -std::log(std::abs(principal)) / angle,
          .period_error = omega_dt * commands_per_step / angle - 1.0};
}

}  // namespace hybridtest
