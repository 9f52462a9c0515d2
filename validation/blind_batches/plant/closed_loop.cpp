#include "validation/blind_batches/plant/closed_loop.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "validation/blind_batches/plant/signal_chain.hpp"
#include "validation/blind_batches/plant/specimen.hpp"

namespace hybridtest::blind {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

/// Storey drifts of floor displacements.
Matrix drifts(Eigen::Index storeys) {
  Matrix b = Matrix::Identity(storeys, storeys);
  for (Eigen::Index i = 1; i < storeys; ++i) b(i, i - 1) = -1.0;
  return b;
}

Matrix stiffness_matrix(const History& of_storeys) {
  const Matrix b = drifts(std::ssize(of_storeys));
  const Vector k = Eigen::Map<const Vector>(of_storeys.data(), std::ssize(of_storeys));
  return b.transpose() * k.asDiagonal() * b;
}

/// Angular frequencies, ascending, masses of 1 kg.
Vector unit_frequencies(const History& of_storeys) {
  return Eigen::SelfAdjointEigenSolver<Matrix>{stiffness_matrix(of_storeys)}.eigenvalues().cwiseMax(0.0).cwiseSqrt();
}

/// By scaling, a Taylor series, and squaring.
Matrix exponential(const Matrix& a) {
  const int halvings = std::max(0, static_cast<int>(std::ceil(std::log2(a.lpNorm<1>()))) + 2);
  const Matrix small = a / std::pow(2.0, halvings);
  Matrix sum = Matrix::Identity(a.rows(), a.cols());
  Matrix term = sum;
  for (int n = 1; n <= 14; ++n) {
    term = term * small / n;
    sum += term;
  }
  for (int n = 0; n < halvings; ++n) sum = (sum * sum).eval();
  return sum;
}

/// The part of the structure that is computed.
class ComputedPart {
 public:
  ComputedPart(const ShearBuilding& building, std::size_t tested, double period_s)
      : storeys_{std::ssize(building.mass_kg)},
        mass_kg_{Eigen::Map<const Vector>(building.mass_kg.data(), storeys_)},
        state_{Vector::Zero(2 * storeys_)},
        load_{Vector::Zero(storeys_)} {
    History computed = building.stiffness_n_per_m;
    std::fill_n(computed.begin(), tested, 0.0);
    const Vector flexible = mass_kg_.cwiseInverse();
    Matrix damping = building.damping_per_stiffness_s * stiffness_matrix(building.stiffness_n_per_m);
    damping += Matrix{(building.damping_per_mass_per_s * mass_kg_).asDiagonal()};
    Matrix a = Matrix::Zero(3 * storeys_, 3 * storeys_);
    a.block(0, storeys_, storeys_, storeys_).setIdentity();
    a.block(storeys_, 0, storeys_, storeys_) = -(flexible.asDiagonal() * stiffness_matrix(computed));
    a.block(storeys_, storeys_, storeys_, storeys_) = -(flexible.asDiagonal() * damping);
    a.block(storeys_, 2 * storeys_, storeys_, storeys_) = Matrix{flexible.asDiagonal()};
    const Matrix step = exponential(a * period_s);
    free_ = step.topLeftCorner(2 * storeys_, 2 * storeys_);
    forced_ = step.topRightCorner(2 * storeys_, storeys_);
  }

  /// Drifts one sample later.
  /// @param drift_force_n     of the tested storeys, the others 0.
  /// @param ground_m_per_s2   mean until then.
  [[nodiscard]] Vector next(const Vector& drift_force_n, double ground_m_per_s2) {
    const Vector load = -drifts(storeys_).transpose() * drift_force_n;
    state_ = free_ * state_ + forced_ * (1.5 * load - 0.5 * load_ - mass_kg_ * ground_m_per_s2);
    load_ = load;
    return drifts(storeys_) * state_.head(storeys_);
  }

 private:
  Eigen::Index storeys_;
  Vector mass_kg_;
  Matrix free_;
  Matrix forced_;
  Vector state_;  // displacements and velocities of the floors
  Vector load_;   // of the sample before
};

/// One tested storey, sample by sample.
class LoopSite {
 public:
  LoopSite(const TestedStorey& storey, std::size_t samples, RandomStream& random)
      : period_s_{1.0 / (storey.site.rate_hz * static_cast<double>(kFineSteps))},
        network_{storey.site, storey.effects},
        compensator_{storey.site, storey.effects},
        actuator_{storey.site, storey.effects, period_s_},
        specimen_{storey.site, storey.effects, period_s_},
        displacement_{"displacement_sensor", storey.effects, period_s_},
        force_{"force_sensor", storey.effects, period_s_},
        motion_{period_s_},
        noise_m_{noise_of(storey.site.displacement_noise_m, samples, storey.site.rate_hz, random)},
        noise_n_{noise_of(storey.site.force_noise_n, samples, storey.site.rate_hz, random)} {}

  /// @returns the measured force of this sample.
  double exchange(double sent_m) {
    const double target_m = network_.receive(sent_m);
    const double command_m = compensator_.command(target_m);
    const std::size_t i = recording_.sent_m.size();
    const std::size_t steps = i == 0 ? 1 : kFineSteps;
    const double from_m = i == 0 ? command_m : recording_.command_m.back();
    double read_m = 0.0;
    double read_n = 0.0;
    for (std::size_t k = 1; k <= steps; ++k) {
      const double share = static_cast<double>(k) / static_cast<double>(steps);
      const MotionPoint at = motion_.next(actuator_.move(from_m + share * (command_m - from_m), load_n_));
      load_n_ = specimen_.force(at);
      read_m = displacement_.read(at, at.displacement_m);
      read_n = force_.read(at, load_n_);
    }
    recording_.sent_m.push_back(sent_m);
    recording_.target_m.push_back(target_m);
    recording_.command_m.push_back(command_m);
    recording_.measured_m.push_back(read_m + noise_m_[i]);
    recording_.measured_n.push_back(read_n + noise_n_[i]);
    return recording_.measured_n.back();
  }

