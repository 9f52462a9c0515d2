#include "coordinator/opensees/generic_client_server.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <memory>

#include "core/config_error.hpp"
#include "tests/contract/opensees/served_springs.hpp"
#include "tests/support/stand_in_client.hpp"

/// Real sockets on this machine, at numbers that the system gave; the client is ours.
namespace hybridtest {
namespace {

using generic_client::Bytes;
using generic_client::kDataSize;
using generic_client::message;
using generic_client::sizes;
using generic_client::trial;
using generic_client::operator+;
using testing::HasSubstr;
using testing::ThrowsMessage;
using Kind = ElementRequest::Kind;
using Over = StandInClient::Over;

Eigen::MatrixXd spring(double stiffness_n_per_m) { return Eigen::MatrixXd::Constant(1, 1, stiffness_n_per_m); }
/// Of the relative displacement of two degrees of freedom.
Eigen::MatrixXd drift(double stiffness_n_per_m) {
  return (Eigen::Matrix2d{} << stiffness_n_per_m, -stiffness_n_per_m, -stiffness_n_per_m, stiffness_n_per_m).finished();
}

class GenericClientServerTest : public testing::TestWithParam<Over> {
 protected:
  /// A client of one degree of freedom that has been let in.
  static std::unique_ptr<StandInClient> connect(ServedSprings& springs, Over over = GetParam()) {
    auto client = std::make_unique<StandInClient>(springs.port(), over);
    EXPECT_TRUE(client->shakes_hands());
    client->send(sizes(1));
    const auto request = springs.next();
    EXPECT_TRUE(request && request->kind == Kind::connected);
    return client;
  }
  static void expect_next(ServedSprings& springs, Kind kind, ClientFault fault) {
    const auto request = springs.next();
    ASSERT_TRUE(request.has_value());
    EXPECT_EQ(request->kind, kind);
    EXPECT_EQ(request->fault, fault) << describe(request->fault);
  }
  /// A client at work still is.
  static void expect_served(ServedSprings& springs, StandInClient& client, double stiffness_n_per_m = 1000.0) {
    client.send(trial(1, 0.25) + message(10.0));
    ASSERT_TRUE(springs.answer_until(Kind::force));
    const auto answer = client.answer();
    ASSERT_TRUE(answer.has_value());
    EXPECT_EQ((*answer)[0], 0.25 * stiffness_n_per_m);
  }
};
INSTANTIATE_TEST_SUITE_P(Sockets, GenericClientServerTest, testing::Values(Over::tcp, Over::udp),
                         [](const auto& tested) { return tested.param == Over::tcp ? "Tcp" : "Udp"; });

TEST_P(GenericClientServerTest, ServesTheSequenceOfEachIntegrator) {
  for (const auto& [name, actions] : generic_client::step_sequences()) {
    SCOPED_TRACE(name);
    ServedSprings springs{{spring(1000.0)}};
    const auto client = connect(springs);
    double displacement_m = 0.0;
    for (int step = 0; step < 3; ++step) {
      for (const int action : actions) {
        if (action == 3) displacement_m += 0.125;
        client->send(action == 3 ? trial(1, displacement_m) : message(action, kDataSize, 7.0));
        if (action == 10) {
          ASSERT_TRUE(springs.answer_until(Kind::force));
        }
        if (action < 10) continue;
        const auto answer = client->answer();
        ASSERT_TRUE(answer.has_value()) << action;
        const double expected = action == 10 ? 1000.0 * displacement_m : action == 13 ? 1000.0 : 0.0;
        ASSERT_EQ((*answer)[0], expected) << action;
      }
    }
    client->send(message(99.0));
    EXPECT_TRUE(springs.answer_until(Kind::die));
  }
}

TEST_P(GenericClientServerTest, ElementsAreToldApartInAnyOrder) {
  ServedSprings springs{{spring(10.0), drift(100.0), spring(1000.0)}};
  std::vector<std::unique_ptr<StandInClient>> clients(3);
  for (const std::size_t i : {2U, 0U, 1U}) {
    clients[i] = std::make_unique<StandInClient>(springs.port(i), GetParam());
    ASSERT_TRUE(clients[i]->shakes_hands());
    clients[i]->send(sizes(i == 1 ? 2 : 1));
  }
  ASSERT_TRUE(springs.answer_until(Kind::connected, 3));
  for (const std::vector<std::size_t>& order : {std::vector<std::size_t>{0, 1, 2}, {2, 1, 0}, {1, 0, 2}}) {
    for (const std::size_t i : order) {
      const std::vector<double> values{3.0, 0.5, 0.25};
      clients[i]->send(i == 1 ? message(values) : trial(1, 0.5));
      clients[i]->send(message(10.0));
    }
    ASSERT_TRUE(springs.answer_until(Kind::force, 3));
    EXPECT_EQ((*clients[0]->answer())[0], 5.0);
    EXPECT_EQ((*clients[2]->answer())[0], 500.0);
    const auto force = clients[1]->answer();
    ASSERT_TRUE(force.has_value());
    EXPECT_EQ((*force)[0], 25.0);
    EXPECT_EQ((*force)[1], -25.0);
  }
}

TEST_P(GenericClientServerTest, LargeMessagesArriveWhole) {
  // 160 kB, or four datagrams: the system keeps about 200 kB for a client over UDP, and drops the rest.
  const int large = GetParam() == Over::tcp ? 20'000 : 4000;
  ServedSprings springs{{spring(1000.0)}};
  StandInClient client{springs.port(), GetParam()};
  ASSERT_TRUE(client.shakes_hands());
  client.send(sizes(1, large));
  for (int i = 1; i <= 3; ++i) {
    client.send(trial(1, 0.5 * i, 0.0, 0.0, 0.0, large));
    client.send(message(10.0, large));
    ASSERT_TRUE(springs.answer_until(Kind::force));
    const auto answer = client.answer(large);
    ASSERT_TRUE(answer.has_value());
    EXPECT_EQ((*answer)[0], 500.0 * i);
  }
}

TEST_P(GenericClientServerTest, RefusesAnotherAddress) {
  ServedSprings springs{{spring(1000.0)}};
  StandInClient stranger{springs.port(), GetParam(), "127.0.0.2"};
  if (GetParam() == Over::udp) {
    EXPECT_FALSE(stranger.shakes_hands(50));
  }
  expect_next(springs, Kind::refused, ClientFault::address);
  EXPECT_EQ(springs.server().refused(), 1U);
  const auto client = connect(springs);
  expect_served(springs, *client);
}

TEST_P(GenericClientServerTest, RefusesASecondClientAndKeepsTheFirst) {
  ServedSprings springs{{spring(1000.0)}};
  const auto client = connect(springs);
  StandInClient second{springs.port(), GetParam()};
  if (GetParam() == Over::udp) {
    EXPECT_FALSE(second.shakes_hands(50));
  }
  second.send(sizes(1));
  expect_next(springs, Kind::refused, ClientFault::occupied);
  if (GetParam() == Over::tcp) {
    EXPECT_TRUE(second.is_closed());
  } else {
    expect_next(springs, Kind::refused, ClientFault::other_protocol);  // it sends on without the handshake
  }
  expect_served(springs, *client);
}

TEST_P(GenericClientServerTest, RefusesAnElementOfAnotherSize) {
  ServedSprings springs{{spring(1000.0)}};
  StandInClient wrong{springs.port(), GetParam()};
  ASSERT_TRUE(wrong.shakes_hands());
  wrong.send(sizes(2));
  expect_next(springs, Kind::refused, ClientFault::other_size);
  const auto client = connect(springs);
  expect_served(springs, *client);
}

TEST_P(GenericClientServerTest, GarbageAfterTheSizesLosesTheClientWithoutAnAnswer) {
  ServedSprings springs{{spring(1000.0)}};
  const auto client = connect(springs);
  client->send(message(7.0));
  expect_next(springs, Kind::lost, ClientFault::other_message);
  client->send(trial(1, 0.5) + message(10.0));
  const auto again = connect(springs);  // the next request is of the new client
  expect_served(springs, *again);
}

TEST_P(GenericClientServerTest, DisplacementThatIsNotFiniteNeverArrives) {
  ServedSprings springs{{spring(1000.0)}};
  const auto client = connect(springs);
  client->send(trial(1, std::numeric_limits<double>::quiet_NaN()) + message(10.0));
  expect_next(springs, Kind::lost, ClientFault::not_finite);
  EXPECT_TRUE(springs.trials().empty());
}

TEST_P(GenericClientServerTest, QuestionStaysOpenUntilItIsAnswered) {
  ServedSprings springs{{spring(1000.0)}};
  const auto client = connect(springs);
  client->send(trial(1, 0.5));
  client->send(message(10.0));
  client->send(trial(1, 0.75));  // OpenSees would wait
  ASSERT_TRUE(springs.next() && springs.next());
  EXPECT_FALSE(client->answer(kDataSize, 20).has_value());
  ElementRequest request;
  EXPECT_FALSE(springs.server().take(request)) << "10 is the last request until its answer";
  springs.server().answer_force(0, Eigen::VectorXd::Constant(1, 4.0));
  EXPECT_EQ((*client->answer())[0], 4.0);
  const auto next = springs.next();
  ASSERT_TRUE(next.has_value());
  EXPECT_EQ(next->displacement_m[0], 0.75);
}

TEST_P(GenericClientServerTest, AnswerThatNobodyAskedForIsNotSent) {
  ServedSprings springs{{spring(1000.0)}};
  springs.server().answer_force(0, Eigen::VectorXd::Constant(1, 4.0));
  const auto client = connect(springs);
  springs.server().answer_force(0, Eigen::VectorXd::Constant(1, 4.0));
  expect_served(springs, *client);
}

TEST_P(GenericClientServerTest, ClientThatFloodsIsHeldBackAndLosesNothing) {
  constexpr int kTrials = 5000;
  ServedSprings springs{{spring(1000.0)}};
  const auto client = connect(springs);
  std::thread flood{[&] {
    for (int i = 1; i <= kTrials; ++i) {
      client->send(trial(1, i));
      // Over UDP the system drops what it cannot keep; OpenSees too waits for an answer now and then.
      if (i % (GetParam() == Over::udp ? 20 : 100) == 0) {
        client->send(message(10.0));
        EXPECT_TRUE(client->answer());
      }
    }
    client->send(message(99.0));
  }};
  EXPECT_TRUE(springs.answer_until(Kind::die));
  flood.join();
  ASSERT_EQ(springs.trials().size(), static_cast<std::size_t>(kTrials));
  for (int i = 1; i <= kTrials; ++i) ASSERT_EQ(springs.trials()[static_cast<std::size_t>(i - 1)][0], i);
}

class GenericClientOverTcp : public GenericClientServerTest {};
INSTANTIATE_TEST_SUITE_P(Sockets, GenericClientOverTcp, testing::Values(Over::tcp));

TEST_P(GenericClientOverTcp, MessagesByteByByteAreTheSame) {
  ServedSprings springs{{spring(1000.0)}};
  StandInClient client{springs.port(), Over::tcp};
  const Bytes bytes = sizes(1, 5) + trial(1, 0.5, 0.0, 0.0, 0.0, 5) + message(10.0, 5);
  for (const std::byte& byte : bytes) client.send({&byte, 1});
  ASSERT_TRUE(springs.answer_until(Kind::force));
  EXPECT_EQ((*client.answer(5))[0], 500.0);
}

TEST_P(GenericClientOverTcp, ConnectionCutAtEachByteIsReportedOnce) {
  const Bytes whole = sizes(1, 5) + trial(1, 0.5, 0.0, 0.0, 0.0, 5);
  ServedSprings springs{{spring(1000.0)}};
  for (std::size_t cut = 0; cut < whole.size(); ++cut) {
    StandInClient client{springs.port(), Over::tcp};
    client.send(std::span{whole}.first(cut));
    client.close();
    if (cut == 0) continue;  // whoever says nothing is nobody
    if (cut < 44) {
      expect_next(springs, Kind::refused, ClientFault::other_protocol);
    } else {
      const auto request = springs.next();
      ASSERT_TRUE(request && request->kind == Kind::connected) << cut;
      expect_next(springs, Kind::lost, ClientFault::closed);
    }
  }
  const auto client = connect(springs, Over::tcp);
  expect_served(springs, *client);
}

TEST_P(GenericClientOverTcp, KilledClientWithAnOpenQuestionIsLost) {
  ServedSprings springs{{spring(1000.0)}};
  const auto client = connect(springs);
  client->send(trial(1, 0.5) + message(10.0));
  ASSERT_TRUE(springs.next() && springs.next());
  client->reset();
  expect_next(springs, Kind::lost, ClientFault::closed);
  springs.server().answer_force(0, Eigen::VectorXd::Zero(1));  // too late, and no harm
}

TEST_P(GenericClientOverTcp, MessagesBeforeTheEndOfAConnectionArrive) {
  ServedSprings springs{{spring(1000.0)}};
  const auto client = connect(springs);
  client->send(trial(1, 0.5) + message(5.0) + message(99.0));
  client->close();
  for (const Kind kind : {Kind::trial, Kind::commit, Kind::die}) {
    const auto request = springs.next();
    ASSERT_TRUE(request.has_value());
    EXPECT_EQ(request->kind, kind);
  }
  const auto again = connect(springs);  // no `lost` after 99
  expect_served(springs, *again);
}

TEST_P(GenericClientOverTcp, SilentConnectionsKeepNoClientOut) {
  ServedSprings springs{{spring(1000.0)}};
  std::vector<std::unique_ptr<StandInClient>> silent;
  for (int i = 0; i < 10; ++i) silent.push_back(std::make_unique<StandInClient>(springs.port(), Over::tcp));
  const auto client = connect(springs);
  expect_served(springs, *client);
}

TEST_P(GenericClientOverTcp, ManyRefusalsCrowdNoRequestOut) {
  ServedSprings springs{{spring(1000.0)}};
  const auto client = connect(springs);
  constexpr std::uint64_t kMany = 300;
  for (std::uint64_t i = 0; i < kMany; ++i) {
    StandInClient stranger{springs.port(), Over::tcp, "127.0.0.2"};
    ASSERT_TRUE(stranger.is_closed());
  }
  EXPECT_EQ(springs.server().refused(), kMany);
  expect_served(springs, *client);
}

TEST(GenericClientPort, TakenPortIsNamedWithWhatToDo) {
  const ServedSprings springs{{spring(1000.0)}};
  const std::vector<ServedElement> same{{springs.port(), {spring(1.0), spring(0.0), spring(0.0)}}};
  EXPECT_THAT([&] { GenericClientServer("127.0.0.1", "127.0.0.1", same, [] {}); },
              ThrowsMessage<ConfigError>(AllOf(HasSubstr("port " + std::to_string(springs.port())),
                                               HasSubstr("give the element another port"))));
}

TEST(GenericClientPort, AddressesThatAreNoneAreNamedByTheirKey) {
  EXPECT_THAT([] { GenericClientServer("localhost", "127.0.0.1", {}, [] {}); },
              ThrowsMessage<ConfigError>(HasSubstr("coordinator.listen")));
  EXPECT_THAT([] { GenericClientServer("127.0.0.1", "::1", {}, [] {}); },
              ThrowsMessage<ConfigError>(HasSubstr("coordinator.from")));
}

}  // namespace
}  // namespace hybridtest
