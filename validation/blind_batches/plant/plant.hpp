#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <string_view>
#include <vector>

namespace hybridtest::blind {

/// Random numbers of the blind plant: std::mt19937_64, whose output the standard fixes, under
/// distributions of its own, so that a seed repeats a batch to the last byte anywhere.
class RandomStream {
 public:
  /// @param purpose   "site", "excitation" …: streams of one seed and different purposes are unrelated, so that
  ///                  what is drawn for one purpose cannot show in another.
  RandomStream(std::uint64_t seed, std::uint64_t index, std::string_view purpose);

  [[nodiscard]] double uniform(double low, double high);
  /// Uniform in the logarithm; both ends positive.
  [[nodiscard]] double log_uniform(double low, double high);
  /// Standard normal (Box and Muller, Ann. Math. Stat. 29, 1958).
  [[nodiscard]] double normal();
  /// 0 to count - 1.
  [[nodiscard]] std::size_t index(std::size_t count);
  /// 0 to weights.size() - 1, each as often as its weight says.
  [[nodiscard]] std::size_t weighted(const std::vector<double>& weights);
  [[nodiscard]] bool chance(double probability) { return uniform(0.0, 1.0) < probability; }
  [[nodiscard]] double sign() { return chance(0.5) ? 1.0 : -1.0; }

 private:
  std::mt19937_64 engine_;
};

/// Whole signals with equal intervals, and operations on them. The plant works on whole histories, not
/// sample by sample: the order of the calls is the order of the stages.

using History = std::vector<double>;

/// Fine steps of the plant per sample of a recording: 4 to 16 kHz.
inline constexpr std::size_t kFineSteps = 16;

/// A motion at one fine step.
struct MotionPoint {
  double time_s = 0.0;
  double displacement_m = 0.0;
  double velocity_m_per_s = 0.0;
  double acceleration_m_per_s2 = 0.0;
};

/// Velocity and acceleration of a displacement from its last four values (third and second order of the period),
/// for a plant that does not know what comes. At rest before the first value.
class Differentiator {
 public:
  explicit Differentiator(double period_s) : period_s_{period_s} {}
  [[nodiscard]] MotionPoint next(double displacement_m);

 private:
  double period_s_;
  double past_[3] = {};  // newest first
  double steps_ = 0.0;
};

/// A displacement or force held up by a broken number of steps; before the first value, the first.
class DelayLine {
 public:
  /// @param steps   less than none is none: no plant looks ahead.
  explicit DelayLine(double steps);
  [[nodiscard]] double next(double value);

 private:
  double steps_;
  History past_;  // a ring
  std::size_t count_ = 0;
};

/// On the fine grid.
struct MotionHistory {
  double period_s = 0.0;
  History displacement_m;
  History velocity_m_per_s;
  History acceleration_m_per_s2;

  [[nodiscard]] std::size_t size() const noexcept { return displacement_m.size(); }
  [[nodiscard]] MotionPoint at(std::size_t i) const {
    return {static_cast<double>(i) * period_s, displacement_m[i], velocity_m_per_s[i], acceleration_m_per_s2[i]};
  }
};

/// Straight lines between the samples, kFineSteps to an interval.
[[nodiscard]] History straight_lines(const History& samples);
/// Natural cubic spline through the samples, kFineSteps to an interval.
[[nodiscard]] History spline(const History& samples);
/// Every kFineSteps-th value.
[[nodiscard]] History sampled(const History& fine);

/// Central differences; one-sided at the ends.
[[nodiscard]] History derivative(const History& values, double period_s);
[[nodiscard]] MotionHistory motion_of(History displacement_m, double period_s);
/// Butterworth, second order, run forward and backward: no phase. @param cutoff_hz   below half the rate.
[[nodiscard]] History smoothed(const History& values, double period_s, double cutoff_hz);

/// The signal at a broken index, straight between samples, the first value before the first.
[[nodiscard]] double value_at(const History& values, double index) noexcept;
[[nodiscard]] History delayed(const History& values, double samples);

/// 0 below zero and u above, rounded over about `width`.
[[nodiscard]] double rounded_ramp(double u, double width) noexcept;
[[nodiscard]] double peak(const History& values) noexcept;
[[nodiscard]] double rms(const History& values) noexcept;
[[nodiscard]] History difference(const History& a, const History& b);
void add(History& values, const History& more, double factor = 1.0);

inline constexpr double kTwoPi = 2.0 * std::numbers::pi;

enum class TransferKind { ideal, delay, first_order, second_order };
enum class LawKind { none, elastic, bilinear, giuffre_menegotto_pinto, bouc_wen };

struct TransferModel {
  TransferKind kind = TransferKind::ideal;
  double delay_s = 0.0;               // delay and second_order
  double bandwidth_hz = 0.0;          // first_order, gain down by 3 dB
  double natural_frequency_hz = 0.0;  // second_order
  double damping_ratio = 0.0;
};

/// Noise of a sensor: white, coloured (autoregressive of order 1), or white with the hum of the mains.
struct NoiseModel {
  double standard_deviation = 0.0;  // of the random part
  double memory = 0.0;              // share of a value that stays until the next: 0 is white
  double hum_hz = 0.0;              // 0: no hum; else a sine whose rms is half the standard deviation

