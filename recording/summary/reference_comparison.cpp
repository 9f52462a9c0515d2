#include "recording/summary/reference_comparison.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "recording/error.hpp"

namespace hybridtest {
namespace {

using Json = nlohmann::ordered_json;

Json number(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? Json(*value) : Json(nullptr);
}

std::optional<double> number(const Json& value) {
  return value.is_number() ? std::optional{value.get<double>()} : std::nullopt;
}

ReferenceComparison comparison_of(const Json& json) {
  ReferenceComparison comparison{json.at("reference"), json.at("step_s"), json.at("until_s"), {}};
  for (const Json& dof : json.at("degrees_of_freedom")) {
    comparison.dofs.push_back({dof.at("dof"), dof.at("peak_m"), dof.at("reference_peak_m"),
                               number(dof.at("rms_relative")), number(dof.at("difference_relative"))});
  }
  return comparison;
}

}  // namespace

std::filesystem::path reference_folder(const std::filesystem::path& run) { return run / "reference"; }

std::string text_of(const ReferenceComparison& comparison) {
  Json dofs = Json::array();
  for (const DofComparison& dof : comparison.dofs) {
    dofs.push_back({{"dof", dof.dof},
                    {"peak_m", dof.peak_m},
                    {"reference_peak_m", dof.reference_peak_m},
                    {"rms_relative", number(dof.rms_relative)},
                    {"difference_relative", number(dof.difference_relative)}});
  }
  return Json{{"reference", comparison.reference},
              {"step_s", comparison.step_s},
              {"until_s", comparison.until_s},
              {"degrees_of_freedom", dofs}}
      .dump(2);
}

void write_reference_comparison(const ReferenceComparison& comparison, const std::filesystem::path& file) {
  std::ofstream stream{file};
  stream << text_of(comparison) << '\n';
  if (!stream.flush()) throw RecordingError{file.string() + ": cannot be written; check the folder and the disk"};
}

std::vector<ReferenceComparison> reference_comparisons(const std::filesystem::path& run) {
  std::vector<ReferenceComparison> comparisons;
  std::error_code absent;
  for (const auto& entry : std::filesystem::directory_iterator{reference_folder(run), absent}) {
    if (entry.path().extension() != ".json") continue;
    std::ifstream stream{entry.path()};
    try {
      comparisons.push_back(comparison_of(Json::parse(stream)));
    } catch (const nlohmann::json::exception&) {  // not one of ours
    }
  }
  std::ranges::sort(comparisons, {}, &ReferenceComparison::reference);
  return comparisons;
}

}  // namespace hybridtest
