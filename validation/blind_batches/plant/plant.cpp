#include "validation/blind_batches/plant/plant.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "validation/blind_batches/plant/signal_chain.hpp"
#include "validation/blind_batches/plant/specimen.hpp"

namespace hybridtest::blind {

namespace {

/// FNV-1a.
std::uint64_t hash(std::string_view text) {
  std::uint64_t value = 14695981039346656037ULL;
  for (const char c : text) value = (value ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  return value;
}

/// Finaliser of SplitMix64, so that neighbouring seeds start far apart.
std::uint64_t mixed(std::uint64_t value) {
  value += 0x9E3779B97F4A7C15ULL;
  value = (value ^ (value >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  value = (value ^ (value >> 27U)) * 0x94D049BB133111EBULL;
  return value ^ (value >> 31U);
}

}  // namespace

RandomStream::RandomStream(std::uint64_t seed, std::uint64_t index, std::string_view purpose)
    : engine_{mixed(mixed(mixed(seed) ^ index) ^ hash(purpose))} {}

double RandomStream::uniform(double low, double high) {
  return low + (high - low) * static_cast<double>(engine_() >> 11U) * 0x1p-53;
}

double RandomStream::log_uniform(double low, double high) { return std::exp(uniform(std::log(low), std::log(high))); }

double RandomStream::normal() {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform(0.0, 1.0)));
  return radius * std::cos(2.0 * std::numbers::pi * uniform(0.0, 1.0));
}

std::size_t RandomStream::index(std::size_t count) {
  return static_cast<std::size_t>(uniform(0.0, static_cast<double>(count)));
}

std::size_t RandomStream::weighted(const std::vector<double>& weights) {
  double left = uniform(0.0, std::accumulate(weights.begin(), weights.end(), 0.0));
  for (std::size_t i = 0; i + 1 < weights.size(); ++i) {
    left -= weights[i];
    if (left < 0.0) return i;
  }
  return weights.size() - 1;
}

namespace {

/// Second derivatives of the natural spline at the samples, intervals of length 1 (Thomas algorithm).
History curvatures(const History& samples) {
  const std::size_t n = samples.size();
  History curvature(n, 0.0);
  History share(n, 0.0);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double right = 6.0 * (samples[i + 1] - 2.0 * samples[i] + samples[i - 1]);
    const double pivot = 4.0 - share[i - 1];
    share[i] = 1.0 / pivot;
    curvature[i] = (right - curvature[i - 1]) / pivot;
  }
  for (std::size_t i = n - 1; i-- > 1;) curvature[i] -= share[i] * curvature[i + 1];
  return curvature;
}

void filter_in_place(History& values, double period_s, double cutoff_hz) {
  const double c = 1.0 / std::tan(std::numbers::pi * cutoff_hz * period_s);
  const double a0 = 1.0 + std::numbers::sqrt2 * c + c * c;
  const double a1 = 2.0 * (1.0 - c * c) / a0;
  const double a2 = (1.0 - std::numbers::sqrt2 * c + c * c) / a0;
  double x1 = values.front();
  double x2 = x1;
  double y1 = x1;
  double y2 = x1;
  for (double& value : values) {
    const double y = (value + 2.0 * x1 + x2) / a0 - a1 * y1 - a2 * y2;
    x2 = std::exchange(x1, value);
    y2 = std::exchange(y1, y);
    value = y;
  }
}

}  // namespace

History straight_lines(const History& samples) {
  History fine((samples.size() - 1) * kFineSteps + 1);
  for (std::size_t i = 0; i < fine.size(); ++i) {
    fine[i] = value_at(samples, static_cast<double>(i) / static_cast<double>(kFineSteps));
  }
  return fine;
}

History spline(const History& samples) {
  const History curvature = curvatures(samples);
  History fine((samples.size() - 1) * kFineSteps + 1);
  for (std::size_t i = 0; i + 1 < fine.size(); ++i) {
    const std::size_t k = i / kFineSteps;
    const double b = static_cast<double>(i % kFineSteps) / static_cast<double>(kFineSteps);
    const double a = 1.0 - b;
    fine[i] = a * samples[k] + b * samples[k + 1] +
              ((a * a * a - a) * curvature[k] + (b * b * b - b) * curvature[k + 1]) / 6.0;
  }
  fine.back() = samples.back();
  return fine;
}

History sampled(const History& fine) {
  History samples;
  samples.reserve(fine.size() / kFineSteps + 1);
  for (std::size_t i = 0; i < fine.size(); i += kFineSteps) samples.push_back(fine[i]);
  return samples;
}

History derivative(const History& values, double period_s) {
  const std::size_t n = values.size();
  History slope(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t before = i == 0 ? 0 : i - 1;
    const std::size_t after = std::min(i + 1, n - 1);
    slope[i] = (values[after] - values[before]) / (static_cast<double>(after - before) * period_s);
  }
  return slope;
}

MotionHistory motion_of(History displacement_m, double period_s) {
  MotionHistory motion;
  motion.period_s = period_s;
  motion.velocity_m_per_s = derivative(displacement_m, period_s);
  motion.acceleration_m_per_s2 = derivative(motion.velocity_m_per_s, period_s);
  motion.displacement_m = std::move(displacement_m);
  return motion;
}

History smoothed(const History& values, double period_s, double cutoff_hz) {
  History result = values;
  filter_in_place(result, period_s, cutoff_hz);
  std::ranges::reverse(result);
  filter_in_place(result, period_s, cutoff_hz);
  std::ranges::reverse(result);
  return result;
}

double value_at(const History& values, double index) noexcept {
  if (index <= 0.0) return values.front();
  const auto whole = static_cast<std::size_t>(index);
  if (whole + 1 >= values.size()) return values.back();
  const double fraction = index - static_cast<double>(whole);
  return values[whole] + fraction * (values[whole + 1] - values[whole]);
}

History delayed(const History& values, double samples) {
  History result(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) result[i] = value_at(values, static_cast<double>(i) - samples);
  return result;
}

double rounded_ramp(double u, double width) noexcept {
  return u > 30.0 * width ? u : width * std::log1p(std::exp(u / width));
}

double peak(const History& values) noexcept {
  double largest = 0.0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

double rms(const History& values) noexcept {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return values.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(values.size()));
}

History difference(const History& a, const History& b) {
  History result = a;
  add(result, b, -1.0);
  return result;
}

void add(History& values, const History& more, double factor) {
  for (std::size_t i = 0; i < values.size(); ++i) values[i] += factor * more[i];
}

MotionPoint Differentiator::next(double displacement_m) {
  const double x = displacement_m;
  if (steps_ == 0.0) past_[0] = past_[1] = past_[2] = x;
  const double velocity = (11.0 * x - 18.0 * past_[0] + 9.0 * past_[1] - 2.0 * past_[2]) / (6.0 * period_s_);
  const double acceleration = (2.0 * x - 5.0 * past_[0] + 4.0 * past_[1] - past_[2]) / (period_s_ * period_s_);
  past_[2] = std::exchange(past_[1], std::exchange(past_[0], x));
  return {period_s_ * steps_++, x, velocity, acceleration};
}

DelayLine::DelayLine(double steps) : steps_{std::max(0.0, steps)}, past_(static_cast<std::size_t>(steps_) + 2) {}

double DelayLine::next(double value) {
  const std::size_t size = past_.size();
  if (count_ == 0) std::ranges::fill(past_, value);
  past_[count_ % size] = value;
  const auto whole = static_cast<std::size_t>(steps_);
  const double later = past_[(count_ + size - whole) % size];
  const double earlier = past_[(count_ + size - whole - 1) % size];
  ++count_;
  return later + (steps_ - static_cast<double>(whole)) * (earlier - later);
}

namespace {

/// Of the hum, over the standard deviation of the random part.
constexpr double kHumRms = 0.5;

}  // namespace

double NoiseModel::rms() const { return standard_deviation * (hum_hz > 0.0 ? std::hypot(1.0, kHumRms) : 1.0); }

History noise_of(const NoiseModel& model, std::size_t count, double rate_hz, RandomStream& random) {
  const double fresh = std::sqrt(1.0 - model.memory * model.memory);
  double value = random.normal();
  const double phase = random.uniform(0.0, kTwoPi);
  // The rms of a sine is its amplitude over sqrt(2).
  const double hum = model.hum_hz > 0.0 ? std::numbers::sqrt2 * kHumRms : 0.0;
  History noise(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double turn = kTwoPi * model.hum_hz * static_cast<double>(i) / rate_hz + phase;
    noise[i] = model.standard_deviation * (value + hum * std::sin(turn));
    value = model.memory * value + fresh * random.normal();
  }
  return noise;
}

namespace {

/// Well above the motions of excitation.cpp and below the noise that differentiation amplifies.
constexpr double kDerivativeCutoffHz = 40.0;

double fine_period_s(const Site& site) { return 1.0 / (site.rate_hz * static_cast<double>(kFineSteps)); }

/// A motion that was measured: the displacement as it is, its derivatives from a smoothed copy.
MotionHistory measured_motion(const Site& site, const History& displacement_m) {
  MotionHistory motion =
      motion_of(spline(smoothed(displacement_m, 1.0 / site.rate_hz, kDerivativeCutoffHz)), fine_period_s(site));
  motion.displacement_m = spline(displacement_m);
  return motion;
}

}  // namespace

TrueSignals run_plant(const Site& site, const PlantEffects& effects, const History& sent_m) {
  TrueSignals signals;
  signals.sent_m = sent_m;
  signals.target_m = through_network(site, effects, sent_m);
  signals.command_m = compensated(site, effects, signals.target_m);
  signals.motion = actuator_motion(site, effects, signals.command_m);
  signals.force_n = specimen_force(site, effects, signals.motion);
  signals.read_m = sampled(reading("displacement_sensor", effects, signals.motion, signals.motion.displacement_m));
  signals.read_n = sampled(reading("force_sensor", effects, signals.motion, signals.force_n));
  return signals;
}

PlantRecording record(const Site& site, const TrueSignals& signals, RandomStream& random) {
  PlantRecording recording{signals.sent_m, signals.target_m, signals.command_m, signals.read_m, signals.read_n};
  add(recording.measured_m, noise_of(site.displacement_noise_m, signals.sent_m.size(), site.rate_hz, random));
  add(recording.measured_n, noise_of(site.force_noise_n, signals.sent_m.size(), site.rate_hz, random));
  return recording;
}

History stage_output(Residual residual, const Site& site, const PlantEffects& effects, const History& driven_m) {
  switch (residual) {
    case Residual::network: return through_network(site, effects, driven_m);
    case Residual::compensator: return compensated(site, effects, driven_m);
    case Residual::transfer_system: {
      const MotionHistory motion = actuator_motion(site, effects, driven_m);
      return sampled(reading("displacement_sensor", effects, motion, motion.displacement_m));
    }
    case Residual::specimen: {
      const MotionHistory motion = measured_motion(site, driven_m);
      return sampled(reading("force_sensor", effects, motion, specimen_force(site, effects, motion)));
    }
  }
  return {};
}

}  // namespace hybridtest::blind
