// The echo through our Fast DDS transport. The thread of each participant waits on its Waker, as the
// executor does. Shows the cost of the transport in addition to the plain echo.

#include <unistd.h>

#include <chrono>
#include <stdexcept>
#include <utility>

#include "benchmarks/echo.hpp"
#include "benchmarks/echo_payload.hpp"
#include "benchmarks/peer_processes.hpp"
#include "transport/fast_dds/fast_dds_transport.hpp"

namespace hybridtest::benchmarks {
namespace {

using Clock = std::chrono::steady_clock;

std::unique_ptr<Transport> join(const EchoSettings& settings, int run, std::string substructure_id) {
  fast_dds::FastDdsSettings transport;
  transport.domain = settings.domain;
  transport.loopback_only = true;
  transport.loopback_participants = 80;
  transport.shared_memory = settings.network == "shared_memory";
  transport.best_effort_coupling = settings.best_effort;
  transport.receives_in_waiting_thread = settings.receive == "waiting";
  transport.busy_poll = std::chrono::microseconds{settings.busy_poll_us};
  transport.substructure_id = std::move(substructure_id);
  transport.repair_period = fast_dds::FastDdsSettings::repair_period_for(static_cast<std::size_t>(settings.peers));
  return fast_dds::make_fast_dds_transport(transport, "echo" + std::to_string(run));
}

}  // namespace

void transport_echo_peer(const EchoSettings& settings, int index, int run) {
  const auto transport = join(settings, run, "peer_" + std::to_string(index));
  const auto commands = transport->command_inbox(static_cast<SubstructureIndex>(index));
  const auto measurements = transport->measurement_outbox(static_cast<SubstructureIndex>(index));
  DisplacementCommand command;
  ForceMeasurement measurement = echo_measurement();
  measurement.substructure = static_cast<SubstructureIndex>(index);
  while (true) {
    static_cast<void>(transport->waker().wait_until(Clock::time_point::max()));
    while (commands->take(command)) {
      measurement.step = command.newest().step;
      measurements->send(measurement);
    }
  }
}

std::vector<double> transport_echo_us(const EchoSettings& settings) {
  static int runs = 0;
  const int run = static_cast<int>(::getpid()) * 100 + runs++ % 100;
  PeerProcesses peers;
  for (int i = 0; i < settings.peers; ++i) peers.start(echo_peer_arguments("transport", i, run, settings));
  const auto transport = join(settings, run, "");
  const auto peer_count = static_cast<SubstructureIndex>(settings.peers);
  const auto commands = transport->command_outbox(peer_count);
  const auto measurements = transport->measurement_inbox(peer_count);
  Waker& waker = transport->waker();
  const Clock::time_point give_up = Clock::now() + std::chrono::seconds{20};
  for (SubstructureIndex peer = 0; peer < peer_count; ++peer) {
    while (!transport->reachable(peer)) {
      if (Clock::now() > give_up) throw std::runtime_error{"the transport echo peers did not appear"};
      static_cast<void>(waker.wait_until(Clock::now() + std::chrono::milliseconds{100}));
    }
  }

  DisplacementCommand command = echo_command();
  ForceMeasurement measurement;
  std::vector<Step> answered(peer_count, kNoStep);
  std::vector<double> times_us;
  times_us.reserve(static_cast<std::size_t>(settings.samples));
  for (int i = 0; i < settings.warm_up + settings.samples; ++i) {
    const Clock::time_point start = Clock::now();
    SubstructureIndex missing = peer_count;
    command.points[0].step = i;
    while (missing > 0) {
      for (SubstructureIndex peer = 0; peer < peer_count; ++peer) {
        command.substructure = peer;
        if (answered[peer] != i) commands->send(command);
      }
      const Clock::time_point repeat = Clock::now() + std::chrono::milliseconds{200};
      if (repeat > start + std::chrono::seconds{20}) throw std::runtime_error{"an echo peer stopped answering"};
      while (missing > 0 && waker.wait_until(repeat)) {
        while (measurements->take(measurement)) {
          if (measurement.step != i || std::exchange(answered.at(measurement.substructure), i) == i) continue;
          --missing;
        }
      }
    }
    const std::chrono::duration<double, std::micro> round_trip = Clock::now() - start;
    if (i >= settings.warm_up) times_us.push_back(round_trip.count());
  }
  return times_us;
}

}  // namespace hybridtest::benchmarks
