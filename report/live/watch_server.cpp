#include "report/live/watch_server.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/random.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <thread>

#include "core/config_error.hpp"
#include "core/embedded_file.hpp"
#include "report/live/connection.hpp"
#include "report/live/http_library.hpp"

namespace hybridtest {

namespace embedded {
std::span<const EmbeddedFile> live_page();
}

namespace {

/// A browser opens up to six connections while it loads a page, and polls on one.
constexpr int kConnections = 64;
/// From here on a connection is closed after each answer, so that everyone gets a turn.
constexpr int kCrowded = 48;
constexpr std::size_t kBodyBytes = 4096;
/// Told to browsers; a page that polls for ten hours.
constexpr std::size_t kRequestsOfConnection = 1'000'000;
constexpr int kNextPorts = 20;
/// Of the threads that write answers: tests on this machine come first.
constexpr int kNice = 10;

constexpr const char* kJson = "application/json";
/// The page loads nothing from elsewhere and runs nothing that is not a file of ours.
constexpr const char* kPagePolicy =
    "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
/// A report is one file; its scripts have an origin of their own and cannot ask this server for anything.
constexpr const char* kReportPolicy =
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'; sandbox allow-scripts allow-downloads allow-popups";

std::string_view type_of(std::string_view file) {
  const std::string_view ending = file.substr(std::min(file.rfind('.'), file.size()));
  if (ending == ".html") return "text/html; charset=utf-8";
  if (ending == ".css") return "text/css; charset=utf-8";
  if (ending == ".js" || ending == ".mjs") return "text/javascript; charset=utf-8";
  if (ending == ".svg") return "image/svg+xml";
  if (ending == ".json" || ending == ".webmanifest") return kJson;
  return "application/octet-stream";
}

/// The same time for every text of the same length.
bool is_same_secret(std::string_view a, std::string_view b) noexcept {
  if (a.size() != b.size()) return false;
  unsigned differences = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    differences |= static_cast<unsigned>(static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]));
  }
  return differences == 0;
}

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return text;
}

/// `name` of `name:port`, `[::1]` of `[::1]:port`.
std::string without_port(const std::string& host) {
  const std::size_t colon = host.rfind(':');
  if (colon == std::string::npos || (host.front() == '[' && host.back() == ']')) return host;
  return host.substr(0, colon);
}

/// A name that a foreign web site made point here ("DNS rebinding") is refused; an address, and the name of this host,
/// cannot be made so. The port may differ: that of a tunnel.
bool is_ours(const std::string& host) {
  if (host.empty()) return false;
  const std::string name = lower(without_port(host));
  if (name == "localhost" || (name.front() == '[' && name.back() == ']')) return true;
  in_addr address{};
  if (inet_pton(AF_INET, name.c_str(), &address) == 1) return true;
  std::array<char, 256> own{};
  return gethostname(own.data(), own.size() - 1) == 0 && lower(own.data()) == name;
}

std::string error_text(std::string_view what) { return to_text(nlohmann::json{{"error", what}}); }

void refuse(httplib::Response& response, int status, std::string_view what) {
  response.status = status;
  response.set_content(error_text(what), kJson);
}

std::optional<ControlVerb> verb_of(const std::string& body) {
  const nlohmann::json request = nlohmann::json::parse(body, nullptr, false);
  if (!request.is_object() || request.size() != 1 || !request.contains("verb")) return std::nullopt;
  if (!request["verb"].is_string()) return std::nullopt;
  const std::string verb = request["verb"];
  if (verb == "pause") return ControlVerb::pause;
  if (verb == "resume") return ControlVerb::resume;
  if (verb == "stop") return ControlVerb::stop;
  if (verb == "emergency_stop") return ControlVerb::emergency_stop;
  return std::nullopt;
}

/// A number of connections, each with a thread. Those beyond it are closed at once.
class LimitedPool final : public httplib::TaskQueue {
 public:
  explicit LimitedPool(std::atomic<int>& connections) : connections_{connections}, pool_{kConnections} {}

  /// Set in the thread that accepts connections, while it passes on one too many.
  static thread_local bool is_full;

  void enqueue(std::function<void()> serve) override {
    if (connections_.load() >= kConnections) {
      is_full = true;
      serve();  // closes it
      is_full = false;
      return;
    }
    connections_.fetch_add(1);
    pool_.enqueue([this, serve = std::move(serve)] {
      serve();
      connections_.fetch_sub(1);
    });
  }
  void shutdown() override { pool_.shutdown(); }

 private:
  std::atomic<int>& connections_;
  httplib::ThreadPool pool_;
};

thread_local bool LimitedPool::is_full = false;

}  // namespace

