#include "diagnosis/verdict/held_out_loss.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "diagnosis/verdict/library_fits.hpp"

namespace hybridtest {
namespace {

/// Variance of a sum over blocks: each times its slope, with the rival less with the chosen fit.
double variance_of_sum(const std::vector<double>& with_rival, double slope_of_rival,
                       const std::vector<double>& with_chosen, double slope_of_chosen) {
  const auto blocks = static_cast<double>(with_chosen.size());
  double sum = 0.0;
  double squares = 0.0;
  for (std::size_t block = 0; block < with_chosen.size(); ++block) {
    const double difference = slope_of_rival * with_rival[block] - slope_of_chosen * with_chosen[block];
    sum += difference;
    squares += difference * difference;
  }
  return blocks / (blocks - 1.0) * std::max(0.0, squares - sum * sum / blocks);
}

}  // namespace

Loss loss_by(const IdentificationProblem& problem, const FitOutcome& rival, const FitOutcome& chosen) {
  double variance = 0.0;
  double of_squares = 0.0;
  for (std::size_t i = 0; i < problem.segments.size(); ++i) {
    const FitSegment& fit = problem.segments[i];
    const std::vector<double>& with_rival = rival.segments[i].held_out_squares;
    const std::vector<double>& with_chosen = chosen.segments[i].held_out_squares;
    if (with_rival.size() != with_chosen.size() || with_chosen.size() < 2) continue;
    const double half = 0.5 * fit.predicted_samples() / static_cast<double>(fit.measured.size());
    const double allowed = 1.0 / (fit.weight * fit.weight);
    const double of_rival = half / (rival.segments[i].held_out_mean_square(fit) + allowed);
    const double of_chosen = half / (chosen.segments[i].held_out_mean_square(fit) + allowed);
    variance += variance_of_sum(with_rival, of_rival, with_chosen, of_chosen);
    of_squares += variance_of_sum(with_rival, of_chosen, with_chosen, of_chosen);
  }
  return {.nats = held_out_score(problem, chosen) - held_out_score(problem, rival),
          .standard_error = std::sqrt(variance),
          .standard_error_of_squares = std::sqrt(of_squares)};
}

}  // namespace hybridtest
