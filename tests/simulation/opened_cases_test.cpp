#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "diagnosis/runs/diagnose_site.hpp"
#include "diagnosis/runs/run_records.hpp"
#include "scenario/site_model_file.hpp"
#include "tests/unit/recording/temporary_directory.hpp"
#include "validation/blind_batches/batch.hpp"

/// Cases of blind batches that were opened, each of which the diagnosis once had wrong for a cause that was found
/// since. They say that it stays mended, and nothing about how often the diagnosis is right.
namespace hybridtest {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Not;

void write(const std::filesystem::path& path, const std::string& text) {
  std::ofstream{path, std::ios::binary} << text;
}

std::vector<std::string> causes_of_case(std::uint64_t seed, std::uint64_t number) {
  const blind::BlindCase opened = blind::draw_case(seed, number - 1);
  const TemporaryDirectory directory;
  write(directory / "site.yaml", blind::site_yaml(blind::sites_of(opened.setting)));
  const SiteModelFile model = read_site_model(directory / "site.yaml");
  const std::vector<std::string> files = blind::case_csv(opened);
  std::vector<Recording> recordings;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const std::filesystem::path file = directory / fmt::format("{}.csv", i);
    write(file, files[i]);
    recordings.push_back(read_recording(file, i + 1 < files.size() ? RecordingRole::fit : RecordingRole::held_out));
  }
  DiagnoseSettings settings;
  settings.threads = 2;
  std::vector<std::string> causes;
  for (const report::RankedCause& cause : diagnose_site(model, recordings, settings).diagnosis.report.ranking) {
    if (cause.is_cause) causes.push_back(cause.interface + "." + cause.effect);
  }
  return causes;
}

/// Dropped when the causes were compared at the lower rate, where its slip of a millisecond hardly exists: `unknown`.
TEST(OpenedCase, StictionIsNotLostAtTheLowerRate) {
  EXPECT_THAT(causes_of_case(3045078726, 30), Contains("transfer_system.stiction"));
}

/// The floor beside the best effect by itself hid what the numbers leave: friction of four times the floor.
TEST(OpenedCase, FrictionIsLookedForWhereTheFloorTurnsOutLower) {
  EXPECT_THAT(causes_of_case(1625051447, 266), Contains("specimen.coulomb_friction"));
}

/// The recording to fit does not reach the strength, the one held out does, and the stiffness is off by 1.7 %: told as
/// a spring beside the model it was contradicted, and all was `unknown`.
TEST(OpenedCase, FrameIsFoundBesideAStiffnessThatCarriesOver) {
  EXPECT_THAT(causes_of_case(1625051447, 207), Contains("transfer_system.compliance"));
}

/// The force is told by a lag of the transducer beside a wrong stiffness; with the actuator's delay as it had been
/// found without that lag, the motion was late twice, and its backlash did not carry over.
TEST(OpenedCase, BacklashIsFoundBesideALagThatTheForceShows) {
  EXPECT_THAT(causes_of_case(336772959, 159), Contains("transfer_system.backlash"));
}

/// The limit is a tenth of what is commanded.
TEST(OpenedCase, StrokeLimitFarBelowTheCommandIsFound) {
  EXPECT_THAT(causes_of_case(3680193090, 13), Contains("transfer_system.stroke_limit"));
}

/// A spring that softens, a damping and a stiffness that is off: a smooth law imitates the three, better than each of
/// them by itself.
TEST(OpenedCase, LawGivesWayToASofteningBesideADampingAndANumber) {
  EXPECT_THAT(causes_of_case(1132191460, 125), Contains("specimen.cubic_stiffness"));
}

/// Its interval holds none where the strength may be off, which the fit that has the strength free excludes.
TEST(OpenedCase, DriftIsFoundBesideAStrengthThatIsRight) {
  EXPECT_THAT(causes_of_case(137862330, 270), Contains("force_sensor.drift"));
}

/// The force is early by 2 ms, as by a damping or by a lag of the transducer. The motion is on time.
TEST(OpenedCase, TransducerThatReadsOnTimeHasNoLag) {
  EXPECT_THAT(causes_of_case(137862330, 157), Not(Contains("displacement_sensor.lag")));
}

/// Where the noise turned out smaller and the library was put in another order, an effect was listed by the fit of
/// another: the program crashed. Whatever the answer is.
TEST(OpenedCase, LeadersKeepTheirFitsWhenTheLibraryIsOrderedAgain) {
  EXPECT_THAT(causes_of_case(576926476, 64), Not(IsEmpty()));
}

/// A filter takes noise of the recorded motion away, and so left less than the delay of the force that is there.
TEST(OpenedCase, ForceThatIsReadLateIsNotFiltered) {
  EXPECT_THAT(causes_of_case(2607950161, 129), ElementsAre("force_sensor.time_skew"));
}

/// A damping makes more noise of the recorded motion than a fractional one of an order a little below one.
TEST(OpenedCase, DamperIsNotFractional) {
  EXPECT_THAT(causes_of_case(2607950161, 280), ElementsAre("specimen.viscous_damping"));
}

/// A damping found alone had taken up most of another one.
TEST(OpenedCase, QuadraticDampingShowsBesideALinearOne) {
  EXPECT_THAT(causes_of_case(3943260127, 51), Contains("specimen.quadratic_damping"));
}

