#include "validation/studies/rths_benchmark/virtual_run.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/random.hpp"
#include "validation/studies/rths_benchmark/constants.hpp"
#include "validation/studies/rths_benchmark/frame.hpp"
#include "validation/studies/rths_benchmark/plant.hpp"

namespace hybridtest::rths {
namespace {

struct Sensors {
  double displacement_m = 0.0;
  double force_n = 0.0;
};

class NoisySensors {
 public:
  explicit NoisySensors(const VirtualTest& test) : random_{test.noise_seed, test.noise_stream} {
    if (!test.has_sensor_noise) scale_ = 0.0;
  }
  [[nodiscard]] Sensors read(const Plant& plant) noexcept {
    const double displacement_noise_m = scale_ * kDisplacementNoiseM * random_.normal();
    return {plant.displacement_m() + displacement_noise_m, plant.force_n() + scale_ * kForceNoiseN * random_.normal()};
  }

 private:
  Random random_;
  double scale_ = 1.0;
};

TestHistory empty_history(std::size_t samples) {
  TestHistory history;
  for (auto* signal :
       {&history.target_m, &history.true_m, &history.measured_m, &history.floor_2_m, &history.floor_3_m}) {
    signal->reserve(samples);
  }
  return history;
}

void evaluate(const VirtualTest& test, const TestHistory& history, TestResult& result) {
  const double period_s = test.samples_per_exchange * kPeriodS;
  const Floors reference = every(test.reference, test.samples_per_exchange);
  const auto& [floor_1_m, floor_2_m, floor_3_m] = reference;
  result.criteria = evaluate_criteria({history.target_m, history.measured_m, history.floor_2_m, history.floor_3_m},
                                      {floor_1_m, floor_2_m, floor_3_m}, period_s);
  result.noise_floor_percent = 100.0 * kDisplacementNoiseM / standard_deviation(history.target_m);
  result.true_tracking_percent = deviation_error_percent(history.true_m, history.target_m);
  result.true_delay_s = fitted_delay_s(history.true_m, history.target_m, period_s);
}

}  // namespace

TestResult run_virtual_test(const VirtualTest& test, ControlPath& path, ForceCompensator& force_compensator,
                            TestHistory* history) {
  const Frame frame = Frame::of_case(test.case_number).without(test.plant);
  const auto stride = static_cast<std::size_t>(test.samples_per_exchange);
  const std::size_t samples = test.reference.samples();
  TestHistory signals = empty_history(samples / stride + 1);
  TestResult result;
  NoisySensors sensors{test};
  Plant plant{test.plant};
  Frame::State state{};
  Sensors before;
  for (std::size_t i = 0; i < samples; i += stride) {
    const double time_s = static_cast<double>(i) * kPeriodS;
    const Sensors now = sensors.read(plant);
    const double force_n = force_compensator.corrected_force({state[0], before.displacement_m, before.force_n});
    const auto acceleration = frame.acceleration(state, test.motion.at(time_s), force_n);
    const double command_m = path.command(
        {state[0], state[kFloors], acceleration[0], now.displacement_m, before.displacement_m, before.force_n});

    signals.target_m.push_back(state[0]);
    signals.true_m.push_back(plant.displacement_m());
    signals.measured_m.push_back(now.displacement_m);
    signals.floor_2_m.push_back(state[1]);
    signals.floor_3_m.push_back(state[2]);
    result.peak_force_n = std::max(result.peak_force_n, std::abs(plant.force_n()));
    const bool is_hopeless = result.peak_force_n >= kHopelessShare * kForceLimitN;
    if (is_hopeless || !std::isfinite(plant.force_n()) || !std::isfinite(command_m)) break;

    for (std::size_t k = 0; k < stride; ++k) {
      plant.step(command_m);
      frame.step(state, test.motion, time_s + static_cast<double>(k) * kPeriodS, force_n);
    }
    before = now;
    result.is_complete = i + stride >= samples;
  }
  if (result.is_complete) {
    evaluate(test, signals, result);
  } else {
    result.criteria = no_criteria();
    result.noise_floor_percent = result.true_tracking_percent = result.true_delay_s = kNotANumber;
  }
  if (history != nullptr) *history = std::move(signals);
  return result;
}

}  // namespace hybridtest::rths
