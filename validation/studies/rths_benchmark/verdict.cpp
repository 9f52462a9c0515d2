#include "validation/studies/rths_benchmark/verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "validation/studies/rths_benchmark/constants.hpp"

namespace hybridtest::rths {
namespace {

class Mean {
 public:
  void add(double value) noexcept {
    sum_ += value;
    ++count_;
  }
  [[nodiscard]] double value() const noexcept { return count_ == 0 ? kNotANumber : sum_ / count_; }

 private:
  double sum_ = 0.0;
  int count_ = 0;
};

CandidateMeans means_of_one(const BenchmarkInputs& inputs, const Candidate& candidate, std::span<const StudyRun> runs) {
  CandidateMeans means;
  means.name = candidate.name;
  means.standing = candidate.standing;
  means.remark = candidate.remark;
  Mean j1_ms, j2, floor, over_floor, over_own_floor, true_nominal, true_perturbed, j4, j6, j7;
  for (const StudyRun& run : runs) {
    const TestResult& result = run.result;
    ++means.runs;
    if (!run.is_excused) means.peak_force_n = std::max(means.peak_force_n, result.peak_force_n);
    if (run.is_lost()) {
      ++means.lost;
      continue;
    }
    const double reference_floor = inputs.reference(run.case_number, run.motion).noise_floor_percent;
    j1_ms.add(result.criteria.j(1));
    means.j1_ms_max = std::max(means.j1_ms_max, result.criteria.j(1));
    j2.add(result.criteria.j(2));
    floor.add(reference_floor);
    over_floor.add(result.criteria.j(2) / reference_floor);
    over_own_floor.add(result.criteria.j(2) / result.noise_floor_percent);
    (run.plant == 0 ? true_nominal : true_perturbed).add(result.true_tracking_percent);
    means.true_max = std::max(means.true_max, result.true_tracking_percent);
    j4.add(result.criteria.j(4));
    j6.add(result.criteria.j(6));
    j7.add(result.criteria.j(7));
  }
  means.j1_ms = j1_ms.value();
  means.j2 = j2.value();
  means.reference_floor = floor.value();
  means.j2_over_floor = over_floor.value();
  means.j2_over_own_floor = over_own_floor.value();
  means.true_nominal = true_nominal.value();
  means.true_perturbed = true_perturbed.value();
  means.j4 = j4.value();
  means.j6 = j6.value();
  means.j7 = j7.value();
  return means;
}

Target at_most(std::string what, double limit, double found, std::string_view unit) {
  return {std::move(what), fmt::format("at most {:g}{}", limit, unit), fmt::format("{:.3f}{}", found, unit),
          found <= limit};
}

Target smaller_than_all(std::string_view criterion, const CandidateMeans& ours, std::span<const CandidateMeans> means,
                        double CandidateMeans::*value) {
  const CandidateMeans* next = nullptr;
  for (const CandidateMeans& other : means) {
    const bool is_rival = other.standing == Standing::published || other.standing == Standing::yardstick;
    if (!is_rival || other.lost > 0 || other.runs == 0) continue;
    if (next == nullptr || other.*value < next->*value) next = &other;
  }
  Target target{fmt::format("{} smaller than every published method that loses no run", criterion), "no other", "",
                true};
  if (next == nullptr) {
    target.found = fmt::format("{:.3f} %", ours.*value);
    return target;
  }
  target.limit = fmt::format("below {:.3f} % ({})", next->*value, next->name);
  target.found = fmt::format("{:.3f} %, {:.1f} % less", ours.*value, 100.0 * (1.0 - ours.*value / next->*value));
  target.is_met = ours.*value < next->*value;
  return target;
}

}  // namespace

std::vector<CandidateMeans> means_of(const BenchmarkInputs& inputs, const std::vector<Candidate>& candidates,
                                     std::span<const StudyRun> runs) {
  std::vector<CandidateMeans> means;
  const std::size_t each = candidates.empty() ? 0 : runs.size() / candidates.size();
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    means.push_back(means_of_one(inputs, candidates[i], runs.subspan(i * each, each)));
  }
  return means;
}

std::vector<Target> judge_ours(std::span<const CandidateMeans> means) {
  const auto ours = std::ranges::find(means, kOurs, &CandidateMeans::name);
  if (ours == means.end()) return {};
  std::vector<Target> targets{
      at_most("J1, largest", 0.3, ours->j1_ms_max, " ms"),
      at_most("tracking error without sensor noise, nominal plant", 1.0, ours->true_nominal, " %"),
  };
  if (!std::isnan(ours->true_perturbed)) {
    targets.push_back(
        at_most("tracking error without sensor noise, mean over perturbed plants", 1.5, ours->true_perturbed, " %"));
  }
  targets.push_back(at_most("J2 over its floor, mean", 1.15, ours->j2_over_floor, ""));
  targets.push_back(at_most("J6, mean over all runs", 3.0, ours->j6, " %"));
  targets.push_back(at_most("J7, mean over all runs", 3.0, ours->j7, " %"));
  targets.push_back({"runs at the force limit where the reference stays below 95 % of it", "none",
                     fmt::format("{} of {}", ours->lost, ours->runs), ours->lost == 0});
  targets.push_back(smaller_than_all("J2", *ours, means, &CandidateMeans::j2));
  targets.push_back(smaller_than_all("J6", *ours, means, &CandidateMeans::j6));
  targets.push_back(smaller_than_all("J7", *ours, means, &CandidateMeans::j7));
  return targets;
}

}  // namespace hybridtest::rths
