#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <vector>

#include "compensation/delay_estimator.hpp"
#include "core/parameters/parameter_archive.hpp"

namespace hybridtest {

/// Delay from the frequency evaluation index (Guo, Chen, Xu and Sanchez, Earthquake Engng Struct. Dyn.
/// 43, 2014, with exponent 2), over windows that follow each other.
///
///     R_j, M_j    Fourier coefficients of reference and measurement in the window, frequencies f_j
///     FEI         = sum of (M_j / R_j) |R_j|^2 / sum of |R_j|^2
///     amplitude   = |FEI|,   f_eq = sum of f_j |R_j|^2 / sum of |R_j|^2
///     delay       = -arg(FEI) / (2 pi f_eq)
///
/// with f_j the multiples of 1/window from frequency_hz_min to frequency_hz_max. The window is Hann's, which
/// leaves the phases of a tone between two f_j right, as a rectangular one does not; a new one begins
/// when the last is half over, so that there is an estimate every half window. Exact for a pure delay of
/// a tone; of several tones, up to the third power of the phase angles. The angle has to stay below
/// half a turn: delay f_eq below 1/2.
///
/// Frozen while the root mean square of r in the window is below motion_m_min.
class FrequencyEvaluationIndex final : public DelayEstimator {
 public:
  struct Parameters {
    DelayLimits limits;
    double window_s = 1.0;
    double frequency_hz_min = 0.5;
    double frequency_hz_max = 25.0;
    double motion_m_min = 1e-4;

    void serialize(ParameterArchive& archive) {
      archive.optional("window_s", window_s,
                       {{.low = 0.1, .high = 100.0},
                        "rounded to an even number of control periods",
                        "it holds some cycles of the structure"});
      archive.optional("frequency_hz_min", frequency_hz_min,
                       {.range = kNotNegative, .what = "slower motion is drift", .values = "0 to `frequency_hz_max`"});
      archive.optional("frequency_hz_max", frequency_hz_max,
                       {.range = kPositive,
                        .what = "end of the band",
                        .values = "more than 0, at most 0.45 of the control rate and 256/`window_s`"});
      archive.optional("motion_m_min", motion_m_min, kEstimatorMotion);
      limits.serialize(archive);
    }
  };

  /// @throws ConfigError for values outside their ranges.
  FrequencyEvaluationIndex(const Parameters& parameters, double control_period_s);

  /// |FEI| of the last window that told something; 1 before. Below 1 where the measurement is smaller.
  [[nodiscard]] double amplitude() const noexcept { return amplitude_; }
  /// f_eq [Hz] of the same; 0 before.
  [[nodiscard]] double frequency_hz() const noexcept { return frequency_hz_; }

 private:
  // A window of which some samples have passed, and the Fourier sums over these.
  struct Window {
    explicit Window(std::size_t frequencies) : reference(frequencies), measured(frequencies) {}
    std::vector<std::complex<double>> reference;
    std::vector<std::complex<double>> measured;
    std::size_t sample = 0;
    bool has_begun = false;
  };

  void observe(const DelaySample& sample) noexcept override;
  void forget() noexcept override;
  void accumulate(Window& window, const DelaySample& sample) noexcept;
  void evaluate(const Window& window) noexcept;
  static void clear(Window& window) noexcept;

  Parameters parameters_;
  std::size_t samples_;                      // in a window, even
  std::size_t first_;                        // f_j = j / window, from first_
  std::size_t count_;                        // number of f_j
  std::vector<std::complex<double>> turns_;  // exp(-2 pi i n / samples_)
  std::vector<double> taper_;                // Hann's window
  std::array<Window, 2> windows_;
  double amplitude_ = 1.0;
  double frequency_hz_ = 0.0;
};

}  // namespace hybridtest
