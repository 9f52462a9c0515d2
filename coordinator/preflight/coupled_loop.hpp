#pragma once

#include <Eigen/Core>
#include <complex>
#include <map>
#include <vector>

#include "coordinator/preflight/structure_response.hpp"

namespace hybridtest {

/// A site as a discrete linear system: the forces that answer one command of size 1.
struct SiteAnswer {
  int periods_per_step = 1;
  /// One row for each control period after the step before that command; the command is due in row
  /// `periods_per_step` - 1. Column (channel * p + l) * p + k: force at interface degree of freedom k [N] for
  /// displacement [m], velocity [m/s] or acceleration [m/s2] at l.
  Eigen::MatrixXd force_n;
  Eigen::MatrixXd stiffness_n_per_m;  // p x p, that the initial stiffness of the structure holds for the site

  [[nodiscard]] Eigen::Index size() const noexcept { return stiffness_n_per_m.rows(); }
};

/// A motion that neither grows nor fades.
struct CriticalDelay {
  double delay_s = 0.0;              // infinite: stable with any delay
  double frequency_rad_per_s = 0.0;  // of that motion; 0 where there is none
};

/// The coupled test as a discrete linear system: integrator, trajectories, compensators, transfer systems and linear
/// specimens, each site with a further delay of its measurements.
///
/// With G(z) from the forces beyond K_I u to the commands and S(z) from the commands to the forces, the motion of the
/// test has the eigenvalues z with D(z) = det[I - (S(z) - K_I) G(z)] = 0, besides the poles of G. Those that grow are
/// counted by the argument principle along |z| = 1 + kGrowthPerStep (Nyquist; Astrom and Murray, Feedback Systems,
/// 2008, section 9.2): so many taps as S may have, D has the size of the interfaces. The frequencies are closest around
/// the poles and are halved until D turns by less than kTurn from one to the next.
class CoupledLoop {
 public:
  /// Growth below it does not count: after 30 000 steps the motion would be larger by less than 0.3 %.
  static constexpr double kGrowthPerStep = 1e-7;

  /// @param answers   of the sites, as their interfaces are stacked in `structure`.
  CoupledLoop(StructureResponse structure, std::vector<SiteAnswer> answers);

  /// Other answers of the same sites.
  void set_answers(std::vector<SiteAnswer> answers);

  /// @param delay_s   in model time, one per site; not negative, in addition to what the answers hold.
  [[nodiscard]] int growing_motions(const std::vector<double>& delay_s);

  /// The smallest delay of some sites, the same for each, from which on a motion grows. Searched upwards in small
  /// shares; 0 where a motion grows without.
  /// @param late          one per site.
  /// @param delay_s_max   how far to look.
  [[nodiscard]] CriticalDelay critical_delay(const std::vector<bool>& late, double delay_s_max);

  /// Standard deviation of the commanded displacement at the stacked interface degrees of freedom for forces of a
  /// standard deviation of 1 N at one of them, independent from step to step.
  [[nodiscard]] Eigen::VectorXd noise_m_per_n(Eigen::Index interface);

 private:
  /// At one frequency.
  struct Sample {
    Eigen::MatrixXcd structure;
    /// By site and by control period within a step: S of `n` classes of steps, p x 3p each, side by side.
    std::vector<std::vector<Eigen::MatrixXcd>> sites;
  };

  [[nodiscard]] std::vector<std::vector<Eigen::MatrixXcd>> empty_answers() const;
  [[nodiscard]] std::complex<double> root(double angle) const noexcept;
  Sample& sample(double angle);
  [[nodiscard]] Eigen::MatrixXcd phases(const SiteAnswer& answer, std::complex<double> z, int period) const;
  void add_answer(std::size_t site, double delay_s, double angle, Sample& at, Eigen::Index row,
                  Eigen::MatrixXcd& forces) const;
  [[nodiscard]] Eigen::MatrixXcd loop_matrix(const std::vector<double>& delay_s, double angle, Sample& at);
  [[nodiscard]] std::complex<double> determinant(const std::vector<double>& delay_s, double angle, Sample& at);

  StructureResponse structure_;
  std::vector<SiteAnswer> answers_;
  int poles_outside_ = 0;
  std::map<double, Sample> samples_;  // by angle per step of the method
};

}  // namespace hybridtest