  /// With the hum.
  [[nodiscard]] double rms() const;
};

/// A history of noise. Stationary from its first value on.
[[nodiscard]] History noise_of(const NoiseModel& model, std::size_t count, double rate_hz, RandomStream& random);

/// Keys and meaning as in docs/scenario.md.
struct LawModel {
  LawKind kind = LawKind::elastic;
  double stiffness_n_per_m = 0.0;
  double yield_force_n = 0.0;
  double hardening_ratio = 0.0;
  double r0 = 20.0;
  double cr1 = 0.925;
  double cr2 = 0.15;
  double alpha = 0.0;
  double gamma_per_m = 0.0;  // n = 1
  double beta_per_m = 0.0;
};

/// Delay 0: none. The points of the polynomial are spaced by the delay.
struct CompensatorModel {
  int order = 3;
  double delay_s = 0.0;
};

/// The model of the site that the user has.
struct Site {
  TransferModel transfer_system;
  LawModel specimen;
  CompensatorModel compensator;
  double known_mass_kg = 0.0;  // effects that the user's model lists
  double known_damping_n_s_per_m = 0.0;
  NoiseModel displacement_noise_m;
  NoiseModel force_noise_n;
  double rate_hz = 0.0;  // of control and recording
};

using Parameters = std::map<std::string, double>;

/// A property of the real site that the user's model lacks. Units are part of the names of
/// its parameters, which docs/blind_batches.md describes.
struct PlantEffect {
  std::string interface;
  std::string name;
  Parameters parameters;
  std::string law = {};  // of the effect `hysteresis_law`: the plant's name of the law that the specimen follows

  [[nodiscard]] double of(const char* parameter) const { return parameters.at(parameter); }
  /// Of an effect with random parts.
  [[nodiscard]] std::uint64_t seed() const { return static_cast<std::uint64_t>(of("seed")); }
};

using PlantEffects = std::vector<PlantEffect>;

/// The true signals of the real site, without sensor noise.
struct TrueSignals {
  History sent_m;  // at the recording's rate, as the next two
  History target_m;
  History command_m;
  MotionHistory motion;  // fine
  History force_n;       // fine
  History read_m;        // readings of the sensors, at the recording's rate
  History read_n;
};

/// The recorded signals.
struct PlantRecording {
  History sent_m;
  History target_m;
  History command_m;
  History measured_m;
  History measured_n;
};

/// The whole chain from the coordinator's displacement to the sensors' readings.
[[nodiscard]] TrueSignals run_plant(const Site& site, const PlantEffects& effects, const History& sent_m);

/// Adds the sensors' noise.
[[nodiscard]] PlantRecording record(const Site& site, const TrueSignals& signals, RandomStream& random);

/// The output at which the residual of a model is computed.
enum class Residual { network, compensator, transfer_system, specimen };

/// A model (the user's, or one with effects) driven by given inputs of one stage.
/// @param driven_m     input of the stage as the model would have it: sent, target, command, or displacement.
[[nodiscard]] History stage_output(Residual residual, const Site& site, const PlantEffects& effects,
                                   const History& driven_m);

}  // namespace hybridtest::blind
