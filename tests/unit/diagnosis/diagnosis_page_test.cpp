#include "diagnosis/page/diagnosis_page.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "diagnosis/page/wording.hpp"
#include "tests/unit/diagnosis/made_signals.hpp"

namespace hybridtest::report {
namespace {

using testing::HasSubstr;
using testing::Not;

/// Dry friction of 500 N under a linear model; 60 s at 1 kHz, the longest that is usual.
DiagnosisReport example() {
  constexpr std::size_t kSamples = 60'000;
  InterfaceSeries series;
  series.interface = "specimen";
  series.recording = "held_out.csv";
  series.is_held_out = true;
  series.sample_period_s = kMadePeriod_s;
  series.unit = "N";
  series.input_m = sampled(kSamples, [](double t) { return 0.01 * sine(0.7, t); });
  series.measured = white_noise(kSamples, 20.0, 1);
  for (std::size_t i = 0; i < kSamples; ++i) {
    const double linear_n = 2e5 * series.input_m[i];
    const double friction_n =
        500.0 * (std::cos(2.0 * std::numbers::pi * 0.7 * static_cast<double>(i) * kMadePeriod_s) > 0.0 ? 1.0 : -1.0);
    series.measured[i] += linear_n + friction_n;
    series.model.push_back(linear_n);
    series.augmented.push_back(linear_n + friction_n);
  }
  DiagnosisReport report;
  report.site = "storey <1>";
  report.model_file = "site.yaml";
  report.recordings = {{"fit.csv", std::string(64, 'a'), RecordingRole::fit, 20.0, 0.001},
                       {"held_out.csv", std::string(64, 'b'), RecordingRole::held_out, 60.0, 0.001}};
  report.verdict = Verdict::named;
  InterfaceGap specimen{.interface = "specimen"};
  specimen.is_judged = true;
  specimen.is_at_fault = true;
  specimen.share = 0.93;
  specimen.share_ci95 = {0.90, 0.95};
  specimen.nrmse = 0.21;
  specimen.floor_nrmse = 0.01;
  InterfaceGap transfer{.interface = "transfer_system"};
  transfer.why_not = "command_displacement_m was not recorded";
  report.where = {specimen, transfer};
  RankedCause friction{.interface = "specimen", .effect = "coulomb_friction", .equation = "f = F sign(v)"};
  friction.probability = 0.98;
  friction.is_cause = true;
  friction.parameters = {{"friction_force_n", "N", 512.0, Interval{498.0, 527.0}, false}};
  RankedCause stribeck{.interface = "specimen", .effect = "stribeck_friction"};
  stribeck.probability = 0.02;
  report.ranking = {friction, stribeck};
  report.interface_shrink =
      Shrink{.nrmse_before = 0.21, .nrmse_after = 0.02, .floor_nrmse = 0.01, .variance_removed = 0.99};
  report.where.front().repeatability = Repeatability{0.034, "repeated cycles"};
  report.sensors = {{.recording = "fit.csv",
                     .column = "measured_force_n",
                     .unit = "N",
                     .quantum = 3.56,
                     .repeated_share = 0.25,
                     .clipped_share = 0.04,
                     .at_rest = RestFacts{-185.0, -170.0, 0.5, 4.4},
                     .lag_s = 0.0021}};
  report.why_no_response = "the recording is a CSV";
  report.series = {series};
  return report;
}

/// Every element that is opened is closed in order; those that HTML leaves open are known. A script is no HTML.
std::string first_imbalance(const std::string& page) {
  std::string html = page;
  if (const std::size_t script = html.find("<script>"); script != std::string::npos) {
    html.erase(script, html.find("</script>") + std::string{"</script>"}.size() - script);
  }
  std::vector<std::string> open;
  for (std::size_t at = html.find('<'); at != std::string::npos; at = html.find('<', at + 1)) {
    const std::size_t end = html.find('>', at);
    if (end == std::string::npos) return "a tag without an end";
    const bool closes = html[at + 1] == '/';
    const std::size_t begin = at + (closes ? 2 : 1);
    const std::string name = html.substr(begin, html.find_first_of(" \n/>", begin) - begin);
    if (name == "!DOCTYPE" || name == "meta" || html[end - 1] == '/') continue;
    if (!closes) {
      open.push_back(name);
    } else if (open.empty() || open.back() != name) {
      return "</" + name + "> closes " + (open.empty() ? "nothing" : open.back());
    } else {
      open.pop_back();
    }
  }
  return open.empty() ? "" : "<" + open.back() + "> stays open";
}

TEST(DiagnosisPage, IsSelfContainedAndSmall) {
  const std::string page = diagnosis_page(example());
  EXPECT_LT(page.size(), 2'000'000U);
  for (const char* outside : {"<script ", "<link", "<img", " src=", " href=", "@import", "url(http", "javascript:"}) {
    EXPECT_THAT(page, Not(HasSubstr(outside)));
  }
  EXPECT_EQ(first_imbalance(page), "");
  EXPECT_EQ(first_imbalance("<p><b></p>"), "</p> closes b") << "control";
}

TEST(DiagnosisPage, ShowsResponseWithFloorAndIntervals) {
  DiagnosisReport report = example();
  ResponseShrink response{.recording = "run", .nrmse_before = 0.08, .nrmse_after = 0.004};
  report.response_shrink = response;
  EXPECT_THAT(diagnosis_page(report), Not(HasSubstr("Of the response of the whole test"))) << "nothing was drawn";
  response.floor_nrmse = 0.003;
  response.variance_removed = 0.75;
  response.ci95 = {0.71, 0.78};
  response.nrmse_after_ci95 = {0.0031, 0.0052};
  response.peak_error_before = 0.06;
  response.peak_error_after = 0.012;
  response.peak_error_after_ci95 = {0.005, 0.021};
  response.explainable_fraction = 0.82;
  response.unknown_share = 0.16;
  response.peaks = {{.of = "floor <1>", .recorded = 0.0511, .predicted = 0.0512, .ci95 = {0.0508, 0.0515}}};
  response.energy_taken = PredictedNumber{.of = {}, .recorded = 1300.0, .predicted = 1230.0, .ci95 = {1210.0, 1260.0}};
  report.response_shrink = response;
  const std::string page = diagnosis_page(report);
  EXPECT_THAT(page,
              HasSubstr("<b>75 %</b> removed (95 % in a repetition of the test: 71 % to 78 %), "
                        "82 % of what a perfect model could remove; 16 % is not explained and above the noise floor, "
                        "NRMSE 0.30 %"));
  EXPECT_THAT(page, HasSubstr("<td>0.40 % (95 %: 0.31 % to 0.52 %)</td>"));
  EXPECT_THAT(page, HasSubstr("<td>1.2 % (95 %: 0.50 % to 2.1 %)</td>"));
  EXPECT_THAT(page, HasSubstr("<th>peak of floor &lt;1&gt;</th><td>51.1 mm</td><td>51.2 mm</td>"
                              "<td>50.8 mm to 51.5 mm</td><td></td>"));
  EXPECT_THAT(page, HasSubstr("1.21 kJ to 1.26 kJ</td><td class=\"warn\">the recorded one lies outside"));
  EXPECT_EQ(first_imbalance(page), "");
}

TEST(DiagnosisPage, NumbersSlightlyOffAreNotTheNoise) {
  DiagnosisReport report = example();
  report.where.front().is_at_fault = false;
  EXPECT_THAT(diagnosis_page(report), HasSubstr("within its noise floor"));
  report.where.front().is_corrected = true;
  EXPECT_THAT(diagnosis_page(report), HasSubstr("numbers slightly off"));
  EXPECT_THAT(diagnosis_page(report), Not(HasSubstr("within its noise floor")));
}

TEST(DiagnosisPage, RowNamesTheLawAndClaimsNoCertainty) {
  DiagnosisReport report = example();
  report.ranking.front().effect = "hysteresis_law";
  report.ranking.front().law = "bouc_wen";
  report.ranking.front().probability = 1.0;
  EXPECT_THAT(diagnosis_page(report), HasSubstr("<b>hysteresis law: bouc wen</b>"));
  EXPECT_THAT(diagnosis_page(report), HasSubstr("over 99.9"));
  EXPECT_THAT(diagnosis_page(report), Not(HasSubstr("100.00")));
}

TEST(DiagnosisPage, ShowsInterfaceEffectAndShrink) {
  const std::string page = diagnosis_page(example());
  EXPECT_THAT(page,
              HasSubstr("The gap is at the specimen (93.0\u00a0% of the whole gap); its cause is coulomb friction"));
  EXPECT_THAT(page, HasSubstr("<li class=\"fault main\"><b>specimen</b>"));
  EXPECT_THAT(page, HasSubstr("command_displacement_m was not recorded"));
  EXPECT_THAT(page, HasSubstr("friction force <b>512\u00a0N</b> <small>(498\u00a0N to 527\u00a0N)</small>"));
  EXPECT_THAT(page, HasSubstr("<b>99.0\u00a0%</b> removed"));
  EXPECT_THAT(page, HasSubstr("stribeck friction"));
  EXPECT_THAT(page, HasSubstr(std::string(64, 'b')));
  EXPECT_THAT(page, HasSubstr("force over displacement, after"));
  EXPECT_THAT(page, HasSubstr("the recording is a CSV"));
}

TEST(DiagnosisPage, ShowsSensorFactsAndRepeatability) {
  DiagnosisReport report = example();
  const std::string page = diagnosis_page(report);
  EXPECT_THAT(page, HasSubstr("(repeated cycles)"));
  EXPECT_THAT(page, HasSubstr("<td class=\"warn\">4.0")) << "a twenty-fifth at the end of its range is marked";
  EXPECT_THAT(page, HasSubstr("-185\u00a0N at start, -170\u00a0N at end; noise 4.40\u00a0N"));
  EXPECT_THAT(page, HasSubstr("2.10\u00a0ms"));
  EXPECT_THAT(page, HasSubstr("command_displacement_m was not recorded"));
  report.sensors.front().clipped_share = 0.0;
  EXPECT_THAT(diagnosis_page(report), Not(HasSubstr("<td class=\"warn\">")));
  report.sensors.clear();
  EXPECT_THAT(diagnosis_page(report), Not(HasSubstr("Sensor checks")));
}

TEST(DiagnosisPage, NamesDateVersionAndPartOfTheScenario) {
  DiagnosisReport report = example();
  EXPECT_THAT(diagnosis_page(report), HasSubstr("<p>Model: site.yaml</p>"));
  EXPECT_THAT(diagnosis_page(report), Not(HasSubstr("made at")));
  report.made_at_utc = "2026-11-22T10:00:00Z";
  report.made_by = "0.1.0 (commit 1a2b3c4d5e6f)";
  report.model_file = "run/scenario.yaml";
  report.model_part = "the model beside the rig of storey_1";
  const std::string page = diagnosis_page(report);
  EXPECT_THAT(page, HasSubstr("made at 2026-11-22T10:00:00Z by hybridtest 0.1.0 (commit 1a2b3c4d5e6f)"));
  EXPECT_THAT(page, HasSubstr("Model: the model beside the rig of storey_1, in the scenario run/scenario.yaml"));
}

/// Red is for what is wrong. Most notes are not: "agree bit for bit".
TEST(DiagnosisPage, NotesAreNotRed) {
  const std::string page = diagnosis_page(example());
  const std::size_t rule = page.find(".note {");
  ASSERT_NE(rule, std::string::npos);
  EXPECT_THAT(page.substr(rule, page.find('}', rule) - rule), Not(HasSubstr("--bad")));
  EXPECT_THAT(page, Not(HasSubstr(".warn, .note")));
}

/// Every figure and every table is in a box that scrolls, so that a telephone shows them at their size.
TEST(DiagnosisPage, FiguresAndTablesScrollInTheirOwnBox) {
  const std::string page = diagnosis_page(example());
  std::size_t boxes = 0;
  for (const std::string what : {"<svg xmlns", "<table"}) {
    for (std::size_t at = page.find(what); at != std::string::npos; at = page.find(what, at + 1), ++boxes) {
      const std::size_t box = page.rfind("<div class=\"scroll\" ", at);
      ASSERT_NE(box, std::string::npos);
      EXPECT_LT(at - box, std::string{"<div class=\"scroll\" tabindex=\"0\">\n<svg"}.size()) << page.substr(at, 80);
    }
  }
  EXPECT_GT(boxes, 8U);
  EXPECT_THAT(page, HasSubstr(".scroll { overflow-x: auto;"));
}

TEST(DiagnosisPage, EscapesUserText) {
  const std::string page = diagnosis_page(example());
  EXPECT_THAT(page, HasSubstr("storey &lt;1&gt;"));
  EXPECT_THAT(page, Not(HasSubstr("storey <1>")));
}

TEST(DiagnosisPage, PageOfEveryVerdictIsComplete) {
  DiagnosisReport report = example();
  for (const Verdict verdict :
       {Verdict::none, Verdict::named, Verdict::set, Verdict::partial, Verdict::unknown, Verdict::not_excited}) {
    report.verdict = verdict;
    EXPECT_THAT(verdict_sentence(report), testing::EndsWith(".")) << name_of(verdict);
    EXPECT_EQ(first_imbalance(diagnosis_page(report)), "") << name_of(verdict);
  }
  EXPECT_EQ(first_imbalance(diagnosis_page({})), "") << "of nothing";
}

TEST(DiagnosisPage, GapIsSaidToRepeatOnlyWhereItWasSeenTo) {
  DiagnosisReport report = example();
  const auto says = [&](Verdict verdict, std::optional<Recurrence> recurrence) {
    report.verdict = verdict;
    report.where.front().recurrence = recurrence;
    return verdict_sentence(report);
  };
  for (const Verdict verdict : {Verdict::unknown, Verdict::partial}) {
    report.where.front().repeatability = Repeatability{0.034, "repeated cycles"};
    EXPECT_THAT(says(verdict, Recurrence{.removed_by_function = 0.831, .follows_motion = true}),
                HasSubstr("It repeats with the motion: a function of the motion without a name removes 83 % of its "
                          "energy from cycles to which it was not fitted."));
    EXPECT_THAT(says(verdict, Recurrence{.repetitions_agree = true}),
                HasSubstr("It repeats: repetitions of the test differ by 3.4 % of the output."));
    EXPECT_THAT(says(verdict, Recurrence{.removed_by_function = 0.02}),
                HasSubstr("It was not seen to repeat: repetitions of the test differ by 3.4 % of the output."));
    report.where.front().repeatability.reset();
    EXPECT_THAT(says(verdict, Recurrence{}),
                HasSubstr("It was not seen to repeat: no function of the motion predicts it in cycles"));
    EXPECT_THAT(says(verdict, {}), Not(HasSubstr("repeat"))) << "nobody has looked";
  }
  EXPECT_THAT(diagnosis_page(report), Not(HasSubstr("repeatable")));
}

TEST(DiagnosisPage, SaysWhatWasAddedToTheModel) {
  DiagnosisReport report = example();
  EXPECT_THAT(diagnosis_page(report), HasSubstr("removed by the causes</span>"));
  RankedCause correction;
  correction.effect = "stiffness_error";
  report.corrections = {correction};
  EXPECT_THAT(diagnosis_page(report), HasSubstr("removed by the causes and corrected numbers</span>"));
  report.verdict = Verdict::unknown;
  EXPECT_THAT(diagnosis_page(report), testing::AllOf(HasSubstr("Gap before and after adding the corrected numbers<"),
                                                     HasSubstr("removed by the corrected numbers</span>")));
}

TEST(DiagnosisPage, CandidateSetListsMembersAndNextExperiment) {
  DiagnosisReport report = example();
  report.verdict = Verdict::set;
  report.ranking[1].is_cause = true;
  report.next_experiment = "repeat at half the rate";
  const std::string page = diagnosis_page(report);
  EXPECT_THAT(page, HasSubstr("These recordings cannot distinguish coulomb friction and stribeck friction."));
  EXPECT_THAT(page, HasSubstr("repeat at half the rate"));
}

TEST(DiagnosisPage, SetThatLeavesAPartSaysSo) {
  DiagnosisReport report = example();
  report.verdict = Verdict::set;
  EXPECT_THAT(verdict_sentence(report), Not(HasSubstr("No effect in the library explains what is left.")));
  report.set_leaves_a_part = true;
  EXPECT_THAT(verdict_sentence(report), HasSubstr("No effect in the library explains what is left."));
}

TEST(DiagnosisPage, CauseThatMayBeAbsentIsSaidToBeInTheFirstSentence) {
  DiagnosisReport report = example();
  report.verdict = Verdict::partial;
  EXPECT_THAT(verdict_sentence(report), HasSubstr("No effect in the library explains what is left."));
  report.ranking.front().may_be_absent = true;
  EXPECT_THAT(
      verdict_sentence(report),
      testing::AllOf(
          HasSubstr(
              "The 95\u00a0% interval of coulomb friction holds the value at which it is absent: it may not be there."),
          Not(HasSubstr("No effect in the library"))));
}

TEST(DiagnosisPage, SoManyCausesThatTheyMayStandForAnotherAreSaidToBe) {
  DiagnosisReport report = example();
  report.verdict = Verdict::partial;
  report.is_pieced_together = true;
  EXPECT_THAT(verdict_sentence(report), testing::AllOf(HasSubstr("they may stand for one that the library lacks."),
                                                       Not(HasSubstr("No effect in the library"))));
}

TEST(DiagnosisPage, CorrectionThatRanIntoALimitIsListedToo) {
  DiagnosisReport report = example();
  RankedCause correction;
  correction.interface = "specimen";
  correction.effect = "strength_error";
  correction.parameters = {{.name = "strength_error_ratio", .unit = "", .value = -0.9, .is_at_bound = true}};
  report.corrections = {correction};
  EXPECT_THAT(corrections_sentence(report), HasSubstr("strength error ratio -0.9 (the limit of its search range)"));
  report.corrections.front().parameters.front().is_at_bound = false;  // control: a number that was not searched
  EXPECT_EQ(corrections_sentence(report), "");
}

TEST(DiagnosisPage, PartOfWhichAnotherMayBeTheCauseSaysSo) {
  DiagnosisReport report = example();
  report.verdict = Verdict::partial;
  constexpr const char* kDoubt = " These recordings cannot distinguish coulomb friction and stribeck friction.";
  EXPECT_THAT(verdict_sentence(report), Not(HasSubstr(kDoubt)));
  for (std::size_t i = 0; i < 2; ++i) report.ranking[i].is_indistinguishable = true;
  EXPECT_THAT(verdict_sentence(report), HasSubstr(kDoubt));
}

TEST(DiagnosisPage, CauseBesideASetIsNoMemberOfIt) {
  DiagnosisReport report = example();
  report.verdict = Verdict::set;
  report.ranking.resize(2);
  for (RankedCause& member : report.ranking) member.is_cause = member.is_indistinguishable = true;
  RankedCause further;
  further.interface = "transfer_system";
  further.effect = "delay";
  further.is_cause = true;
  report.ranking.push_back(further);
  EXPECT_THAT(verdict_sentence(report),
              HasSubstr("cannot distinguish coulomb friction and stribeck friction; a further cause is delay of the "
                        "transfer system"));
  EXPECT_THAT(diagnosis_page(report), HasSubstr("cannot distinguish coulomb friction and stribeck friction."));
}

TEST(DiagnosisPage, MembersOfASetThatWereFoundTogetherAreOneAlternative) {
  DiagnosisReport report = example();
  report.verdict = Verdict::set;
  report.ranking.resize(1);
  RankedCause& stiffness = report.ranking.front();
  stiffness.effect = "stiffness_error";
  stiffness.share = 0.6;
  stiffness.is_cause = stiffness.is_indistinguishable = true;
  RankedCause strength = stiffness;
  strength.effect = "strength_error";
  RankedCause gain = stiffness;
  gain.interface = "force_sensor";
  gain.effect = "gain";
  gain.share = 0.0;
  report.ranking.insert(report.ranking.end(), {strength, gain});
  constexpr const char* kMembers =
      "cannot distinguish stiffness error of the specimen and strength error of the specimen together from gain of the "
      "force sensor";
  EXPECT_THAT(verdict_sentence(report), HasSubstr(kMembers));
  EXPECT_THAT(diagnosis_page(report), HasSubstr(kMembers));
}

TEST(DiagnosisPage, CausesAtSeveralInterfacesSayWhichOneEach) {
  DiagnosisReport report = example();
  RankedCause further;
  further.interface = "force_sensor";
  further.effect = "saturation";
  further.is_cause = true;
  report.ranking.insert(report.ranking.begin() + 1, further);
  EXPECT_THAT(verdict_sentence(report),
              HasSubstr("The gap is largest at the specimen (93.0\u00a0% of the whole gap); the causes are coulomb "
                        "friction of the specimen and saturation of the force sensor"));
  report.ranking.erase(report.ranking.begin());
  EXPECT_THAT(verdict_sentence(report),
              HasSubstr("The gap is largest at the specimen (93.0\u00a0% of the whole gap); its cause is saturation "
                        "of the force sensor"))
      << "the only cause is at another interface";
}

TEST(DiagnosisPage, MembersOfASetAtTwoInterfacesSayWhichOneEach) {
  DiagnosisReport report = example();
  report.verdict = Verdict::set;
  report.ranking.resize(2);
  for (RankedCause& member : report.ranking) {
    member.effect = "gain";
    member.is_cause = member.is_indistinguishable = true;
  }
  report.ranking[0].interface = "transfer_system";
  report.ranking[1].interface = "displacement_sensor";
  constexpr const char* kMembers = "cannot distinguish gain of the transfer system and gain of the displacement sensor";
  EXPECT_THAT(verdict_sentence(report), HasSubstr(kMembers));
  EXPECT_THAT(diagnosis_page(report), HasSubstr(kMembers));
}

TEST(Wording, QuantitiesUseReadableUnits) {
  EXPECT_EQ(quantity(0.0166, "s"), "16.6\u00a0ms");
  EXPECT_EQ(quantity(-4.0e6, "N/m"), "-4.00\u00a0MN/m");
  EXPECT_EQ(quantity(999.9, "N"), "1.00\u00a0kN");
  EXPECT_EQ(quantity(12.0, "Hz"), "12\u00a0Hz") << "left as it is";
  EXPECT_EQ(quantity(0.05, ""), "0.05");
  EXPECT_EQ(quantity(0.0, "m"), "0\u00a0m");
  EXPECT_EQ(plain_parameter("friction_force_n", "N"), "friction force");
  EXPECT_EQ(plain_parameter("damping_n_s_per_m", "N s/m"), "damping");
  EXPECT_EQ(plain_parameter("stiffening_n_per_m3", "N/m³"), "stiffening");
  EXPECT_EQ(plain_parameter("exponent", ""), "exponent");
}

TEST(Wording, PercentagesKeepSignificantDigits) {
  EXPECT_EQ(percent(0.5), "50\u00a0%");
  EXPECT_EQ(percent(0.997), "99.70\u00a0%");
  EXPECT_EQ(percent(0.02), "2.0\u00a0%");
  EXPECT_EQ(percent(1.0), "100\u00a0%");
}

}  // namespace
}  // namespace hybridtest::report
