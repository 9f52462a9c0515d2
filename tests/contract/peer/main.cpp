// contract_peer TEST: joins the test as `peer` over Fast DDS and repeats its status until a contract test kills it.

#include <sys/prctl.h>

#include <csignal>

#include "tests/contract/fast_dds/fast_dds_networks.hpp"
#include "tests/contract/sample_messages.hpp"

int main(int argc, char** argv) {
  using namespace hybridtest;
  if (argc != 2) return 64;
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  const auto peer = FastDdsUdpNetwork::join(argv[1]);
  const auto status = peer->status_outbox();
  while (true) {
    status->send(sample_status("peer"));
    static_cast<void>(peer->waker().wait_until(std::chrono::steady_clock::now() + kTestLease / 4));
  }
}
