#include "validation/reference/response_comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "recording/error.hpp"
#include "recording/run_file_reader.hpp"
#include "runtime/run_directory.hpp"

namespace hybridtest {
namespace {

/// Of the largest step: how far the ratio of two steps may be from a whole number.
constexpr double kRounding = 1e-6;

DofComparison compare(const std::string& dof, const Eigen::VectorXd& run_m, const Eigen::VectorXd& reference_m) {
  DofComparison comparison;
  comparison.dof = dof;
  if (run_m.size() == 0) return comparison;
  comparison.peak_m = run_m.cwiseAbs().maxCoeff();
  comparison.reference_peak_m = reference_m.cwiseAbs().maxCoeff();
  const Eigen::VectorXd difference_m = run_m - reference_m;
  if (comparison.reference_peak_m > 0.0) {
    comparison.rms_relative = difference_m.norm() / reference_m.norm();
    comparison.difference_relative = difference_m.cwiseAbs().maxCoeff() / comparison.reference_peak_m;
  }
  return comparison;
}

}  // namespace

ReferenceComparison compare_run(const std::filesystem::path& run, const Scenario& scenario,
                                const ReferenceResponse& response, const std::string& name) {
  const RunFileReader coordinator{run_file(run, kCoordinatorId)};
  const std::vector<double> times_s = coordinator.column("steps", "model_time_s");
  const double run_step_s = times_s.size() > 1 ? times_s[1] - times_s[0] : response.step_s;
  const double ratio = run_step_s / response.step_s;
  const auto every = static_cast<Eigen::Index>(std::llround(ratio));
  if (every < 1 || std::abs(ratio - static_cast<double>(every)) > kRounding * ratio) {
    throw RecordingError{fmt::format("{}: its step of {:.6g} s is no multiple of the step of the reference, {:.6g} s",
                                     run.string(), run_step_s, response.step_s)};
  }
  const Eigen::Index steps =
      std::min<Eigen::Index>(std::ssize(times_s), (response.displacement_m.cols() - 1) / every + 1);
  ReferenceComparison comparison{.reference = name,
                                 .step_s = response.step_s,
                                 .until_s = steps > 0 ? times_s[static_cast<std::size_t>(steps - 1)] : 0.0,
                                 .dofs = {}};
  for (std::size_t i = 0; i < scenario.dofs.size(); ++i) {
    const std::string column = "displacement_" + scenario.dofs[i] + "_m";
    if (!coordinator.has_column("steps", column)) continue;
    const std::vector<double> recorded = coordinator.column("steps", column);
    Eigen::VectorXd reference_m(steps);
    for (Eigen::Index k = 0; k < steps; ++k) {
      reference_m[k] = response.displacement_m(static_cast<Eigen::Index>(i), k * every);
    }
    comparison.dofs.push_back(
        compare(scenario.dofs[i], Eigen::Map<const Eigen::VectorXd>{recorded.data(), steps}, reference_m));
  }
  return comparison;
}

void write_response(const Scenario& scenario, const ReferenceResponse& response, const std::filesystem::path& file) {
  std::ofstream stream{file};
  stream << "time_s";
  for (const std::string& dof : scenario.dofs) stream << ",displacement_" << dof << "_m";
  stream << '\n';
  for (Eigen::Index k = 0; k < response.displacement_m.cols(); ++k) {
    std::string row = fmt::format("{:.9g}", static_cast<double>(k) * response.step_s);
    for (const double value : response.displacement_m.col(k)) row += fmt::format(",{:.17g}", value);
    stream << row << '\n';
  }
  if (!stream.flush()) throw RecordingError{file.string() + ": cannot be written; check the folder and the disk"};
}

}  // namespace hybridtest
