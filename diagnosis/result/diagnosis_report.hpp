#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "diagnosis/recording.hpp"

/// What the page of a diagnosis shows: the fields of diagnosis.json, and the curves behind them.
namespace hybridtest::report {

/// 95 % interval.
struct Interval {
  double low = 0.0;
  double high = 0.0;
};

enum class Verdict : std::uint8_t { none, named, set, partial, unknown, not_excited };
/// As in diagnosis.json: `not_excited`.
[[nodiscard]] std::string_view name_of(Verdict verdict) noexcept;
/// `named`, `set` and `partial` do.
[[nodiscard]] bool names_a_cause(Verdict verdict) noexcept;

struct ReportedRecording {
  std::string file;
  std::string sha256;
  RecordingRole role = RecordingRole::fit;
  double duration_s = 0.0;
  double sample_period_s = 0.0;
  bool is_quasi_static = false;  // then a second stands for a cycle over the whole range
};

/// Difference between the residuals of repeated inputs.
struct Repeatability {
  double nrmse = 0.0;
  std::string source;  // `repeated cycles`, `repeated recordings`
};

/// Whether what the causes leave of a gap was seen to come back when the motion does.
struct Recurrence {
  // Share of its energy that a function of the motion without a name removes from cycles to which it was not fitted.
  double removed_by_function = 0.0;
  bool follows_motion = false;     // that function removes so much that it would be a gap
  bool repetitions_agree = false;  // they differ by much less than what is left