std::string draw_token() {
  std::array<unsigned char, 32> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
    throw std::runtime_error{"no random numbers from the operating system"};
  }
  std::string token;
  for (const unsigned char byte : bytes) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    token += kDigits[byte >> 4U];
    token += kDigits[byte & 15U];
  }
  return token;
}

class WatchServer::Implementation final : public httplib::Server {
 public:
  Implementation(LiveSource& source, const ProcessClock& clock, WatchServerSettings settings)
      : source_{source}, clock_{clock}, settings_{std::move(settings)}, last_asked_{clock.now()} {
    new_task_queue = [this] { return new LimitedPool{connections_}; };  // owned by the server
    // The library's own choice lets two processes listen on one port.
    set_socket_options([](socket_t socket) {
      const int yes = 1;
      setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    set_tcp_nodelay(true);
    set_payload_max_length(kBodyBytes);
    set_keep_alive_max_count(kRequestsOfConnection);
    add_routes();
    bind();
    thread_ = std::thread{[this] { listen_after_bind(); }};
    // stop() has no effect before.
    wait_while([this] { return !is_running(); });
  }
  ~Implementation() override {
    stop();
    thread_.join();
  }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  [[nodiscard]] int port() const noexcept { return port_; }
  [[nodiscard]] const WatchServerSettings& settings() const noexcept { return settings_; }
  [[nodiscard]] Instant last_asked() const noexcept { return last_asked_.load(); }

 private:
  void bind() {
    const bool is_chosen = settings_.port != 0;
    const int first = is_chosen ? settings_.port : kWatchPort;
    for (port_ = first; port_ < first + (is_chosen ? 1 : kNextPorts); ++port_) {
      if (!bind_to_port(settings_.address, port_)) continue;
      // The library lets five connections wait, and a sixth one a second: less than one browser opens.
      ::listen(svr_sock_, kConnections);
      return;
    }
    throw ConfigError{"cannot listen on " + settings_.address + ", port " + std::to_string(first) +
                      (is_chosen ? "" : " to " + std::to_string(port_ - 1)) +
                      ": taken, or not an address of this machine; choose another --port or --address"};
  }

  bool process_and_close_socket(socket_t socket) override {
    Connection connection{socket, clock_};
    if (LimitedPool::is_full) return false;
    static thread_local const int priority_is_low = setpriority(PRIO_PROCESS, 0, kNice);
    static_cast<void>(priority_is_low);
    const auto is_stopping = [this] { return svr_sock_ == INVALID_SOCKET; };
    bool is_closed = false;
    while (!is_closed && connection.waits_for_request(settings_.patience, is_stopping)) {
      connection.begin_request(settings_.patience);
      const bool is_last = connections_.load() >= kCrowded;
      // Answers come often and are small: compressing them would cost more than it saves.
      const auto uncompressed = [](httplib::Request& request) { request.headers.erase("Accept-Encoding"); };
      if (!process_request(connection, is_last, is_closed, uncompressed)) return false;
      is_closed = is_closed || is_last || connection.is_exhausted();
    }
    return true;
  }

  void add_routes() {
    set_pre_routing_handler([](const httplib::Request& request, httplib::Response& response) {
      const std::string host = request.get_header_value("Host");
      if (!is_ours(host)) {
        refuse(response, 403, "this server is asked under a name that is not its own; use its address");
        return HandlerResponse::Handled;
      }
      if (request.has_header("Origin") && lower(request.get_header_value("Origin")) != "http://" + lower(host)) {
        refuse(response, 403, "a page of another origin asked");
        return HandlerResponse::Handled;
      }
      return HandlerResponse::Unhandled;
    });
    set_post_routing_handler([](const httplib::Request&, httplib::Response& response) {
      if (!response.has_header("Content-Security-Policy")) {
        response.set_header("Content-Security-Policy", kPagePolicy);
      }
      response.set_header("X-Content-Type-Options", "nosniff");
      response.set_header("Referrer-Policy", "no-referrer");
      response.set_header("Cross-Origin-Resource-Policy", "same-origin");
      response.set_header("Cache-Control", "no-store");
    });
    set_exception_handler([](const httplib::Request&, httplib::Response& response, const std::exception_ptr&) {
      refuse(response, 500, "internal error");
    });
    Get("/", [this](const httplib::Request&, httplib::Response& response) { serve_file("index.html", response); });
    Get("/assets/([^/]+)", [this](const httplib::Request& request, httplib::Response& response) {
      serve_file(request.matches[1].str(), response);
    });
    Get("/report", [this](const httplib::Request&, httplib::Response& response) { serve_report(response); });
    Get("/api/tests", [this](const httplib::Request&, httplib::Response& response) {
      note_asked();
      response.set_content(
          to_text(nlohmann::json{{"tests", source_.tests(clock_.now())}, {"control", !settings_.token.empty()}}),
          kJson);
    });
    Get("/api/tests/([^/]+)", [this](const httplib::Request& request, httplib::Response& response) {
      note_asked();
      serve_news(request, response);
    });
    Get("/api/tests/([^/]+)/whole", [this](const httplib::Request& request, httplib::Response& response) {
      note_asked();
      const auto answer = source_.whole(request.matches[1].str());
      if (!answer) return refuse(response, 404, "no test of this name");
      response.set_content(to_text(*answer), kJson);
    });
    Post("/api/tests/([^/]+)/control", [this](const httplib::Request& request, httplib::Response& response) {
      note_asked();
      take_request(request, response);
    });
  }

  void note_asked() const { last_asked_.store(clock_.now()); }

  static void serve_file(const std::string& name, httplib::Response& response) {
    const auto files = embedded::live_page();
    const auto file = std::ranges::find(files, name, &EmbeddedFile::name);
    if (file == files.end()) return refuse(response, 404, "no such file");
    response.set_content(file->content.data(), file->content.size(), std::string{type_of(name)});
  }

  [[nodiscard]] std::filesystem::path report() const {
    return settings_.run_directory.empty() ? std::filesystem::path{} : settings_.run_directory / "report.html";
  }
  [[nodiscard]] bool has_report() const {
    std::error_code error;
    return !report().empty() && std::filesystem::is_regular_file(report(), error);
  }
  void serve_report(httplib::Response& response) const {
    note_asked();
    std::ifstream file{report(), std::ios::binary};
    if (!has_report() || !file) return refuse(response, 404, "there is no report of this run yet");
    const std::string text{std::istreambuf_iterator<char>{file}, {}};
    response.set_header("Content-Security-Policy", kReportPolicy);
    response.set_content(text, "text/html; charset=utf-8");
  }

  void serve_news(const httplib::Request& request, httplib::Response& response) const {
    std::uint64_t since = 0;
    const std::string text = request.get_param_value("since");
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), since);
    if (!text.empty() && (error != std::errc{} || end != text.data() + text.size())) {
      return refuse(response, 400, "since: expected a cursor, a whole number");
    }
    auto answer = source_.news(request.matches[1].str(), since, clock_.now());
    if (!answer) return refuse(response, 404, "no test of this name");
    answer->head["test"]["has_report"] = has_report();
    response.set_content(to_text(*answer), kJson);
  }

