#include "tests/fuzz/generic_client_fuzz.hpp"

#include <algorithm>
#include <span>
#include <vector>

#include "coordinator/opensees/generic_client_session.hpp"
#include "core/assert.hpp"

namespace hybridtest {
namespace {

constexpr Eigen::Index kDofs = 2;

struct Understood {
  std::vector<ElementRequest::Kind> kinds;
  std::vector<Eigen::VectorXd> trials;
  std::size_t replies = 0;
  ClientFault fault = ClientFault::unknown;

  bool operator==(const Understood&) const = default;
};

Understood understand(std::span<const std::byte> bytes, std::size_t portion) {
  static const ElementMatrices matrices{Eigen::MatrixXd::Identity(kDofs, kDofs), Eigen::MatrixXd::Zero(kDofs, kDofs),
                                        Eigen::MatrixXd::Zero(kDofs, kDofs)};
  GenericClientSession session{matrices};
  Understood understood;
  ElementRequest request;
  std::size_t reply_size = 0;
  while (!bytes.empty()) {
    std::span<const std::byte> arrived = bytes.first(std::min(portion, bytes.size()));
    bytes = bytes.subspan(arrived.size());
    while (!arrived.empty()) {
      const GenericClientSession::Outcome outcome = session.take(arrived, request);
      if (outcome == GenericClientSession::Outcome::fault) {
        understood.fault = session.fault();
        return understood;
      }
      if (outcome == GenericClientSession::Outcome::reply) {
        ++understood.replies;
        HYBRIDTEST_ASSERT(session.reply().size() == session.force_reply(Eigen::VectorXd::Ones(kDofs)).size());
        HYBRIDTEST_ASSERT(reply_size == 0 || reply_size == session.reply().size());
        reply_size = session.reply().size();
      }
      if (outcome != GenericClientSession::Outcome::request) continue;
      understood.kinds.push_back(request.kind);
      if (request.kind != ElementRequest::Kind::trial) continue;
      for (const Eigen::VectorXd* part :
           {&request.displacement_m, &request.velocity_m_per_s, &request.acceleration_m_per_s2}) {
        HYBRIDTEST_ASSERT(part->size() == kDofs && part->allFinite());
        understood.trials.push_back(*part);
      }
    }
  }
  return understood;
}

}  // namespace

GenericClientOutcome fuzz_generic_client(const std::uint8_t* bytes, std::size_t size) {
  const std::span<const std::byte> all{reinterpret_cast<const std::byte*>(bytes), size};
  const Understood understood = understand(all, std::max<std::size_t>(size, 1));
  for (const std::size_t portion : {1U, 7U, 44U, 100U}) HYBRIDTEST_ASSERT(understand(all, portion) == understood);
  const bool is_client = !understood.kinds.empty();
  if (understood.fault != ClientFault::unknown) {
    return is_client ? GenericClientOutcome::lost : GenericClientOutcome::refused;
  }
  return is_client ? GenericClientOutcome::accepted : GenericClientOutcome::waiting;
}

}  // namespace hybridtest

#ifdef HYBRIDTEST_LIBFUZZER
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  (void)hybridtest::fuzz_generic_client(bytes, size);
  return 0;
}
#endif