  [[nodiscard]] PlantRecording take() { return std::move(recording_); }

 private:
  double period_s_;
  NetworkStage network_;
  CompensatorStage compensator_;
  ActuatorStage actuator_;
  SpecimenStage specimen_;
  SensorStage displacement_;
  SensorStage force_;
  Differentiator motion_;
  History noise_m_;
  History noise_n_;
  double load_n_ = 0.0;
  PlantRecording recording_;
};

}  // namespace

double lowest_hz_of_unit_masses(const History& stiffness_n_per_m) {
  return unit_frequencies(stiffness_n_per_m)(0) / kTwoPi;
}

ShearBuilding shear_building(const History& stiffness_n_per_m, double lowest_hz, double damping_ratio) {
  const Vector unit = unit_frequencies(stiffness_n_per_m);
  const double mass_kg = std::pow(unit(0) / (kTwoPi * lowest_hz), 2);
  const double low = unit(0) / std::sqrt(mass_kg);
  const double high = unit(unit.size() - 1) / std::sqrt(mass_kg);
  return {History(stiffness_n_per_m.size(), mass_kg), stiffness_n_per_m,
          2.0 * damping_ratio * low * high / (low + high), 2.0 * damping_ratio / (low + high)};
}

History ground_motion(double rate_hz, double duration_s, double rest_s, RandomStream& random) {
  const auto samples = static_cast<std::size_t>(duration_s * rate_hz) + 1;
  const double moving_s = duration_s - 2.0 * rest_s;
  const double soil = kTwoPi * random.uniform(1.5, 4.0);
  const double soil_damping = random.uniform(0.4, 0.8);
  const double slow = kTwoPi * random.uniform(0.1, 0.25);
  const double rise_s = random.uniform(0.08, 0.2) * moving_s;
  const double strong_s = random.uniform(0.35, 0.6) * moving_s;
  const double decay_per_s = random.uniform(2.5, 4.0) / (moving_s - strong_s);
  const bool has_pulse = random.chance(0.3);
  const double pulse_hz = random.uniform(0.5, 1.5);
  const double pulse_at_s = random.uniform(0.15, 0.4) * moving_s;
  const double h = 1.0 / rate_hz;
  double q = 0.0;  // of the soil
  double p = 0.0;
  double y = 0.0;  // of the slow filter that takes away drifts
  double z = 0.0;
  History ground(samples, 0.0);
  for (std::size_t i = 0; i < samples; ++i) {
    const double t = static_cast<double>(i) * h - rest_s;
    if (t < 0.0 || t > moving_s) continue;
    double envelope = std::min(1.0, (t / rise_s) * (t / rise_s));
    if (t > strong_s) envelope *= std::exp(-decay_per_s * (t - strong_s));
    p += h * (random.normal() / std::sqrt(h) - 2.0 * soil_damping * soil * p - soil * soil * q);
    q += h * p;
    const double raw = 2.0 * soil_damping * soil * p + soil * soil * q;
    z += h * (raw - 2.0 * slow * z - slow * slow * y);
    y += h * z;
    ground[i] = envelope * (raw - 2.0 * slow * z - slow * slow * y);
  }
  if (has_pulse) {  // a velocity pulse of a near fault (after Mavroeidis and Papageorgiou, 2003)
    const double amplitude = peak(ground);
    for (std::size_t i = 0; i < samples; ++i) {
      const double along = (static_cast<double>(i) * h - rest_s - pulse_at_s) * pulse_hz;
      const double hann = std::abs(along) < 1.0 ? 0.5 + 0.5 * std::cos(0.5 * kTwoPi * along) : 0.0;
      ground[i] += amplitude * hann * std::sin(kTwoPi * along);
    }
  }
  const double largest = peak(ground);
  const auto ramp = static_cast<std::size_t>(0.3 * rate_hz);
  const auto rest = static_cast<std::size_t>(rest_s * rate_hz);
  for (std::size_t i = 0; i < samples; ++i) {
    const std::size_t inside = std::min(i, samples - 1 - i);
    const double weight =
        inside < rest ? 0.0 : std::min(1.0, static_cast<double>(inside - rest) / static_cast<double>(ramp));
    ground[i] *= weight / largest;
  }
  return ground;
}

std::vector<PlantRecording> run_closed_loop(const ShearBuilding& building, const std::vector<TestedStorey>& tested,
                                            const History& ground_m_per_s2, RandomStream& noise) {
  const std::size_t samples = ground_m_per_s2.size();
  std::vector<LoopSite> sites;
  for (const TestedStorey& storey : tested) sites.emplace_back(storey, samples, noise);
  ComputedPart computed{building, tested.size(), 1.0 / tested.front().site.rate_hz};
  Vector drift = Vector::Zero(std::ssize(building.mass_kg));
  Vector force = drift;
  for (std::size_t i = 0; i < samples; ++i) {
    for (std::size_t s = 0; s < sites.size(); ++s) {
      force(static_cast<Eigen::Index>(s)) = sites[s].exchange(drift(static_cast<Eigen::Index>(s)));
    }
    const double ground = 0.5 * (ground_m_per_s2[i] + ground_m_per_s2[std::min(i + 1, samples - 1)]);
    drift = computed.next(force, ground);
  }
  std::vector<PlantRecording> recordings;
  for (LoopSite& site : sites) recordings.push_back(site.take());
  return recordings;
}

}  // namespace hybridtest::blind
