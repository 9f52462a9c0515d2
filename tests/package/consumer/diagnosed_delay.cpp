#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <vector>

#include "diagnosis/diagnose.hpp"
#include "plant/transfer_systems/ideal.hpp"

// The model of a site has an ideal actuator, its recording one that is 16 ms late: the diagnosis names the delay.
namespace {

using namespace hybridtest;

constexpr double kPeriodS = 1.0 / 256.0;
constexpr double kDelayS = 0.016;
constexpr std::size_t kSamples = 1536;

/// Two sines of 0.8 and 2.1 Hz that grow and fade.
double displacement_m(double time_s) {
  const double angle = 2.0 * std::numbers::pi * time_s;
  const double length_s = kPeriodS * kSamples;
  return 0.02 * std::sin(std::numbers::pi * time_s / length_s) * (std::sin(0.8 * angle) + 0.5 * std::sin(2.1 * angle));
}

}  // namespace

int main() {
  SiteModel model;
  model.make_transfer_system = [](double, double) { return std::make_unique<Ideal>(); };

  Recording recording{.file = "late.csv", .sha256 = {}, .sample_period_s = kPeriodS, .samples = kSamples, .dofs = {}};
  DofRecording dof;
  for (std::size_t sample = 0; sample < kSamples; ++sample) {
    const double time_s = kPeriodS * static_cast<double>(sample);
    dof.of(Channel::command_displacement).push_back(displacement_m(time_s));
    dof.of(Channel::measured_displacement).push_back(displacement_m(time_s - kDelayS));
  }
  recording.dofs.push_back(dof);

  const std::vector<Recording> recordings{recording};
  const Diagnosis diagnosis = diagnose(model, recordings, {.threads = 2, .site = "site", .model_file = "site.yaml"});
  for (const EffectSetting& cause : diagnosis.causes) {
    std::printf("%s: %.4f\n", std::string{cause.type->name}.c_str(), cause.values.front());
    if (cause.type->name == "delay") return std::fabs(cause.values.front() - kDelayS) < 0.001 ? 0 : 1;
  }
  return 1;
}
