#include "report/live/watch_server.hpp"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <thread>

#include "core/config_error.hpp"
#include "report/live/http_library.hpp"
#include "report/live/test_view.hpp"

/// The web server of the live view over real sockets, without a network of participants behind it.
namespace hybridtest {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

constexpr const char* kToken = "0123456789abcdef";
constexpr const char* kJson = "application/json";

/// A test named `frame` with one event, and what was requested of it.
class OneTest final : public LiveSource {
 public:
  OneTest() {
    Event event;
    event.source = "coordinator";
    event.code = EventCode::test_started;
    view_.learn(event, Instant{}, "2026-01-01T00:00:00Z");
    SignalBlock block;
    block.participant = "site";
    block.group = "control";
    block.model_time_s = {0.5};
    block.signals.push_back({"force", "dof", "N", 10.0, {-1.5}, {2.5}, {0.5}});
    view_.learn(block, Instant{});
  }

  [[nodiscard]] json tests(Instant now) const override { return json::array({view_.entry(now)}); }
  [[nodiscard]] std::optional<LiveAnswer> news(std::string_view test, std::uint64_t since, Instant now) const override {
    if (test != "frame") return std::nullopt;
    return view_.news(since, now);
  }
  [[nodiscard]] std::optional<LiveAnswer> whole(std::string_view test) const override {
    if (test != "frame") return std::nullopt;
    return view_.whole();
  }
  bool request(std::string_view test, ControlVerb verb, Instant) override {
    if (test != "frame") return false;
    const std::lock_guard lock{mutex_};
    requests_.push_back(verb);
    return true;
  }
  [[nodiscard]] std::vector<ControlVerb> requests() const {
    const std::lock_guard lock{mutex_};
    return requests_;
  }

 private:
  TestView view_{"frame", 7};
  mutable std::mutex mutex_;
  std::vector<ControlVerb> requests_;
};

class WatchServerTest : public testing::Test {
 protected:
  static WatchServerSettings with_token() {
    WatchServerSettings settings;
    settings.token = kToken;
    settings.run_directory = testing::TempDir() + "watch_server_" + std::to_string(getpid());
    return settings;
  }
  [[nodiscard]] httplib::Result get(const std::string& path, const httplib::Headers& headers = {}) {
    return client().Get(path, headers);
  }
  [[nodiscard]] int control(const std::string& body, httplib::Headers headers, const std::string& test = "frame",
                            const char* type = kJson) {
    const auto result = client().Post("/api/tests/" + test + "/control", headers, body, type);
    return result ? result->status : 0;
  }
  static httplib::Headers bearer(const std::string& token = kToken) { return {{"Authorization", "Bearer " + token}}; }
  [[nodiscard]] httplib::Client client() const {
    httplib::Client client{"127.0.0.1", server.port()};
    client.set_read_timeout(20);
    return client;
  }
  /// A bare connection on which these bytes were sent.
  [[nodiscard]] int send_bytes(const std::string& bytes) const {
    const int connection = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(server.port()));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(connect(connection, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(send(connection, bytes.data(), bytes.size(), MSG_NOSIGNAL), static_cast<ssize_t>(bytes.size()));
    return connection;
  }
  /// All that comes until the server closes the connection.
  static std::string rest_of(int connection) {
    std::string text;
    std::array<char, 4096> bytes{};
    for (ssize_t size = 1; size > 0;) {
      size = recv(connection, bytes.data(), bytes.size(), 0);
      if (size > 0) text.append(bytes.data(), static_cast<std::size_t>(size));
    }
    close(connection);
    return text;
  }

  explicit WatchServerTest(const WatchServerSettings& settings = with_token()) : server{source, clock, settings} {}

  OneTest source;
  ProcessClock clock;
  WatchServer server;
};

/// A server that waits for nobody for long.
class WatchServerLimits : public WatchServerTest {
 protected:
  WatchServerLimits() : WatchServerTest{impatient()} {}

