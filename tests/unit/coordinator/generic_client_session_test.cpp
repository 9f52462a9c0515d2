#include "coordinator/opensees/generic_client_session.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "tests/support/generic_client_bytes.hpp"

namespace hybridtest {
namespace {

using generic_client::Bytes;
using generic_client::doubles;
using generic_client::kDataSize;
using generic_client::message;
using generic_client::sizes;
using generic_client::trial;
using generic_client::operator+;
using Kind = ElementRequest::Kind;
using Outcome = GenericClientSession::Outcome;

ElementMatrices matrices_of(Eigen::Index n) {
  // No two entries alike, and not symmetric: a row for a column would be seen.
  Eigen::MatrixXd stiffness(n, n);
  for (Eigen::Index i = 0; i < stiffness.size(); ++i) stiffness.data()[i] = 100.0 + static_cast<double>(i);
  return {stiffness, stiffness * 2.0, stiffness * 3.0};
}

struct Heard {
  std::vector<ElementRequest> requests;
  std::vector<std::vector<double>> replies;
  ClientFault fault = ClientFault::unknown;
};

/// What a session makes of bytes that come in portions of this size.
Heard hear(const ElementMatrices& matrices, const Bytes& bytes, std::size_t portion) {
  GenericClientSession session{matrices};
  Heard heard;
  ElementRequest request;
  for (std::size_t at = 0; at < bytes.size(); at += portion) {
    std::span<const std::byte> arrived = std::span{bytes}.subspan(at, std::min(portion, bytes.size() - at));
    while (!arrived.empty()) {
      const Outcome outcome = session.take(arrived, request);
      if (outcome == Outcome::request) heard.requests.push_back(request);
      if (outcome == Outcome::reply) heard.replies.push_back(doubles(session.reply()));
      if (outcome != Outcome::fault) continue;
      heard.fault = session.fault();
      return heard;
    }
  }
  return heard;
}
Heard hear(const Bytes& bytes, Eigen::Index n = 1) {
  const ElementMatrices matrices = matrices_of(n);
  return hear(matrices, bytes, bytes.size());
}

TEST(GenericClientSession, SizesOfTheElementConnect) {
  const Heard heard = hear(sizes(3), 3);
  ASSERT_EQ(heard.requests.size(), 1U);
  EXPECT_EQ(heard.requests[0].kind, Kind::connected);
}

TEST(GenericClientSession, TrialHasAllDegreesOfFreedomInOrder) {
  const std::vector<double> values{3.0, 0.1, 0.2, 1.1, 1.2, 2.1, 2.2, 0.5};
  const Heard heard = hear(sizes(2) + message(values), 2);
  ASSERT_EQ(heard.requests.size(), 2U);
  EXPECT_EQ(heard.requests[1].kind, Kind::trial);
  EXPECT_EQ(heard.requests[1].displacement_m, Eigen::Vector2d(0.1, 0.2));
  EXPECT_EQ(heard.requests[1].velocity_m_per_s, Eigen::Vector2d(1.1, 1.2));
  EXPECT_EQ(heard.requests[1].acceleration_m_per_s2, Eigen::Vector2d(2.1, 2.2));
  EXPECT_EQ(heard.requests[1].time_s, 0.5);
}

TEST(GenericClientSession, IgnoresWhatAnOlderMessageLeftBehind) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double left : {7.0, 1e300, nan}) {
    const Heard heard = hear(sizes(1) + message(10.0, kDataSize, left) + message(5.0, kDataSize, left) +
                             message(99.0, kDataSize, left));
    ASSERT_EQ(heard.requests.size(), 4U) << left;
    EXPECT_EQ(heard.requests[1].kind, Kind::force);
    EXPECT_EQ(heard.requests[2].kind, Kind::commit);
    EXPECT_EQ(heard.requests[3].kind, Kind::die);
  }
}

