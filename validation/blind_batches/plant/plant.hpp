#pragma once

#include "validation/blind_batches/plant/history.hpp"
#include "validation/blind_batches/plant/random_stream.hpp"
#include "validation/blind_batches/plant/site.hpp"

namespace hybridtest::blind {

/// What happened at the real site, without sensor noise.
struct TrueSignals {
  History sent_m;  // at the recording's rate, as the next two
  History target_m;
  History command_m;
  MotionHistory motion;  // fine
  History force_n;       // fine
  History read_m;        // what the sensors say, at the recording's rate
  History read_n;
};

/// What was recorded of it.
struct PlantRecording {
  History sent_m;
  History target_m;
  History command_m;
  History measured_m;
  History measured_n;
};

/// The whole chain from the coordinator's displacement to the sensors' readings.
[[nodiscard]] TrueSignals run_plant(const Site& site, const PlantEffects& effects, const History& sent_m);

/// Adds the sensors' noise, normal and white.
[[nodiscard]] PlantRecording record(const Site& site, const TrueSignals& signals, RandomStream& random);

/// Where the residual of a model is looked at.
enum class Residual { network, compensator, transfer_system, specimen };

/// A model (the user's, or one with effects) driven by given inputs of one stage.
/// @param driven_m     input of the stage as the model would have it: sent, target, command, or displacement.
[[nodiscard]] History stage_output(Residual residual, const Site& site, const PlantEffects& effects,
                                   const History& driven_m);

}  // namespace hybridtest::blind
