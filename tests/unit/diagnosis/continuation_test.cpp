#include "diagnosis/identification/continuation.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "diagnosis/diagnose.hpp"
#include "diagnosis/identification/smoothing_choice.hpp"
#include "diagnosis/intake/intake.hpp"
#include "diagnosis/replay.hpp"
#include "tests/unit/diagnosis/made_recording.hpp"

namespace hybridtest {
namespace {

using testing::HasSubstr;

constexpr std::size_t kWhole = 6000;
constexpr std::size_t kHalf = kWhole / 2;

/// A spring that loses half its stiffness over 0.5 m of path.
SiteModel degrading_model() {
  SiteModel model = made_model();
  model.effects.push_back({find_effect(EffectInterface::specimen, "stiffness_degradation"), {0.5, 0.0}});
  return model;
}

/// Rows of the test of such a specimen, from its own virgin state at the beginning. @param stamp   of a row.
std::string rows_of_test(const std::string& column, double per_row, std::size_t begin, std::size_t end) {
  static const std::vector<double> force_n = [] {
    const Recording whole = made_recording(
        made_motion_m, [](double) { return 0.0; }, 0.0);
    return replay(degrading_model(), whole, 0).back().predicted;
  }();
  std::string text = column + ",measured_displacement_m,measured_force_n\n";
  for (std::size_t i = begin; i < end; ++i) {
    const double time_s = kSitePeriod_s * static_cast<double>(i);
    text += fmt::format("{:.6f},{:.9f},{:.4f}\n", per_row * static_cast<double>(i), made_motion_m(time_s), force_n[i]);
  }
  return text;
}

Recording part(const std::string& column, double per_row, std::size_t begin, std::size_t end, const char* name) {
  Intake intake = read_csv_recording(rows_of_test(column, per_row, begin, end), name);
  EXPECT_TRUE(intake.recording.has_value()) << intake.findings.front().text(name);
  return intake.recording.value();
}

TEST(Continuation, FollowsTimeStampsOrSteps) {
  for (const auto& [column, per_row] : {std::pair{"time_s", kSitePeriod_s}, std::pair{"step", 1.0}}) {
    const Recording first = part(column, per_row, 0, kHalf, "first.csv");
    const Recording second = part(column, per_row, kHalf, kWhole, "second.csv");
    EXPECT_TRUE(continues(first, second, 0)) << column;
    EXPECT_FALSE(continues(second, first, 0)) << column;
    EXPECT_FALSE(continues(first, part(column, per_row, kHalf + 20, kWhole, "later.csv"), 0)) << column;
  }
  const Recording first = part("time_s", kSitePeriod_s, 0, kHalf, "first.csv");
  EXPECT_FALSE(continues(first, part("step", 1.0, kHalf, kWhole, "other.csv"), 0));
  Recording elsewhere = part("time_s", kSitePeriod_s, kHalf, kWhole, "second.csv");
  for (double& value : elsewhere.dofs[0].of(Channel::measured_displacement)) value += 0.01;
  EXPECT_FALSE(continues(first, elsewhere, 0)) << "the motion jumps";
}

TEST(Continuation, ReplayBeginsWithTheHistoryBefore) {
  for (const auto& [column, per_row] : {std::pair{"time_s", kSitePeriod_s}, std::pair{"step", 1.0}}) {
    const Recording first = part(column, per_row, 0, kHalf, "first.csv");
    const Recording second = part(column, per_row, kHalf, kWhole, "second.csv");
    const double with_history = replay(degrading_model(), second, 0, &first)[0].nrmse;
    const double virgin = replay(degrading_model(), second, 0)[0].nrmse;
    EXPECT_LT(with_history, 0.002) << column;
    EXPECT_GT(virgin, 0.2) << column;
  }
}

TEST(Continuation, HistoryGoesBackOverSeveralParts) {
  const std::vector<Recording> parts{part("time_s", kSitePeriod_s, 4000, kWhole, "third.csv"),
                                     part("time_s", kSitePeriod_s, 0, 2000, "first.csv"),
                                     part("time_s", kSitePeriod_s, 2000, 4000, "second.csv")};
  std::vector<Segment> segments = modelled_segments(degrading_model(), parts[0], 0, 0);
  carry_history(degrading_model(), parts, 0, segments);
  ASSERT_NE(segments[0].history, nullptr);
  ASSERT_NE(segments[0].history->history, nullptr);
  EXPECT_EQ(segments[0].history->history->recording, 1U);
  EXPECT_EQ(segments[0].history->history->history, nullptr);
  const std::vector<double> predicted = predict(degrading_model(), segments[0]);
  double worst_n = 0.0;
  for (std::size_t i = 0; i < predicted.size(); ++i) {
    worst_n = std::max(worst_n, std::abs(predicted[i] - segments[0].measured[i]));
  }
  EXPECT_LT(worst_n, 100.0) << "of 14 kN";
}

TEST(Continuation, HeldOutSecondHalfConfirmsDegradation) {
  std::vector<Recording> recordings{part("time_s", kSitePeriod_s, 0, kHalf, "first.csv"),
                                    part("time_s", kSitePeriod_s, kHalf, kWhole, "second.csv")};
  recordings[1].role = RecordingRole::held_out;
  const Diagnosis diagnosis = diagnose(made_model(), recordings, {});
  EXPECT_THAT(diagnosis.report.notes, testing::Contains(HasSubstr("second.csv continues first.csv")));
  ASSERT_TRUE(diagnosis.report.interface_shrink.has_value());
  EXPECT_GT(diagnosis.report.interface_shrink->variance_removed, 0.99);
}

}  // namespace
}  // namespace hybridtest
