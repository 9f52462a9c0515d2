#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <vector>

#include "diagnosis/identification/problem.hpp"

namespace hybridtest {

/// A parameter that a search varies between 0 and 1, spread over its range; evenly in its logarithm
/// where the range spans more than a decade of positive values.
struct SearchedParameter {
  std::size_t effect = 0;
  std::size_t parameter = 0;
  double low = 0.0;
  double high = 0.0;
  bool logarithmic = false;
  // A time in the recording: it acts in one place only, so derivatives far from it are zero.
  bool is_instant = false;
  // A time from none on: a lag or a skew may be far shorter than the range is long.
  bool is_time_from_none = false;

  [[nodiscard]] double at(double place) const noexcept;
  [[nodiscard]] double place_of(double value) const noexcept;
  [[nodiscard]] bool is_low_end(double place) const noexcept;
  [[nodiscard]] bool is_high_end(double place) const noexcept;
  /// Change of the value with the place, between places inside the range.
  [[nodiscard]] double slope_at(double place) const noexcept;
};

/// A parameter that the prediction is linear in.
struct LinearParameter {
  std::size_t effect = 0;
  std::size_t parameter = 0;
  double unit = 1.0;  // a change that is visible in the recording
  double low = 0.0;
  double high = 0.0;
  bool is_of_model = false;  // of an effect that the model has: what is left of it there
};

/// Which parameters of a list of effects are searched, which are linear and which stay as they are.
struct SearchPlan {
  std::vector<EffectSetting> neutral;  // linear parameters absent, searched ones anywhere, the others at their fallback
  std::vector<SearchedParameter> searched;
  std::vector<LinearParameter> linear;
  bool linear_ones_remove_all = false;  // without them every effect is absent
};

/// An effect at values with which it changes nothing.
[[nodiscard]] EffectSetting absent(const EffectType& effect);

/// Position of the parameter of a number of the model that is searched: of a stiffness the spring beside another one,
/// or the ratio of a law's.
[[nodiscard]] std::size_t searched_number(const IdentificationProblem& problem, const EffectType& number);

/// Which parameters of an effect are free: all, all but those that are freed last, or only those that a scenario has to
/// give; of an effect that the model has, only its size.
enum class Freedom : std::uint8_t { all, without_last, required };

/// @param freedoms   one per effect; empty: all of each.
[[nodiscard]] SearchPlan plan_search(const IdentificationProblem& problem,
                                     const std::vector<const EffectType*>& effects,
                                     const std::vector<Freedom>& freedoms = {});

/// What a parameter is that is left out: the model's own value of an effect that it has, else the fallback of the
/// library; NaN where it has to be given.
[[nodiscard]] double left_out(const IdentificationProblem& problem, const EffectType& effect, std::size_t parameter);

/// By what the specimen went through before.
[[nodiscard]] inline bool degrades(const EffectType& effect) noexcept {
  return effect.traits.family == EffectFamily::degradation;
}

/// The parameter is not searched: it is left_out().
[[nodiscard]] bool is_fixed(const IdentificationProblem& problem, const EffectType& effect,
                            const EffectParameter& parameter);

/// Residual of effects at given places of their searched parameters; linear parameters are solved.
/// Rows: the averaged samples of the touched segments, one segment behind the other, weighted.
struct Projected {
  Eigen::VectorXd residual;
  Eigen::MatrixXd columns;       // of the linear parameters, then of the nuisances
  Eigen::VectorXd coefficients;  // likewise; linear ones in their `unit`
  std::vector<bool> held;        // likewise: at the limit of the parameter
};

class VariableProjection {
 public:
  /// Of a coefficient.
  struct Bounds {
    double low = -std::numeric_limits<double>::infinity();
    double high = std::numeric_limits<double>::infinity();
  };

  VariableProjection(const IdentificationProblem& problem, SearchPlan plan, bool with_nuisance);

  /// @param places   of the searched parameters, 0 to 1.
  /// @throws ConfigError for parameters that an effect does not accept.
  [[nodiscard]] Projected solve(const Eigen::VectorXd& places) const;
  /// The weighted prediction with the linear parameters fixed.
  /// @param coefficients   as of a solution.
  [[nodiscard]] Eigen::VectorXd predicted(const Eigen::VectorXd& places, const Eigen::VectorXd& coefficients) const;
  /// What a small change of one parameter changes in it, per unit of that. Searched parameters come first, then the
  /// linear ones. @param here   predicted() there.
  [[nodiscard]] Eigen::VectorXd slope(const Eigen::VectorXd& places, const Eigen::VectorXd& coefficients,
                                      Eigen::Index parameter, const Eigen::VectorXd& here) const;
  /// The effects at a solution, in their own units.
  [[nodiscard]] std::vector<EffectSetting> settings(const Eigen::VectorXd& places,
                                                    const Eigen::VectorXd& coefficients) const;

  [[nodiscard]] const SearchPlan& plan() const noexcept { return plan_; }
  [[nodiscard]] const Workers& workers() const noexcept { return problem_.workers; }
  /// Positions in the problem of the segments that the rows stand for, and where each one's rows begin.
  [[nodiscard]] const std::vector<std::size_t>& touched() const noexcept { return touched_; }
  [[nodiscard]] Eigen::Index first_row(std::size_t touched) const noexcept { return first_rows_[touched]; }
  [[nodiscard]] Eigen::Index rows() const noexcept { return first_rows_.back(); }

 private:
  /// For effects that are not linear together, for example the gain of a load cell and friction: Gauss-Newton steps
  /// that start from the linear solution. The residual is that of the actual prediction.
  [[nodiscard]] Projected relinearised(const Eigen::VectorXd& places, Projected solution,
                                       const std::vector<Bounds>& bounds) const;
  [[nodiscard]] std::vector<EffectSetting> searched_at(const Eigen::VectorXd& places) const;
  [[nodiscard]] Eigen::VectorXd stacked(const std::vector<EffectSetting>& effects) const;

  const IdentificationProblem& problem_;
  SearchPlan plan_;
  std::vector<std::size_t> touched_;
  std::vector<Eigen::Index> first_rows_;  // one more than touched segments
  Eigen::VectorXd measured_;
  Eigen::VectorXd baseline_;
  Eigen::MatrixXd nuisance_;
  mutable LawMemories laws_;
};

/// Places of the searched parameters with the least squared residual: from the best few of several
/// starts spread evenly over the range (Halton, 1960), by Ceres' trust region between 0 and 1.
/// @param first   first point of the search; empty: none.
/// @param starts  number of spread starts in addition.
[[nodiscard]] Eigen::VectorXd search_best(const VariableProjection& projection, const Eigen::VectorXd& first,
                                          int starts);

/// Likewise from points a quarter of the way from one that was found to such starts; that one where none ends lower. A
/// search of many parameters may end in a side valley.
[[nodiscard]] Eigen::VectorXd search_around(const VariableProjection& projection, const Eigen::VectorXd& found);

/// Starts that fill a range of so many parameters; none for none.
[[nodiscard]] int starts_for(Eigen::Index searched) noexcept;

}  // namespace hybridtest