  [[nodiscard]] bool is_seen() const noexcept { return follows_motion || repetitions_agree; }
};

/// One interface of the chain. Root mean squares are relative to that of the measured output.
struct InterfaceGap {
  std::string interface;  // `transfer_system`
  bool is_judged = false;
  std::string why_not{};             // if not judged: the missing channel or other requirement
  bool is_at_fault = false;          // its gap is above its noise floor, and is more than numbers slightly off
  bool is_corrected = false;         // its gap is only numbers slightly off, see `corrections`
  std::optional<Verdict> verdict{};  // on this interface alone, if it is at fault
  double share = 0.0;                // of the whole gap, 0 to 1
  Interval share_ci95{};
  double nrmse = 0.0;
  double floor_nrmse = 0.0;                      // of noise
  std::optional<Repeatability> repeatability{};  // where the test repeats itself
  std::optional<Recurrence> recurrence{};        // where the verdict on it is `unknown` or `partial`
};

/// Readings of a channel while the motion is at rest, in its unit.
struct RestFacts {
  double first = 0.0;
  double last = 0.0;
  double drift_per_s = 0.0;
  double rms = 0.0;  // of the noise
};

/// Sensor checks of a measured channel.
struct SensorFacts {
  std::string recording;
  std::string column;  // `measured_force_n`
  std::string unit;
  double quantum = 0.0;         // smallest step between neighbours; 0 for a channel that never changes
  double repeated_share = 0.0;  // of samples that equal the one before
  double clipped_share = 0.0;   // of samples at the extreme values
  std::optional<RestFacts> at_rest{};
  std::optional<double> lag_s{};  // of a force behind the displacement
};

/// What a channel shows before any fit, or of its sampling once the causes are known.
struct Finding {
  std::string recording;  // its file
  std::string interface;
  std::string what;  // a sentence without its full stop that begins with the column
  std::string what_to_do;
};

struct ReportedParameter {
  std::string name;  // `friction_force_n`
  std::string unit;
  double value = 0.0;
  std::optional<Interval> ci95{};
  bool is_at_bound = false;
  bool is_at_least = false;          // at that bound it does not show any more: as large or larger
  std::optional<double> in_model{};  // of an effect that the model has: its value there
};

/// One effect in the ranking; the verdict's causes come first.
struct RankedCause {
  std::string interface;
  std::string effect;
  std::string law{};                  // `bouc_wen`: in place of the specimen's own; empty for an effect beside it
  std::string in_words{};             // of a law: what such a specimen does
  double lost_stiffness = 0.0;        // of a law: share of its stiffness that is gone by the end, 0 to 1
  std::string input{};                // the recorded input that it follows, `current_a`; empty: none
  std::string equation{};             // one line
  bool is_formula = false;            // of the user; else of the library
  double probability = 0.0;           // 0 to 1
  double share = 0.0;                 // of what all causes explain; 0 for an alternative
  bool is_cause = false;              // of the verdict; else an alternative
  bool is_indistinguishable = false;  // from the first one, on these recordings
  bool may_be_absent = false;         // at a value within the interval that is reported with it
  std::vector<ReportedParameter> parameters{};
};

/// The gap before and after the causes are added to the model, on held-out data if there are any.
struct Shrink {
  double nrmse_before = 0.0;
  double nrmse_after = 0.0;
  double floor_nrmse = 0.0;
  double changed_nrmse = 0.0;     // by how much the causes change the prediction
  double variance_removed = 0.0;  // 0 to 1
  std::optional<Interval> ci95{};
  std::optional<double> explainable_fraction{};  // (E0 - E1) / (E0 - floor), at most 1
  double unknown_share = 0.0;                    // of the gap before: repeatable and unexplained
};

/// A number of the whole test, as recorded and as the completed model predicts it.
struct PredictedNumber {
  std::string of;  // the degree of freedom; empty: of the whole structure
  double recorded = 0.0;
  double predicted = 0.0;
  Interval ci95{};  // of the number that such a test would have, see response_shrink()
};

/// The same in the response of a whole hybrid test.
struct ResponseShrink {
  std::string recording{};  // the run directory whose test was run again
  double nrmse_before = 0.0;
  double nrmse_after = 0.0;
  double peak_error_before = 0.0;  // relative to the peak
  double peak_error_after = 0.0;
  std::optional<double> energy_error_before{};  // in the substructures, over the input of the ground motion
  std::optional<double> energy_error_after{};
  // What follows is known where the test was also run with drawn noise and drawn parameters.
  std::optional<double> floor_nrmse{};         // what a right model leaves, because of the noise in the recorded test
  double variance_removed = 0.0;               // at most 1; negative where the causes make the response worse
  std::optional<Interval> ci95{};              // of it, in a repetition of this test
  std::optional<Interval> nrmse_after_ci95{};  // likewise
  std::optional<Interval> peak_error_after_ci95{};
  std::optional<Interval> energy_error_after_ci95{};
  std::optional<double> explainable_fraction{};   // as Shrink
  std::optional<double> unknown_share{};          // as Shrink
  std::vector<PredictedNumber> peaks{};           // [m] of |displacement|, one per degree of freedom
  std::optional<PredictedNumber> energy_taken{};  // [J] by the substructures, by the end
};

/// Input and output of one interface, recorded and modelled: the curves of the page.
/// All have the same length and a constant sample period.
struct InterfaceSeries {
  std::string interface;
  std::size_t dof = 0;    // 0-based
  std::string recording;  // its file
  bool is_held_out = false;
  double sample_period_s = 0.0;
  bool is_quasi_static = false;     // then a second stands for a cycle over the whole range
  std::string unit;                 // of the output: "m" or "N"
  std::vector<double> input_m{};    // its input: command of a transfer system, measured displacement of a specimen
  std::vector<double> measured{};   // output
  std::vector<double> model{};      // output of the user's model
  std::vector<double> augmented{};  // output with the causes added; empty when there is no cause
};

struct DiagnosisReport {
  std::string site;  // name of the model, for the heading
  std::string model_file;
  std::string model_part{};   // of a scenario as the model's file: `the rig of storey_1`; empty for a site file
  std::string made_at_utc{};  // empty where the diagnosis must not depend on the time
  std::string made_by{};      // version of the software
  std::vector<ReportedRecording> recordings;
  Verdict verdict = Verdict::not_excited;
  bool set_leaves_a_part = false;  // of a set: no member explains all that is above the floor
  bool is_pieced_together =
      false;  // of `partial`: the causes are so many that they may stand for one that the library lacks
  std::vector<InterfaceGap> where;  // every interface of the chain, in its order or by share
  std::vector<RankedCause> ranking;
  // Numbers of the model that are slightly off: corrected in the augmented model, but no causes.
  std::vector<RankedCause> corrections{};
  std::vector<SensorFacts> sensors{};
  std::vector<Finding> findings{};
  std::optional<Shrink> interface_shrink;  // at the interfaces where the causes act; none without a cause
  std::optional<ResponseShrink> response_shrink;
  std::string why_no_response;          // where there is none
  std::string next_experiment;          // empty if the cause is clear and all of the force was read
  std::vector<std::string> notes;       // for the reader: parameters at their limits, missing channels
  std::vector<InterfaceSeries> series;  // at least of the interface at fault; its first one is drawn large
};

}  // namespace hybridtest::report
