#include "coordinator/preflight/coupled_loop.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <set>
#include <utility>

#include "core/assert.hpp"

namespace hybridtest {
namespace {

using Complex = std::complex<double>;

constexpr double kPi = std::numbers::pi;
/// Frequencies evenly spaced, and as many evenly spaced on a logarithmic scale below.
constexpr int kEvenly = 400;
constexpr double kLowestAngle = 1e-6;
/// D turns by half a circle within the distance of a root to the contour: twice that is not missed.
constexpr double kTurn = 0.8;  // [rad]
constexpr double kClosest = 1e-13;
/// From one delay of the search to the next. A motion that grows between two of them alone is one that hardly grows.
constexpr double kDelayRatio = 1.03;
constexpr double kFirstDelay = 1.0 / 64.0;  // of a step
constexpr double kDelayTolerance = 1e-5;

/// Where D is looked at first: around each pole as densely as the pole is close to the contour.
std::set<double> first_angles(const std::vector<Complex>& poles) {
  std::set<double> angles{0.0, kPi};
  for (int i = 1; i < kEvenly; ++i) {
    const double share = static_cast<double>(i) / kEvenly;
    angles.insert(kPi * share);
    angles.insert(kLowestAngle * std::pow(kPi / kLowestAngle, share));
  }
  for (const Complex& pole : poles) {
    if (std::abs(pole) < 0.5 || pole.imag() < 0.0) continue;
    const double angle = std::arg(pole);
    angles.insert(angle);
    double offset = 0.3 * std::max(std::abs(1.0 + CoupledLoop::kGrowthPerStep - std::abs(pole)), 1e-10);
    for (; offset < kPi / kEvenly; offset *= 2.0) {
      if (angle - offset > 0.0) angles.insert(angle - offset);
      if (angle + offset < kPi) angles.insert(angle + offset);
    }
  }
  return angles;
}

int floor_divided(int value, int divisor) { return value >= 0 ? value / divisor : -((divisor - 1 - value) / divisor); }

}  // namespace

CoupledLoop::CoupledLoop(StructureResponse structure, std::vector<SiteAnswer> answers)
    : structure_{std::move(structure)} {
  const std::vector<Complex> poles = structure_.poles();
  const double radius = std::abs(root(0.0));
  poles_outside_ =
      static_cast<int>(std::ranges::count_if(poles, [&](Complex pole) { return std::abs(pole) > radius; }));
  set_answers(std::move(answers));
  for (const double angle : first_angles(poles)) static_cast<void>(sample(angle));
}

void CoupledLoop::set_answers(std::vector<SiteAnswer> answers) {
  answers_ = std::move(answers);
  Eigen::Index size = 0;
  for (const SiteAnswer& answer : answers_) size += answer.size();
  HYBRIDTEST_ASSERT(size == structure_.interface_size());
  for (auto& [angle, at] : samples_) at.sites = empty_answers();
}

/// None computed yet.
std::vector<std::vector<Eigen::MatrixXcd>> CoupledLoop::empty_answers() const {
  std::vector<std::vector<Eigen::MatrixXcd>> empty;
  for (const SiteAnswer& answer : answers_) empty.emplace_back(static_cast<std::size_t>(answer.periods_per_step));
  return empty;
}

Complex CoupledLoop::root(double angle) const noexcept {
  return std::polar(1.0 + kGrowthPerStep * structure_.commands_per_step(), angle);
}

CoupledLoop::Sample& CoupledLoop::sample(double angle) {
  const auto [at, is_new] = samples_.try_emplace(angle);
  if (is_new) {
    at->second.structure = structure_.at(root(angle));
    at->second.sites = empty_answers();
  }
  return at->second;
}

/// Sums over the steps l of H(l n + c) z^-l for the classes c, H of the measurements `period` control periods before
/// the steps.
Eigen::MatrixXcd CoupledLoop::phases(const SiteAnswer& answer, Complex z, int period) const {
  const int classes = structure_.commands_per_step();
  const Eigen::Index width = answer.force_n.cols();
  Eigen::MatrixXcd sums = Eigen::MatrixXcd::Zero(width, classes);
  const Complex back = 1.0 / z;
  const Eigen::Index first = answer.periods_per_step - 1 - period;
  const Eigen::Index steps = (answer.force_n.rows() - 1 - first) / answer.periods_per_step + 1;
  for (Eigen::Index step = steps - 1; step >= 0; --step) {
    const auto in_class = step % classes;
    sums.col(in_class) =
        back * sums.col(in_class) + answer.force_n.row(first + step * answer.periods_per_step).transpose();
  }
  return sums;
}

/// Rows (command i, site), columns (command j, channel, site).
void CoupledLoop::add_answer(std::size_t site, double delay_s, double angle, Sample& at, Eigen::Index row,
                             Eigen::MatrixXcd& forces) const {
  const SiteAnswer& answer = answers_[site];
  const int commands = structure_.commands_per_step();
  const Eigen::Index all = structure_.interface_size();
  const Eigen::Index size = answer.size();
  const Complex z = root(angle);
  const double periods = delay_s / structure_.step_s() * answer.periods_per_step;
  const auto whole = static_cast<int>(std::floor(periods));
  // Between two control periods along a straight line, as a delay line does.
  for (const auto& [late, weight] : {std::pair{whole, 1.0 - (periods - whole)}, {whole + 1, periods - whole}}) {
    if (weight == 0.0) continue;
    const int period = late % answer.periods_per_step;
    const int steps = late / answer.periods_per_step;
    Eigen::MatrixXcd& sums = at.sites[site][static_cast<std::size_t>(period)];
    if (sums.size() == 0) sums = phases(answer, z, period);
    for (int i = 0; i < commands; ++i) {
      for (int j = 0; j < commands; ++j) {
        const int before = i - j - steps;
        const int turns = floor_divided(before, commands);
        const Complex factor = weight * std::pow(z, turns);
        const auto taps = sums.col(before - turns * commands);
        for (Eigen::Index channel = 0; channel < IntegratorResponse::kChannels; ++channel) {
          const Eigen::Map<const Eigen::MatrixXcd> part{taps.data() + channel * size * size, size, size};
          forces.block(i * all + row, (j * IntegratorResponse::kChannels + channel) * all + row, size, size) +=
              factor * part;
        }
      }
    }
  }
}

Eigen::MatrixXcd CoupledLoop::loop_matrix(const std::vector<double>& delay_s, double angle, Sample& at) {
  const int commands = structure_.commands_per_step();
  const Eigen::Index all = structure_.interface_size();
  Eigen::MatrixXcd forces = Eigen::MatrixXcd::Zero(commands * all, commands * IntegratorResponse::kChannels * all);
  Eigen::Index row = 0;
  for (std::size_t site = 0; site < answers_.size(); ++site) {
    add_answer(site, delay_s[site], angle, at, row, forces);
    const SiteAnswer& answer = answers_[site];
    for (int i = 0; i < commands; ++i) {
      forces.block(i * all + row, i * IntegratorResponse::kChannels * all + row, answer.size(), answer.size()) -=
          answer.stiffness_n_per_m;
    }
    row += answer.size();
  }
  return Eigen::MatrixXcd::Identity(commands * all, commands * all) - forces * at.structure;
}

Complex CoupledLoop::determinant(const std::vector<double>& delay_s, double angle, Sample& at) {
  const Eigen::MatrixXcd matrix = loop_matrix(delay_s, angle, at);
  return matrix.size() == 1 ? matrix(0, 0) : matrix.partialPivLu().determinant();
}

int CoupledLoop::growing_motions(const std::vector<double>& delay_s) {
  double turned = 0.0;
  auto left = samples_.begin();
  Complex from = determinant(delay_s, left->first, left->second);
  while (std::next(left) != samples_.end()) {
    const auto right = std::next(left);
    const Complex to = determinant(delay_s, right->first, right->second);
    const double turn = std::arg(to / from);
    const double middle = 0.5 * (left->first + right->first);
    if (std::abs(turn) > kTurn && right->first - left->first > kClosest) {
      static_cast<void>(sample(middle));
      continue;
    }
    turned += turn;
    from = to;
    left = right;
  }
  // The contour runs over the upper half of the circle; the lower half is its mirror image.
  return poles_outside_ - static_cast<int>(std::lround(turned / kPi));
}

CriticalDelay CoupledLoop::critical_delay(const std::vector<bool>& late, double delay_s_max) {
  const auto delays = [&](double delay_s) {
    std::vector<double> all(late.size(), 0.0);
    for (std::size_t site = 0; site < late.size(); ++site) {
      if (late[site]) all[site] = delay_s;
    }
    return all;
  };
  const auto grows = [&](double delay_s) { return growing_motions(delays(delay_s)) > 0; };
  double stable = 0.0;
  double unstable = 0.0;
  if (!grows(0.0)) {
    unstable = kFirstDelay * structure_.step_s();
    for (; !grows(unstable); unstable *= kDelayRatio) {
      stable = unstable;
      if (unstable > delay_s_max) return {.delay_s = std::numeric_limits<double>::infinity()};
    }
    while (unstable - stable > kDelayTolerance * unstable) {
      const double middle = 0.5 * (stable + unstable);
      (grows(middle) ? unstable : stable) = middle;
    }
  }
  // At the limit D is nearly zero at the frequency of the motion.
  const std::vector<double> at_limit = delays(unstable);
  const auto closest = std::ranges::min_element(
      samples_, {}, [&](auto& entry) { return std::abs(determinant(at_limit, entry.first, entry.second)); });
  return {.delay_s = unstable,
          .frequency_rad_per_s = closest->first / (structure_.commands_per_step() * structure_.step_s())};
}

Eigen::VectorXd CoupledLoop::noise_m_per_n(Eigen::Index interface) {
  const std::vector<double> no_delay(answers_.size(), 0.0);
  const int commands = structure_.commands_per_step();
  const Eigen::Index all = structure_.interface_size();
  Eigen::VectorXd variance = Eigen::VectorXd::Zero(all);
  Eigen::VectorXd before;
  double angle_before = 0.0;
  for (auto& [angle, at] : samples_) {
    // Commands are G [I - (S - K) G]^-1 times the forces.
    const Eigen::MatrixXcd closed = at.structure * loop_matrix(no_delay, angle, at).partialPivLu().inverse();
    Eigen::VectorXd density = Eigen::VectorXd::Zero(all);
    for (int i = 0; i < commands; ++i) {
      for (int j = 0; j < commands; ++j) {
        density += closed.block(i * IntegratorResponse::kChannels * all, j * all + interface, all, 1).cwiseAbs2();
      }
    }
    if (before.size() > 0) variance += (0.5 * (angle - angle_before)) * (density + before);
    before = density;
    angle_before = angle;
  }
  // Mean over the commands of a step of the method; the integral over the circle is twice that over its upper half.
  return (variance / (kPi * commands)).cwiseSqrt();
}

}  // namespace hybridtest