  void take_request(const httplib::Request& request, httplib::Response& response) {
    if (settings_.token.empty()) return refuse(response, 403, "started without --allow-control");
    constexpr std::string_view kBearer = "Bearer ";
    const std::string authorization = request.get_header_value("Authorization");
    if (!authorization.starts_with(kBearer) ||
        !is_same_secret(std::string_view{authorization}.substr(kBearer.size()), settings_.token)) {
      return refuse(response, 401, "the token is missing or wrong; open the address that was printed");
    }
    const std::optional<ControlVerb> verb = verb_of(request.body);
    if (lower(request.get_header_value("Content-Type")).substr(0, 16) != kJson || !verb) {
      return refuse(response, 400, R"(expected {"verb": "pause", "resume", "stop" or "emergency_stop"})");
    }
    if (!source_.request(request.matches[1].str(), *verb, clock_.now())) {
      return refuse(response, 404, "no test of this name");
    }
    response.status = 202;
    response.set_content(R"({"sent":true})", kJson);
  }

  LiveSource& source_;
  const ProcessClock& clock_;
  const WatchServerSettings settings_;
  mutable std::atomic<Instant> last_asked_;
  std::atomic<int> connections_{0};
  int port_ = 0;
  std::thread thread_;
};

WatchServer::WatchServer(LiveSource& source, const ProcessClock& clock, const WatchServerSettings& settings)
    : implementation_{std::make_unique<Implementation>(source, clock, settings)} {}

WatchServer::~WatchServer() = default;

int WatchServer::port() const noexcept { return implementation_->port(); }

std::string WatchServer::url() const {
  const WatchServerSettings& settings = implementation_->settings();
  const bool is_any = settings.address == "0.0.0.0";
  std::string url = "http://" + (is_any ? "127.0.0.1" : settings.address) + ":" + std::to_string(port()) + "/";
  if (!settings.token.empty()) url += "#token=" + settings.token;
  return url;
}

Instant WatchServer::last_asked() const noexcept { return implementation_->last_asked(); }

}  // namespace hybridtest
