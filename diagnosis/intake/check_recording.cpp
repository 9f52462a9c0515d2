#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "diagnosis/intake/column_header.hpp"
#include "diagnosis/intake/intake.hpp"
#include "diagnosis/intake/sampling.hpp"
#include "diagnosis/intake/units.hpp"

namespace hybridtest {
namespace {

void check_finite(const RawRecording& raw, const std::string& name, const std::vector<double>& values,
                  FindingList& findings) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) {
      findings.add(raw.first_row + i, name, fmt::format("{}", values[i]), "no finite number");
    }
  }
}

std::size_t dof_count(const RawRecording& raw) {
  std::size_t count = 0;
  for (const RawColumn& column : raw.columns) count = std::max(count, column.dof + 1);
  return count;
}

void check_columns(const RawRecording& raw, FindingList& findings) {
  if (raw.columns.empty()) findings.add(0, {}, {}, "no channel: a recording has at least one column besides time_s");
  for (std::size_t dof = 0; dof < dof_count(raw); ++dof) {
    if (std::ranges::count(raw.columns, dof, &RawColumn::dof) > 0) continue;
    findings.add(0, {}, {},
                 fmt::format("columns of degree of freedom {} are missing; they are counted from 1", dof + 1));
  }
}

Recording taken(RawRecording raw, double period_s) {
  Recording recording;
  recording.file = raw.file;
  recording.sample_period_s = period_s;
  recording.samples = raw.time_s.size();
  recording.first_row = raw.first_row;
  recording.dofs.resize(dof_count(raw));
  for (RawColumn& column : raw.columns) recording.dofs[column.dof].of(column.channel) = std::move(column.values);
  return recording;
}

}  // namespace

Intake check_recording(RawRecording raw) {
  FindingList findings;
  check_columns(raw, findings);
  check_finite(raw, std::string{kTimeColumn}, raw.time_s, findings);
  for (const RawColumn& column : raw.columns) check_finite(raw, column.name, column.values, findings);
  if (raw.time_s.size() < kLeastSamples) {
    findings.add(0, {}, {}, fmt::format("{} rows of data; at least {} are needed", raw.time_s.size(), kLeastSamples));
  }
  double period_s = 0.0;
  // What follows looks at differences and extremes.
  if (findings.empty()) period_s = check_sampling(raw, findings);
  if (period_s > 0.0) check_units(raw, period_s, findings);
  if (!findings.empty()) return {{}, findings.sorted()};
  return {taken(std::move(raw), period_s), {}};
}

}  // namespace hybridtest
