#include "tests/fuzz/recording_fuzz.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <string_view>

#include "core/assert.hpp"
#include "diagnosis/intake/intake.hpp"
#include "diagnosis/tuning.hpp"

namespace hybridtest {
namespace {

void append(std::string& text, double value) {
  char digits[40];
  std::snprintf(digits, sizeof digits, "%.17g", value);
  text += digits;
}

std::string csv_of(const Recording& recording) {
  std::string text{recording.is_quasi_static ? "step" : "time_s"};
  const auto each_column = [&](const auto& visit) {
    for (std::size_t dof = 0; dof < recording.dofs.size(); ++dof) {
      for (std::size_t i = 0; i < kChannels; ++i) {
        const auto channel = static_cast<Channel>(i);
        if (recording.dofs[dof].has(channel)) visit(dof, channel);
      }
    }
  };
  each_column([&](std::size_t dof, Channel channel) {
    text += "," + std::string{column_name(channel)} + "_" + std::to_string(dof + 1);
  });
  for (std::size_t sample = 0; sample < recording.samples; ++sample) {
    text += "\n";
    append(text, static_cast<double>(sample) * (recording.is_quasi_static ? 1.0 : recording.sample_period_s));
    each_column([&](std::size_t dof, Channel channel) {
      text += ",";
      append(text, recording.dofs[dof].of(channel)[sample]);
    });
  }
  return text;
}

void check(const Recording& recording) {
  HYBRIDTEST_ASSERT(std::isfinite(recording.sample_period_s) && recording.sample_period_s > 0.0);
  HYBRIDTEST_ASSERT(recording.samples >= tuning::kSamplesMin && !recording.dofs.empty());
  for (const DofRecording& dof : recording.dofs) {
    for (const std::vector<double>& values : dof.samples) {
      HYBRIDTEST_ASSERT(values.empty() || values.size() == recording.samples);
      HYBRIDTEST_ASSERT(std::ranges::all_of(values, [](double value) { return std::isfinite(value); }));
    }
  }
  const Intake again = read_csv_recording(csv_of(recording), "again");
  HYBRIDTEST_ASSERT(again.recording.has_value());
  HYBRIDTEST_ASSERT(again.recording->is_quasi_static == recording.is_quasi_static);
  for (std::size_t dof = 0; dof < recording.dofs.size(); ++dof) {
    HYBRIDTEST_ASSERT(again.recording->dofs[dof].samples == recording.dofs[dof].samples);
  }
}

}  // namespace

bool fuzz_recording(const std::uint8_t* bytes, std::size_t size) {
  const Intake intake = read_csv_recording({reinterpret_cast<const char*>(bytes), size}, "fuzz");
  HYBRIDTEST_ASSERT(intake.recording.has_value() == intake.findings.empty());
  for (const IntakeFinding& finding : intake.findings) HYBRIDTEST_ASSERT(finding.text("fuzz").size() > 6);
  if (intake.recording) check(*intake.recording);
  return intake.recording.has_value();
}

}  // namespace hybridtest

#ifdef HYBRIDTEST_LIBFUZZER
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  (void)hybridtest::fuzz_recording(bytes, size);
  return 0;
}
#endif