  static WatchServerSettings impatient() {
    WatchServerSettings settings = with_token();
    settings.patience = std::chrono::milliseconds{500};
    return settings;
  }
  /// Far above what it waits, far below for ever.
  static constexpr double kLong_s = 5.0;
};

TEST_F(WatchServerTest, ServesThePageAndItsFiles) {
  const auto page = get("/");
  ASSERT_TRUE(page);
  EXPECT_EQ(page->status, 200);
  EXPECT_THAT(page->get_header_value("Content-Type"), HasSubstr("text/html"));
  EXPECT_THAT(page->body, HasSubstr("<html"));
  EXPECT_THAT(page->get_header_value("Content-Security-Policy"), HasSubstr("default-src 'none'"));
  EXPECT_EQ(page->get_header_value("X-Content-Type-Options"), "nosniff");
  EXPECT_EQ(page->get_header_value("Cache-Control"), "no-store");
  const auto script = get("/assets/main.js");
  ASSERT_TRUE(script);
  EXPECT_EQ(script->status, 200);
  EXPECT_THAT(script->get_header_value("Content-Type"), HasSubstr("text/javascript"));
  EXPECT_EQ(get("/assets/nothing.js")->status, 404);
  EXPECT_EQ(get("/assets/..%2f..%2fCMakeLists.txt")->status, 404);
}

TEST_F(WatchServerTest, AnswersWithTheValuesOfTheTest) {
  const json tests = json::parse(get("/api/tests")->body);
  EXPECT_EQ(tests["control"], true);
  EXPECT_EQ(tests["tests"][0]["name"], "frame");
  const json news = json::parse(get("/api/tests/frame?since=0")->body);
  EXPECT_EQ(news["reset"], true);
  EXPECT_EQ(news["events"][0]["text"], "test started");
  const json signal = news["signals"][0];
  EXPECT_EQ(signal["t"], json({0.5}));
  EXPECT_EQ(signal["least"], json({-1.5}));
  EXPECT_EQ(signal["most"], json({2.5}));
  EXPECT_EQ(signal["last"], json({0.5}));
  EXPECT_EQ(signal["limit"], 10.0);
  const std::string cursor = news["cursor"].dump();
  EXPECT_THAT(json::parse(get("/api/tests/frame?since=" + cursor)->body)["signals"], IsEmpty());
  EXPECT_THAT(json::parse(get("/api/tests/frame/whole")->body)["signals"], SizeIs(1));
}

TEST_F(WatchServerTest, RefusesWhatItDoesNotKnow) {
  EXPECT_EQ(get("/api/tests/other")->status, 404);
  EXPECT_EQ(get("/api/tests/other/whole")->status, 404);
  EXPECT_EQ(get("/api/tests/frame?since=x")->status, 400);
  EXPECT_EQ(get("/api/tests/frame?since=-1")->status, 400);
  EXPECT_EQ(get("/elsewhere")->status, 404);
}

TEST_F(WatchServerTest, TakesRequestsOfWhoeverHasTheToken) {
  for (const char* verb : {"pause", "resume", "stop", "emergency_stop"}) {
    EXPECT_EQ(control(json{{"verb", verb}}.dump(), bearer()), 202) << verb;
  }
  EXPECT_THAT(source.requests(),
              ElementsAre(ControlVerb::pause, ControlVerb::resume, ControlVerb::stop, ControlVerb::emergency_stop));
}

TEST_F(WatchServerTest, NothingChangesWithoutTheToken) {
  const std::string stop = R"({"verb":"stop"})";
  EXPECT_EQ(control(stop, {}), 401);
  EXPECT_EQ(control(stop, bearer("")), 401);
  EXPECT_EQ(control(stop, bearer("0123456789abcdeX")), 401);
  EXPECT_EQ(control(stop, bearer(std::string{kToken} + "0")), 401);
  EXPECT_EQ(control(stop, {{"Authorization", std::string{"Basic "} + kToken}}), 401);
  EXPECT_EQ(client().Get("/api/tests/frame/control", bearer())->status, 404);
  EXPECT_THAT(source.requests(), IsEmpty());
}

TEST_F(WatchServerTest, NothingChangesForOtherOriginsAndHosts) {
  const std::string stop = R"({"verb":"stop"})";
  const std::string here = "http://127.0.0.1:" + std::to_string(server.port());
  const auto with = [](const std::string& name, const std::string& value) {
    httplib::Headers headers = bearer();
    headers.emplace(name, value);
    return headers;
  };
  EXPECT_EQ(control(stop, with("Origin", "http://evil.example")), 403);
  EXPECT_EQ(control(stop, with("Origin", "null")), 403);
  EXPECT_EQ(control(stop, with("Origin", "http://127.0.0.1:1")), 403);
  EXPECT_EQ(control(stop, with("Host", "evil.example")), 403);
  EXPECT_EQ(control(stop, with("Host", "127.0.0.1.evil.example")), 403);
  EXPECT_EQ(get("/api/tests", {{"Host", "evil.example"}})->status, 403);
  EXPECT_EQ(get("/", {{"Host", "evil.example:" + std::to_string(server.port())}})->status, 403);
  EXPECT_THAT(source.requests(), IsEmpty());
  EXPECT_EQ(control(stop, with("Origin", here)), 202);  // control
  EXPECT_EQ(get("/api/tests", {{"Host", "localhost:9999"}})->status, 200);
}

TEST_F(WatchServerTest, RefusesBodiesThatAreNoRequest) {
  EXPECT_EQ(control("", bearer()), 400);
  EXPECT_EQ(control("stop", bearer()), 400);
  EXPECT_EQ(control(R"({"verb":"start"})", bearer()), 400);
  EXPECT_EQ(control(R"({"verb":7})", bearer()), 400);
  EXPECT_EQ(control(R"(["stop"])", bearer()), 400);
  EXPECT_EQ(control(R"({"verb":"stop"})", bearer(), "frame", "text/plain"), 400);
  EXPECT_EQ(control(R"({"verb":"stop"})", bearer(), "other"), 404);
  EXPECT_EQ(control(std::string(100'000, ' ') + R"({"verb":"stop"})", bearer()), 413);
  EXPECT_THAT(source.requests(), IsEmpty());
}

TEST_F(WatchServerTest, ServerWithoutATokenTakesNoRequests) {
  const WatchServer watching{source, clock, {}};
  EXPECT_NE(watching.port(), server.port());
  EXPECT_EQ(watching.url(), "http://127.0.0.1:" + std::to_string(watching.port()) + "/");
  httplib::Client other{"127.0.0.1", watching.port()};
  EXPECT_EQ(json::parse(other.Get("/api/tests")->body)["control"], false);
  EXPECT_EQ(other.Post("/api/tests/frame/control", bearer(""), R"({"verb":"stop"})", kJson)->status, 403);
  EXPECT_EQ(other.Post("/api/tests/frame/control", bearer(), R"({"verb":"stop"})", kJson)->status, 403);
  EXPECT_THAT(source.requests(), IsEmpty());
}

TEST_F(WatchServerTest, RefusesAPortThatIsTaken) {
  WatchServerSettings settings;
  settings.port = server.port();
  EXPECT_THROW((WatchServer{source, clock, settings}), ConfigError);
}

TEST_F(WatchServerTest, ServesTheReportOfTheRunWhenThereIsOne) {
  EXPECT_EQ(get("/report")->status, 404);
  EXPECT_EQ(json::parse(get("/api/tests/frame")->body)["test"]["has_report"], false);
  const auto directory = with_token().run_directory;
  std::filesystem::create_directories(directory);
  std::ofstream{directory / "report.html"} << "<p>report</p>";
  const auto report = get("/report");
  EXPECT_EQ(report->status, 200);
  EXPECT_EQ(report->body, "<p>report</p>");
  // Its scripts cannot ask this server.
  EXPECT_EQ(report->get_header_value_count("Content-Security-Policy"), 1U);
  EXPECT_THAT(report->get_header_value("Content-Security-Policy"), HasSubstr("sandbox"));
  EXPECT_EQ(json::parse(get("/api/tests/frame")->body)["test"]["has_report"], true);
  std::filesystem::remove_all(directory);
}

TEST_F(WatchServerTest, OneConnectionAsksManyTimes) {
  httplib::Client page = client();
  page.set_keep_alive(true);
  for (int i = 0; i < 200; ++i) {
    const auto answer = page.Get("/api/tests/frame?since=0");
    ASSERT_TRUE(answer) << i;
    ASSERT_EQ(answer->status, 200);
    ASSERT_NE(answer->get_header_value("Connection"), "close") << i;
  }
}

TEST_F(WatchServerLimits, HalfRequestsAndSlowClientsHoldUpNobody) {
  std::vector<int> slow;
  for (int i = 0; i < 20; ++i) {
    slow.push_back(send_bytes("GET /api/tests HTTP/1.1\r\nHost: 127"));
    slow.push_back(
        send_bytes("POST /api/tests/frame/control HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 400\r\n\r\n{"));
  }
  const Instant asked = clock.now();
  EXPECT_EQ(get("/api/tests")->status, 200);
  EXPECT_EQ(control(R"({"verb":"emergency_stop"})", bearer()), 202);
  EXPECT_LT(to_seconds(clock.now() - asked), 2.0);
  // They are ended.
  for (const int connection : slow) EXPECT_THAT(rest_of(connection), Not(HasSubstr("200 OK")));
  EXPECT_LT(to_seconds(clock.now() - asked), kLong_s);
}

TEST_F(WatchServerLimits, BytesThatComeOneByOneMeetTheSameLimit) {
  const int connection = send_bytes("GET / HTTP/1.1\r\n");
  std::atomic<bool> is_ended{false};
  std::thread drip{[&] {
    pollfd closed{.fd = connection, .events = 0, .revents = 0};
    while (!is_ended && send(connection, "X", 1, MSG_NOSIGNAL) == 1) static_cast<void>(poll(&closed, 1, 100));
  }};
  const Instant begun = clock.now();
  const std::string answer = rest_of(connection);
  is_ended = true;
  drip.join();
  EXPECT_THAT(answer, Not(HasSubstr("200 OK")));
  EXPECT_LT(to_seconds(clock.now() - begun), kLong_s);
}

TEST_F(WatchServerLimits, RefusesRequestsThatAreTooLarge) {
  const std::string endless = "GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n" + std::string(300'000, 'x');
  const int connection = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(server.port()));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  ASSERT_EQ(connect(connection, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  static_cast<void>(!send(connection, endless.data(), endless.size(), MSG_NOSIGNAL));
  EXPECT_THAT(rest_of(connection), Not(HasSubstr("200 OK")));
  EXPECT_EQ(get("/api/tests")->status, 200);  // the next one is served
}

TEST_F(WatchServerLimits, ConnectionsBeyondTheLimitAreClosed) {
  std::vector<int> idle;
  for (int i = 0; i < 100; ++i) idle.push_back(send_bytes("GET"));
  // The first ones hold all places until their time is over.
  EXPECT_THAT(rest_of(idle.back()), IsEmpty());
  idle.pop_back();
  for (const int connection : idle) static_cast<void>(rest_of(connection));
  EXPECT_EQ(get("/api/tests")->status, 200);
}

TEST_F(WatchServerLimits, BytesOfAnyKindAreRefusedInOrder) {
  for (const std::string& bytes :
       {std::string("\0\0\0\0\r\n\r\n", 8), std::string("GET / HTTP/9.9\r\n\r\n"), std::string("GET  \r\n\r\n"),
        std::string("POST / HTTP/1.1\r\nContent-Length: -5\r\n\r\n"),
        std::string("GET /%zz%00 HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n"),
        std::string("GET / HTTP/1.1\r\nHost:\r\nConnection: close\r\n\r\n")}) {
    const int connection = send_bytes(bytes);
    shutdown(connection, SHUT_WR);
    EXPECT_THAT(rest_of(connection), Not(HasSubstr("200 OK"))) << bytes;
  }
  EXPECT_EQ(get("/api/tests")->status, 200);
}

TEST(WatchToken, IsLongAndNeverTheSame) {
  const std::string token = draw_token();
  EXPECT_EQ(token.size(), 64U);
  EXPECT_EQ(token.find_first_not_of("0123456789abcdef"), std::string::npos);
  EXPECT_NE(token, draw_token());
}

}  // namespace
}  // namespace hybridtest