/// A motion that sticks and jumps: its jumps end so many equal steps apart, told as a coarse converter of the load
/// cell.
TEST(OpenedCase, StictionIsNoQuantization) {
  EXPECT_THAT(causes_of_case(954709659, 7), ElementsAre("transfer_system.stiction"));
}

/// Laws and dampings that predicted better by themselves, each with numbers of its own in each recording, were listed
/// with the bias as effects that cannot be told from it.
TEST(OpenedCase, BiasIsToldFromWhatLeavesMore) {
  EXPECT_THAT(causes_of_case(954709659, 150), Not(Contains("specimen.fractional_damping")));
}

/// A damping and a bandwidth, each 3 to 4 % off, beside a wrong gain: told as a set of a pole that is missing, gains
/// and damping.
TEST(OpenedCase, NumbersSlightlyOffAreNoMissingPole) { EXPECT_THAT(causes_of_case(4105755390, 35), IsEmpty()); }

/// A limit that is not there was told, and made the held-out recording twice as far from the model.
TEST(OpenedCase, StrokeLimitThatMakesTheHeldOutGapLargerIsLeftOut) {
  EXPECT_THAT(causes_of_case(4105755390, 201),
              AllOf(Contains("transfer_system.stiction"), Contains("force_sensor.saturation"),
                    Not(Contains("transfer_system.stroke_limit"))));
}

/// The model's delay is 4 ms, the missing pole makes it 7.3 ms: told as numbers that are slightly off.
TEST(OpenedCase, MissingPoleIsNoSlightDelay) {
  EXPECT_THAT(causes_of_case(148278244, 197), Contains("transfer_system.delay"));
}

/// A specimen that pinches and fades: under what the simple laws leave, few samples count as independent, and a law
/// with so many numbers gained less than they cost. All was `unknown`. A simpler law that fades, beside which the rest
/// fades with the largest displacement, predicts as well.
TEST(OpenedCase, LawThatPinchesAndFadesIsToldInPart) {
  EXPECT_THAT(causes_of_case(1393686318, 24), Contains("specimen.hysteresis_law"));
}

/// One block alone reaches the limit. When it was left out, the rest moved the limit away.
TEST(OpenedCase, SaturationThatOneBlockAloneTellsIsFound) {
  EXPECT_THAT(causes_of_case(1393686318, 17), ElementsAre("force_sensor.saturation"));
}

/// The transducer's noise is coloured, and a damping makes several times as much of it as of white noise: a relaxation
/// and a fractional damping left less.
TEST(OpenedCase, DamperIsNamedBesideColouredNoiseOfTheMotion) {
  EXPECT_THAT(causes_of_case(4105755390, 273), ElementsAre("specimen.viscous_damping"));
  EXPECT_THAT(causes_of_case(4105755390, 218), ElementsAre("specimen.viscous_damping"));
}

/// A gain of the load cell of 3 % beside a stiffness that is off by 1.6 % was told as a stiffness that is off by 4.7 %
/// and a strength by 3 %: both numbers of the law were judged beside each other as they are.
TEST(OpenedCase, GainOfTheLoadCellIsInTheSetWithTheNumbersOfTheLaw) {
  EXPECT_THAT(causes_of_case(4221359521, 10), Contains("force_sensor.gain"));
}

/// Told in part as a damping, beside a stiffness and a strength that are off, which leave little more. In the first
/// case nothing else was tried, as these numbers left no clear gap; in the second the fractional damping was found and
/// dropped, for what it leaves beside what all the numbers leave, the damping in its place among them.
TEST(OpenedCase, FractionalDampingIsNotTheDampingInItsPlace) {
  EXPECT_THAT(causes_of_case(4221359521, 82), Contains("specimen.fractional_damping"));
  EXPECT_THAT(causes_of_case(954709659, 139), Contains("specimen.fractional_damping"));
}

/// The transducer of the motion hums with the mains. A lag of it whose second order cancels 50 Hz was named with
/// certainty. Of this planned motion lag and damping look alike.
TEST(OpenedCase, LagThatCancelsTheHumOfTheMainsIsNotNamedForADamper) {
  EXPECT_THAT(causes_of_case(2092165261, 130), Contains("specimen.viscous_damping"));
}

/// The stroke ends in a cushion, its last twentieth. A limit was fitted where the cushion begins, and refuted as
/// readings went on to its end.
TEST(OpenedCase, StrokeThatEndsInACushionIsALimit) {
  EXPECT_THAT(causes_of_case(1672258536, 191), Contains("transfer_system.stroke_limit"));
}

/// A stiffness that is lost in the first large motion and one that is wrong differ in one block alone. The fading was
/// dropped, as it may be none by its interval, and nothing stood in its place: `unknown`.
TEST(OpenedCase, WrongStiffnessTakesThePlaceOfAFadingThatMayBeNone) {
  EXPECT_THAT(causes_of_case(2103849539, 4), Contains("specimen.stiffness_error"));
}

/// Right but for noise, of which the held-out recording has as much as its floor says: a set stayed that took it
/// certainly further from the model.
TEST(OpenedCase, RightModelHasNoSet) { EXPECT_THAT(causes_of_case(2103849539, 145), IsEmpty()); }

}  // namespace
}  // namespace hybridtest
