#include "diagnosis/runs/prediction_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

namespace hybridtest {

std::string prediction_csv(const report::DiagnosisReport& report) {
  std::string text = "interface,dof,unit,time_s,measured,modelled,completed,recording\n";
  for (const report::InterfaceSeries& series : report.series) {
    const std::size_t samples = std::min(series.measured.size(), series.model.size());
    for (std::size_t i = 0; i < samples; ++i) {
      text +=
          fmt::format("{},{},{},{:.9g},{:.9g},{:.9g},{},{}\n", series.interface, series.dof + 1, series.unit,
                      static_cast<double>(i) * series.sample_period_s, series.measured[i], series.model[i],
                      i < series.augmented.size() ? fmt::format("{:.9g}", series.augmented[i]) : "", series.recording);
    }
  }
  return text;
}

}  // namespace hybridtest