TEST(GenericClientSession, AnswersMatricesByColumnsWithZerosBehind) {
  const ElementMatrices matrices = matrices_of(2);
  const Heard heard = hear(matrices, sizes(2) + message(12.0) + message(13.0) + message(14.0) + message(15.0), 100'000);
  ASSERT_EQ(heard.replies.size(), 4U);
  const std::vector<double> factors{1.0, 1.0, 2.0, 3.0};
  for (std::size_t i = 0; i < factors.size(); ++i) {
    ASSERT_EQ(heard.replies[i].size(), static_cast<std::size_t>(kDataSize));
    for (std::size_t k = 0; k < heard.replies[i].size(); ++k) {
      const double expected = k < 4 ? factors[i] * (100.0 + static_cast<double>(k)) : 0.0;
      ASSERT_EQ(heard.replies[i][k], expected) << "matrix " << i << ", slot " << k;
    }
  }
  EXPECT_EQ(heard.requests.size(), 1U) << "nobody else is asked";
}

TEST(GenericClientSession, ForceReplyIsOneMessageWithZerosBehind) {
  const ElementMatrices matrices = matrices_of(2);
  GenericClientSession session{matrices};
  const Bytes hello = sizes(2, 8);
  std::span<const std::byte> bytes{hello};
  ElementRequest request;
  ASSERT_EQ(session.take(bytes, request), Outcome::request);
  EXPECT_EQ(doubles(session.force_reply(Eigen::Vector2d{4.0, 5.0})), (std::vector<double>{4, 5, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(doubles(session.force_reply(Eigen::Vector2d{-4.0, 0.0})), (std::vector<double>{-4, 0, 0, 0, 0, 0, 0, 0}));
}

TEST(GenericClientSession, RepeatedQuestionsAllReachThePort) {
  const Heard heard = hear(sizes(1) + trial(1, 0.1) + message(10.0) + message(10.0) + message(10.0));
  EXPECT_EQ(heard.requests.size(), 5U);
}

TEST(GenericClientSession, AnyPortionsMeanTheSame) {
  const ElementMatrices matrices = matrices_of(2);
  const int data_size = 16;
  Bytes bytes = sizes(2, data_size) + trial(2, 0.1, 0.2, 0.3, 0.4, data_size);
  for (const double action : {13.0, 10.0, 5.0, 99.0}) bytes = bytes + message(action, data_size, 8.0);
  for (std::size_t portion = 1; portion <= bytes.size(); ++portion) {
    const Heard heard = hear(matrices, bytes, portion);
    ASSERT_EQ(heard.requests.size(), 5U) << portion;
    ASSERT_EQ(heard.requests[1].displacement_m, Eigen::Vector2d(0.1, 0.1)) << portion;
    ASSERT_EQ(heard.requests[1].time_s, 0.4) << portion;
    ASSERT_EQ(heard.requests[4].kind, Kind::die) << portion;
    ASSERT_EQ(heard.replies.size(), 1U) << portion;
  }
}

TEST(GenericClientSession, CutMessageIsNoRequest) {
  const ElementMatrices matrices = matrices_of(1);
  const Bytes whole = sizes(1, 5) + trial(1, 0.1, 0.0, 0.0, 0.0, 5);
  for (std::size_t cut = 0; cut < whole.size(); ++cut) {
    const Bytes bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(cut));
    const Heard heard = hear(matrices, bytes, 7);
    ASSERT_EQ(heard.requests.size(), cut < 44 ? 0U : 1U) << cut;
    ASSERT_EQ(heard.fault, ClientFault::unknown) << cut;
  }
}

TEST(GenericClientSession, AnyDataSizeThatIsLargeEnoughServes) {
  for (const std::int32_t data_size : {11, 12, 255, 1141, 100'000}) {  // 3 degrees of freedom need 11
    const Heard heard =
        hear(sizes(3, data_size) + trial(3, 0.1, 0.2, 0.3, 0.4, data_size) + message(99.0, data_size), 3);
    ASSERT_EQ(heard.requests.size(), 3U) << data_size;
    EXPECT_EQ(heard.requests[1].time_s, 0.4);
  }
  EXPECT_EQ(hear(sizes(3, 10), 3).fault, ClientFault::short_messages);
  EXPECT_EQ(hear(sizes(6, 35), 6).fault, ClientFault::short_messages) << "a matrix needs 36";
}

TEST(GenericClientSession, RefusesAnElementOfAnotherSize) {
  EXPECT_EQ(hear(sizes(2), 1).fault, ClientFault::other_size);
  EXPECT_EQ(hear(sizes(1), 6).fault, ClientFault::other_size);
}

TEST(GenericClientSession, RefusesEachChangedSizeOfTheProtocol) {
  for (std::size_t slot = 0; slot < 10; ++slot) {
    for (const std::int32_t wrong : {2, 7, -1, std::numeric_limits<std::int32_t>::max()}) {
      std::array<std::int32_t, 11> values{1, 1, 1, 0, 1, 0, 0, 0, 1, 0, kDataSize};
      values[slot] = wrong;
      EXPECT_EQ(hear(sizes(values)).fault, ClientFault::other_protocol) << "slot " << slot << ": " << wrong;
    }
  }
}

TEST(GenericClientSession, RefusesHugeAndNegativeMessages) {
  for (const std::int32_t huge : {1 << 30, std::numeric_limits<std::int32_t>::max()}) {
    EXPECT_EQ(hear(sizes(1, huge)).fault, ClientFault::other_protocol) << huge;
  }
  for (const std::int32_t small : {0, -1, std::numeric_limits<std::int32_t>::min()}) {
    EXPECT_EQ(hear(sizes(1, small)).fault, ClientFault::short_messages) << small;
  }
}

TEST(GenericClientSession, RefusesHttpAndBigEndianSizes) {
  const std::string text = "GET / HTTP/1.1\r\nHost: 127.0.0.1:8090\r\nAccept: */*\r\n\r\n";
  Bytes bytes(text.size());
  std::memcpy(bytes.data(), text.data(), text.size());
  EXPECT_EQ(hear(bytes).fault, ClientFault::other_protocol);
  EXPECT_EQ(hear(sizes({1 << 24, 1 << 24, 1 << 24, 0, 1 << 24, 0, 0, 0, 1 << 24, 0, 1 << 16})).fault,
            ClientFault::other_protocol);
}

TEST(GenericClientSession, RefusesActionsThatTheProtocolHasNot) {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double action : {0.0, 1.0, 2.0, 4.0, 6.0, 11.0, 16.0, 98.0, 100.0, 255.0, 259.0, -3.0, 3.5, 1e300,
                              infinity, -infinity, std::numeric_limits<double>::quiet_NaN()}) {
    const Heard heard = hear(sizes(1) + message(action) + message(99.0));
    EXPECT_EQ(heard.fault, ClientFault::other_message) << action;
    EXPECT_EQ(heard.requests.size(), 1U) << action << ": nothing after it is read";
  }
}

TEST(GenericClientSession, TrialThatIsNotFiniteIsAFault) {
  for (std::size_t slot = 1; slot <= 4; ++slot) {
    std::vector<double> values{3.0, 0.1, 0.2, 0.3, 0.4};
    EXPECT_EQ(hear(sizes(1) + message(values)).fault, ClientFault::unknown);
    values[slot] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(hear(sizes(1) + message(values)).fault, ClientFault::not_finite) << slot;
    values[slot] = std::numeric_limits<double>::infinity();
    EXPECT_EQ(hear(sizes(1) + message(values)).fault, ClientFault::not_finite) << slot;
  }
}

TEST(GenericClientSession, NothingIsReadAfterDie) {
  const Heard heard = hear(sizes(1) + message(99.0) + message(77.0) + trial(1, 0.1));
  EXPECT_EQ(heard.requests.size(), 2U);
  EXPECT_EQ(heard.fault, ClientFault::unknown);
}

TEST(GenericClientSession, EveryFaultIsDescribed) {
  for (const ClientFault fault :
       {ClientFault::closed, ClientFault::address, ClientFault::occupied, ClientFault::other_protocol,
        ClientFault::other_size, ClientFault::short_messages, ClientFault::other_message, ClientFault::not_finite}) {
    EXPECT_NE(describe(fault), describe(ClientFault::unknown)) << static_cast<int>(fault);
  }
}

TEST(GenericClientSession, FaultTellsWhatTheClientSent) {
  const std::vector<std::pair<Bytes, std::string>> sent{
      {sizes(3), "it has 3"}, {sizes(1, 4), "they have 4 doubles"}, {sizes(1) + message(77.0), "with the action 77"}};
  const ElementMatrices matrices = matrices_of(1);
  for (const auto& [bytes, expected] : sent) {
    GenericClientSession session{matrices};
    std::span<const std::byte> arrived{bytes};
    ElementRequest request;
    while (session.take(arrived, request) != Outcome::fault) ASSERT_FALSE(arrived.empty()) << expected;
    const std::string text = describe(session.fault(), session.given());
    EXPECT_NE(text.find(expected), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace hybridtest
