#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "diagnosis/localisation/gap_shares.hpp"
#include "diagnosis/localisation/localise.hpp"
#include "diagnosis/recording.hpp"
#include "diagnosis/result/diagnosis_report.hpp"
#include "plant/site_model.hpp"

namespace hybridtest {

struct DiagnoseSettings {
  std::uint64_t seed = 1;   // of the resampling behind intervals
  std::size_t threads = 1;  // changes nothing but the time it takes
  std::size_t dof = 0;      // of the recordings, 0-based
  std::string site;         // names for the report
  std::string model_file;
  std::function<void(std::size_t done, std::size_t all)> progress;  // one call at a time, from any thread
};

/// Where in time, frequency and motion the gap of one interface lies.
struct GapPlace {
  std::string interface;
  std::vector<TimeWindow> time_windows;
  std::vector<BandShare> bands;
  std::vector<GapRegion> regions;
};

struct Diagnosis {
  report::DiagnosisReport report;
  std::vector<GapPlace> places;
  std::vector<EffectSetting> causes;  // to be added to the model, in this order
};

/// Where a model and recordings of the real site disagree, which effect of the library causes it, and how far
/// the gap shrinks with it. Pure: the same input gives the same bytes.
///
/// Effects are searched and judged on the recordings of the role fit, on blocks left out of the fit;
/// those of the role held_out serve to measure how far the gap shrinks, and to drop causes that leave it there.
/// @param recordings   at least one of the role fit; all have the degree of freedom asked for.
[[nodiscard]] Diagnosis diagnose(const SiteModel& model, std::span<const Recording> recordings,
                                 const DiagnoseSettings& settings);

}  // namespace hybridtest
