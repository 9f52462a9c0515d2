#include "tests/support/critical_delay.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "core/assert.hpp"
#include "tests/support/loop_transfer.hpp"

namespace hybridtest {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// The sweep: points evenly spaced on a logarithmic scale, besides those around each pole.
constexpr int kSweepPoints = 1500;
/// Phases below zero by no more than this are zero up to rounding.
constexpr double kPhaseRounding = 1e-9;
/// Growth rates below this share of the fastest pole are zero up to rounding: a double pole at zero
/// is only accurate to the square root of machine precision.
constexpr double kGrowthRounding = 1e-7;

Eigen::MatrixXd given_or_zero(const Eigen::MatrixXd& given, Eigen::Index size) {
  return given.size() == 0 ? Eigen::MatrixXd{Eigen::MatrixXd::Zero(size, size)} : given;
}

DenseSystem specimen(const CoupledSite& site) {
  const Eigen::Index size = site.interface.size();
  return {.mass_kg = given_or_zero(site.mass_kg, size),
          .damping_n_s_per_m = given_or_zero(site.damping_n_s_per_m, size),
          .stiffness_n_per_m = site.stiffness_n_per_m};
}

void add(DenseSystem& system, const CoupledSite& site, bool with_stiffness) {
  const DenseSystem part = specimen(site);
  const Eigen::MatrixXd to_structure = site.interface.matrix().transpose();
  system.mass_kg += to_structure * part.mass_kg * to_structure.transpose();
  system.damping_n_s_per_m += to_structure * part.damping_n_s_per_m * to_structure.transpose();
  if (with_stiffness) system.stiffness_n_per_m += to_structure * part.stiffness_n_per_m * to_structure.transpose();
}

/// The structure without the delayed site. The stiffness of the other sites is already in the structure.
DenseSystem without_late_site(const LinearStructure& structure, const std::vector<CoupledSite>& sites,
                              std::size_t late) {
  DenseSystem rest{.mass_kg = Eigen::MatrixXd{structure.mass_kg},
                   .damping_n_s_per_m = Eigen::MatrixXd{structure.damping_n_s_per_m},
                   .stiffness_n_per_m = Eigen::MatrixXd{structure.initial_stiffness_n_per_m}};
  for (std::size_t i = 0; i < sites.size(); ++i) {
    if (i != late) add(rest, sites[i], false);
  }
  const CoupledSite& site = sites[late];
  const Eigen::MatrixXd to_structure = site.interface.matrix().transpose();
  rest.stiffness_n_per_m -= to_structure * site.stiffness_n_per_m * to_structure.transpose();
  return rest;
}

/// Finds the frequencies at which an eigenvalue of the loop transfer has the modulus 1.
class CrossingSearch {
 public:
  CrossingSearch(const LoopTransfer& transfer, std::vector<double> frequencies)
      : transfer_{transfer}, frequencies_{std::move(frequencies)} {
    samples_.reserve(frequencies_.size());
    for (const double frequency : frequencies_) samples_.push_back(levels(frequency));
  }

  /// The crossing with the smallest delay.
  [[nodiscard]] CriticalDelay earliest() {
    for (Eigen::Index branch = 0; branch < samples_.front().size(); ++branch) {
      for (std::size_t i = 0; i + 1 < samples_.size(); ++i) {
        examine(branch, i);
        if (i > 0) examine_extreme(branch, i);
      }
    }
    return earliest_;
  }

 private:
  /// Logarithms of the moduli, largest first: zero at a crossing.
  [[nodiscard]] Eigen::VectorXd levels(double frequency) const {
    return transfer_.eigenvalues(frequency).array().abs().max(1e-300).log();
  }
  [[nodiscard]] double level(Eigen::Index branch, double frequency) const { return levels(frequency)[branch]; }

  void examine(Eigen::Index branch, std::size_t i) {
    if ((samples_[i][branch] > 0.0) == (samples_[i + 1][branch] > 0.0)) return;
    bisect(branch, frequencies_[i], frequencies_[i + 1]);
  }

  /// A peak below 1, or a minimum above 1, can cross 1 between two samples.
  void examine_extreme(Eigen::Index branch, std::size_t i) {
    const double here = samples_[i][branch];
    const double sign = here > 0.0 ? -1.0 : 1.0;
    const double before = samples_[i - 1][branch];
    const double after = samples_[i + 1][branch];
    if (sign * before > 0.0 || sign * after > 0.0 || sign * here < sign * before || sign * here < sign * after) return;
    double low = frequencies_[i - 1];
    double high = frequencies_[i + 1];
    constexpr double kGolden = std::numbers::phi - 1.0;
    for (int iteration = 0; iteration < 80 && high - low > 1e-14 * high; ++iteration) {
      const double left = high - kGolden * (high - low);
      const double right = low + kGolden * (high - low);
      const double level_left = sign * level(branch, left);
      const double level_right = sign * level(branch, right);
      if (level_left > 0.0 || level_right > 0.0) {
        const double beyond = level_left > 0.0 ? left : right;
        bisect(branch, frequencies_[i - 1], beyond);
        bisect(branch, beyond, frequencies_[i + 1]);
        return;
      }
      if (level_left > level_right) {
        high = right;
      } else {
        low = left;
      }
    }
  }

