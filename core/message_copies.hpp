#pragma once

#include <cstddef>
#include <utility>

#include "core/messages.hpp"

/// Copies of what is copied in every step. Nearly all interfaces have one degree of freedom: there a copy of a vector
/// is a few instructions, not the dozens of a loop that is ready for any size.
namespace hybridtest {

/// to = from, of any sizes.
template <class Vector>
inline void copy_values(const Vector& from, Vector& to) noexcept {
  if (from.size() == 1 && to.size() == 1) [[likely]] {
    to.coeffRef(0) = from.coeff(0);
  } else {
    to = from;
  }
}

/// The same where `from` is not needed any more: it gets the memory of `to`, which costs less than looking at sizes.
inline void move_values(InterfaceVector& from, InterfaceVector& to) noexcept { to.swap(from); }

namespace message_copies {

/// @param values   copies or moves the values of a vector to another.
template <class Point, class Values>
inline void carry(Point& from, CommandPoint& to, Values values) noexcept {
  to.step = from.step;
  to.model_time_s = from.model_time_s;
  values(from.displacement_m, to.displacement_m);
  values(from.velocity_m_per_s, to.velocity_m_per_s);
  values(from.acceleration_m_per_s2, to.acceleration_m_per_s2);
}

/// Points that are not in use keep what they had: of a wide interface they are most of a command.
template <class Command, class Values>
inline void carry(Command& from, DisplacementCommand& to, Values values) noexcept {
  to.substructure = from.substructure;
  to.coordinator = from.coordinator;
  to.iteration = from.iteration;
  to.is_trial = from.is_trial;
  to.is_rehearsal = from.is_rehearsal;
  to.point_count = from.point_count;
  for (std::size_t i = 0; i < from.point_count; ++i) carry(from.points[i], to.points[i], values);
  to.attempt = from.attempt;
  to.send_time = from.send_time;
}

template <class Measurement, class Values>
inline void carry(Measurement& from, ForceMeasurement& to, Values values) noexcept {
  to.substructure = from.substructure;
  to.sender = from.sender;
  to.step = from.step;
  to.iteration = from.iteration;
  to.model_time_s = from.model_time_s;
  values(from.imposed_displacement_m, to.imposed_displacement_m);
  values(from.measured_displacement_m, to.measured_displacement_m);
  values(from.force_n, to.force_n);
  to.flags = from.flags;
  to.receive_time = from.receive_time;
  to.send_time = from.send_time;
  to.command_send_time = from.command_send_time;
}

struct Copy {
  void operator()(const InterfaceVector& from, InterfaceVector& to) const noexcept { copy_values(from, to); }
};
struct Move {
  void operator()(InterfaceVector& from, InterfaceVector& to) const noexcept { move_values(from, to); }
};

}  // namespace message_copies

template <class Message>
inline void copy_message(const Message& from, Message& to) {
  if constexpr (requires { message_copies::carry(from, to, message_copies::Copy{}); }) {
    message_copies::carry(from, to, message_copies::Copy{});
  } else {
    to = from;
  }
}

/// For a message that is not needed any more.
template <class Message>
inline void move_message(Message& from, Message& to) {
  if constexpr (requires { message_copies::carry(from, to, message_copies::Move{}); }) {
    message_copies::carry(from, to, message_copies::Move{});
  } else {
    to = std::move(from);
  }
}

}  // namespace hybridtest
