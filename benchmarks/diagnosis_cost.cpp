// Time of a whole diagnosis per second of recording, for 10, 20 and 40 s at 1 kHz, as a ratio to one replay of the same
// recording (which smooths it and predicts it once), measured in one run; and the longest time without a progress
// report, as a display sees it that has a clock. At the end, how much sooner all threads end than one.
//
// The specimen yields and its model is a spring: the whole library and every law are fitted. Processor time of all
// threads counts, so that other work on the machine matters little; not so for the last figure, which needs a machine
// that does nothing else.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <memory>
#include <numbers>
#include <thread>

#include "core/random.hpp"
#include "diagnosis/diagnose.hpp"
#include "diagnosis/replay.hpp"
#include "mechanics/laws/bilinear.hpp"
#include "mechanics/laws/elastic.hpp"
#include "plant/transfer_systems/ideal.hpp"

namespace {

using namespace hybridtest;

constexpr double kPeriod_s = 0.001;
constexpr double kStiffness_n_per_m = 2.0e6;
constexpr double kForceNoise_n = 20.0;
constexpr double kDisplacementNoise_m = 1.0e-6;
constexpr int kReplays = 20;

/// Two sines that grow for half of the time.
double motion_m(double time_s, double duration_s) {
  const double growth = std::min(1.0, 2.0 * time_s / duration_s);
  return growth * (0.02 * std::sin(2.0 * std::numbers::pi * 0.9 * time_s) +
                   0.008 * std::sin(2.0 * std::numbers::pi * 2.3 * time_s));
}

Recording recorded(double duration_s) {
  Recording recording;
  recording.file = "made.csv";
  recording.sample_period_s = kPeriod_s;
  recording.samples = static_cast<std::size_t>(std::lround(duration_s / kPeriod_s));
  recording.dofs.resize(1);
  Bilinear specimen{{.stiffness_n_per_m = kStiffness_n_per_m, .yield_force_n = 2.0e4, .hardening_ratio = 0.05}};
  Random random{1};
  for (std::size_t i = 0; i < recording.samples; ++i) {
    const double at_m = motion_m(kPeriod_s * static_cast<double>(i), duration_s);
    const double force_n = specimen.trial(at_m, 0.0);
    specimen.commit();
    DofRecording& dof = recording.dofs[0];
    dof.of(Channel::command_displacement).push_back(at_m);
    dof.of(Channel::measured_displacement).push_back(at_m + kDisplacementNoise_m * random.normal());
    dof.of(Channel::measured_force).push_back(force_n + kForceNoise_n * random.normal());
  }
  return recording;
}

SiteModel spring() {
  SiteModel model;
  model.make_transfer_system = [](double, double) { return std::make_unique<Ideal>(); };
  model.make_law = [] { return std::make_unique<Elastic>(kStiffness_n_per_m); };
  return model;
}

/// Of all threads of this process.
double processor_s() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

using WallClock = std::chrono::steady_clock;

double seconds_since(WallClock::time_point begin) {
  return std::chrono::duration<double>(WallClock::now() - begin).count();
}

/// Wall time of a diagnosis.
double wall_s(const SiteModel& model, const Recording& recording, std::size_t threads) {
  DiagnoseSettings settings;
  settings.threads = threads;
  const WallClock::time_point begin = WallClock::now();
  static_cast<void>(diagnose(model, {&recording, 1}, settings));
  return seconds_since(begin);
}

}  // namespace

int main() {
  const SiteModel model = spring();
  const std::size_t threads = std::max(1U, std::thread::hardware_concurrency());
  std::printf("Diagnosis of a specimen that yields by a spring, 1 kHz, %zu threads.\n", threads);
  std::printf("%10s %14s %20s %16s %10s %18s\n", "recording", "processor, s", "per s of recording", "over one replay",
              "wall, s", "longest silence, s");
  bool named = true;
  for (const double duration_s : {10.0, 20.0, 40.0}) {
    const Recording recording = recorded(duration_s);
    const double replay_begin_s = processor_s();
    for (int i = 0; i < kReplays; ++i) named = !replay(model, recording, 0).empty() && named;
    const double replay_s = (processor_s() - replay_begin_s) / kReplays;

    DiagnoseSettings settings;
    settings.threads = threads;
    double silence_s = 0.0;
    WallClock::time_point last = WallClock::now();
    const auto count_silence = [&](const ProgressReport&) {
      silence_s = std::max(silence_s, seconds_since(last));
      last = WallClock::now();
    };
    const auto now = [] {
      return Instant{std::chrono::duration_cast<Instant::duration>(WallClock::now().time_since_epoch())};
    };
    settings.progress = PartProgress{count_silence, now};
    const WallClock::time_point begin = WallClock::now();
    const double begin_s = processor_s();
    const Diagnosis diagnosis = diagnose(model, {&recording, 1}, settings);
    const double spent_s = processor_s() - begin_s;
    named = !diagnosis.causes.empty() && named;
    std::printf("%8.0f s %14.2f %20.3f %16.0f %10.2f %18.2f\n", duration_s, spent_s, spent_s / duration_s,
                spent_s / replay_s, seconds_since(begin), silence_s);
  }
  const Recording recording = recorded(20.0);
  const double one_s = wall_s(model, recording, 1);
  const double all_s = wall_s(model, recording, threads);
  std::printf("20 s with one thread: %.2f s, with %zu: %.2f s; %.2f times as fast\n", one_s, threads, all_s,
              one_s / all_s);
  return named ? 0 : 1;
}
