#pragma once

#include "core/messages.hpp"

namespace hybridtest {

/// Fills the answer of a substructure to a rehearsal: as large as that to a step, with zeros for what nobody measured.
/// Does not allocate where `answer` has the size of the command already.
inline void answer_rehearsal(const DisplacementCommand& command, Incarnation sender, Duration now,
                             ForceMeasurement& answer) {
  const Eigen::Index dofs = command.newest().displacement_m.size();
  answer.substructure = command.substructure;
  answer.sender = sender;
  answer.step = kNoStep;
  answer.iteration = command.iteration;
  answer.model_time_s = 0.0;
  answer.imposed_displacement_m.setZero(dofs);
  answer.measured_displacement_m.setZero(dofs);
  answer.force_n.setZero(dofs);
  answer.flags = MeasurementFlags::none;
  answer.receive_time = answer.send_time = now;
  answer.command_send_time = command.send_time;
}

}  // namespace hybridtest