  void bisect(Eigen::Index branch, double low, double high) {
    const bool is_above_at_low = level(branch, low) > 0.0;
    for (int iteration = 0; iteration < 200; ++iteration) {
      const double middle = 0.5 * (low + high);
      if (middle <= low || middle >= high) break;
      if ((level(branch, middle) > 0.0) == is_above_at_low) {
        low = middle;
      } else {
        high = middle;
      }
    }
    enter(transfer_.eigenvalues(low)[branch], low);
  }

  void enter(std::complex<double> eigenvalue, double frequency) {
    double phase = std::arg(-eigenvalue);
    if (phase < -kPhaseRounding) phase += 2.0 * std::numbers::pi;
    const double delay_s = std::max(phase, 0.0) / frequency;
    if (delay_s < earliest_.delay_s) earliest_ = {.delay_s = delay_s, .frequency_rad_per_s = frequency};
  }

  const LoopTransfer& transfer_;
  std::vector<double> frequencies_;
  std::vector<Eigen::VectorXd> samples_;
  CriticalDelay earliest_{.delay_s = kInfinity, .frequency_rad_per_s = 0.0};
};

/// Above this frequency there is no crossing: it is above every pole, and the loop gain is below 1.
double highest_frequency(const LoopTransfer& transfer, double fastest_pole) {
  double frequency = 10.0 * fastest_pole;
  while (std::abs(transfer.eigenvalues(frequency)[0]) >= 1.0) frequency *= 2.0;
  return frequency;
}

std::vector<double> sweep(const LoopTransfer& transfer, const Eigen::VectorXcd& coupled_poles) {
  double slowest = kInfinity;
  double fastest = 0.0;
  for (const auto& pole : coupled_poles) fastest = std::max(fastest, std::abs(pole));
  for (const auto& pole : transfer.structure_poles_rad_per_s()) fastest = std::max(fastest, std::abs(pole));
  for (const auto& pole : coupled_poles) {
    if (std::abs(pole) > 1e-6 * fastest) slowest = std::min(slowest, std::abs(pole));
  }
  const double low = 1e-3 * slowest;
  const double high = highest_frequency(transfer, fastest);
  std::vector<double> frequencies;
  for (int i = 0; i <= kSweepPoints; ++i) {
    frequencies.push_back(low * std::pow(high / low, static_cast<double>(i) / kSweepPoints));
  }
  // A resonance is as narrow as its damping is small; the even points alone would miss it.
  for (const auto& pole : transfer.structure_poles_rad_per_s()) {
    const double width = std::max(std::abs(pole.real()), 1e-6 * std::abs(pole.imag()));
    for (const double offset : {-10.0, -3.0, -1.0, -0.3, 0.0, 0.3, 1.0, 3.0, 10.0}) {
      const double frequency = pole.imag() + offset * width;
      if (frequency > low && frequency < high) frequencies.push_back(frequency);
    }
  }
  std::sort(frequencies.begin(), frequencies.end());
  return frequencies;
}

std::optional<CriticalDelay> unstable_without_delay(const Eigen::VectorXcd& coupled_poles) {
  const double fastest = coupled_poles.cwiseAbs().maxCoeff();
  for (const auto& pole : coupled_poles) {
    if (pole.real() > kGrowthRounding * fastest) {
      return CriticalDelay{.delay_s = 0.0, .frequency_rad_per_s = std::abs(pole.imag())};
    }
  }
  return std::nullopt;
}

}  // namespace

CriticalDelay critical_delay(const LinearStructure& structure, const std::vector<CoupledSite>& sites,
                             std::size_t late) {
  HYBRIDTEST_ASSERT(late < sites.size());
  require_consistent(structure);
  for (const CoupledSite& site : sites) require_consistent(structure, site);
  const DenseSystem rest = without_late_site(structure, sites, late);
  DenseSystem coupled = rest;
  add(coupled, sites[late], true);
  const Eigen::VectorXcd coupled_poles = poles_rad_per_s(coupled);
  if (const auto unstable = unstable_without_delay(coupled_poles)) return *unstable;
  // No mode has stiffness or damping: there is no feedback.
  if (coupled_poles.cwiseAbs().maxCoeff() <= 0.0) return {.delay_s = kInfinity, .frequency_rad_per_s = 0.0};

  const LoopTransfer transfer{rest, specimen(sites[late]), sites[late].interface};
  // If the delayed inertia of the specimen is larger than that of the structure, the test is unstable
  // at any delay (a neutral equation with an unstable difference operator).
  if (transfer.modulus_at_infinity_max() >= 1.0) return {.delay_s = 0.0, .frequency_rad_per_s = kInfinity};
  return CrossingSearch{transfer, sweep(transfer, coupled_poles)}.earliest();
}

}  // namespace hybridtest
