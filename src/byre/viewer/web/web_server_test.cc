#include "byre/viewer/web/web_server.h"

#include "byre/input_error.h"
#include "byre/viewer/web/web_client_scene.h"

#include <array>
#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

// Echoes requests, and counts up to a number for its listeners.
class EchoSite : public WebSite {
 public:
  explicit EchoSite(const std::atomic<int>& last) : last_(last) {}

  WebResponse answer(const WebRequest& request) override {
    if (request.path == "/bad") throw InputError("the input", "is bad");
    if (request.path == "/broken") throw std::runtime_error("it broke");
    const bool is_post = request.method == WebRequest::Method::post;
    return {200, "text/plain", (is_post ? "post " : "get ") + request.path + " " + request.body};
  }

  void refresh() override { known_ = last_; }

  std::optional<WebMessage> next_message(ListenerProgress& progress) override {
    if (static_cast<int>(progress.frames) >= known_) return std::nullopt;
    return WebMessage{std::to_string(++progress.frames), progress.frames % 2 == 0};
  }

 private:
  const std::atomic<int>& last_;
  int known_ = 0;
};

class WebServerTest : public testing::Test {
 protected:
  WebServer serve(const std::string& address = "127.0.0.1", const WebLimits& limits = {}) {
    return {{address, 0, limits}, std::make_unique<EchoSite>(last_)};
  }

  std::atomic<int> last_ = 0;
};

TEST_F(WebServerTest, PassesRequestsToTheSite) {
  const WebServer server = serve();
  const WebClient client(server.port());
  EXPECT_THAT(server.urls(), ElementsAre("http://127.0.0.1:" + std::to_string(server.port()) + "/"));
  EXPECT_EQ(client.get("/page?a=b").body, "get /page ");
  EXPECT_EQ(client.post("/picks", "[1]").body, "post /picks [1]");
}

TEST_F(WebServerTest, ConvertsExceptionsToResponses) {
  const WebServer server = serve();
  const WebClient client(server.port());
  EXPECT_EQ(client.get("/bad").status, 400);
  EXPECT_EQ(client.get("/bad").json().at("problem"), "the input: is bad");
  EXPECT_EQ(client.get("/broken").status, 500);
  EXPECT_EQ(client.get("/broken").json().at("problem"), "it broke");
  EXPECT_EQ(client.request("DELETE", "/", "", {}).status, 405);
}

TEST_F(WebServerTest, RejectsOtherNamesAndOtherPages) {
  const WebServer server = serve();
  const WebClient client(server.port());
  EXPECT_EQ(client.get("/", {{"Host", "elsewhere.example"}}).status, 403);
  EXPECT_EQ(client.get("/", {{"Origin", "http://elsewhere.example"}}).status, 403);
  EXPECT_THROW(LiveClient(server.port(), "/another"), boost::system::system_error);
}

TEST_F(WebServerTest, RequiresTheTokenWhenOpenToTheNetwork) {
  const WebServer server = serve("0.0.0.0");
  const WebClient client(server.port());
  const std::string page = "http://127.0.0.1:" + std::to_string(server.port());
  ASSERT_THAT(server.urls().back(), StartsWith(page + "/?token="));
  const std::string target = server.urls().back().substr(page.size());
  EXPECT_EQ(client.get(target).status, 200);
  EXPECT_EQ(client.get("/").status, 403);
  EXPECT_EQ(client.get(target + "0").status, 403);
  EXPECT_THROW(LiveClient(server.port(), "/live"), boost::system::system_error);
  EXPECT_NO_THROW(LiveClient(server.port(), "/live" + target.substr(1)));
}

TEST_F(WebServerTest, SendsNewsToListenersWhenWoken) {
  WebServer server = serve();
  LiveClient early(server.port());
  last_ = 2;
  server.wake();
  EXPECT_EQ(early.next().bytes, "1");
  const LiveClient::Message second = early.next();
  EXPECT_EQ(second.bytes, "2");
  EXPECT_TRUE(second.is_binary);
  LiveClient late(server.port());
  EXPECT_EQ(late.next().bytes, "1");
}

TEST_F(WebServerTest, StopsWithOpenListeners) {
  std::optional<LiveClient> listener;
  {
    WebServer server = serve();
    listener.emplace(server.port());
    last_ = 1;
    server.wake();
    EXPECT_EQ(listener->next().bytes, "1");
  }
  EXPECT_THROW(listener->next(), boost::system::system_error);
}

TEST_F(WebServerTest, ListsReachableAddresses) {
  const WebServer server = serve("0.0.0.0");
  EXPECT_THAT(server.urls(), Each(Not(HasSubstr("0.0.0.0"))));
  EXPECT_THAT(server.urls(), Each(HasSubstr(":" + std::to_string(server.port()) + "/?token=")));
  EXPECT_THAT(server.urls().back(), StartsWith("http://127.0.0.1:"));
}

// Connections without an accepted request; the test process holds their sockets.
class Crowd {
 public:
  explicit Crowd(int port) : port_(static_cast<std::uint16_t>(port)) {}

  void add(int count, const std::string& bytes) {
    for (int i = 0; i < count; ++i) {
      sockets_.push_back(WebClient::connected(context_, port_));
      boost::system::error_code ignored;
      boost::asio::write(sockets_.back(), boost::asio::buffer(bytes), ignored);
    }
  }

  // Sends one more byte of each unfinished request.
  void drip() {
    for (boost::asio::ip::tcp::socket& socket : sockets_) {
      boost::system::error_code ignored;
      socket.write_some(boost::asio::buffer("x", 1), ignored);
    }
  }

  int still_open() {
    int count = 0;
    for (boost::asio::ip::tcp::socket& socket : sockets_) {
      std::array<char, 4096> bytes{};
      boost::system::error_code error;
      socket.non_blocking(true);
      while (!error) socket.read_some(boost::asio::buffer(bytes), error);
      count += error == boost::asio::error::would_block ? 1 : 0;
    }
    return count;
  }

 private:
  std::uint16_t port_;
  boost::asio::io_context context_;
  std::vector<boost::asio::ip::tcp::socket> sockets_;
};

WebLimits impatient() {
  WebLimits limits;
  limits.request_timeout = std::chrono::milliseconds(150);
  limits.accepts_per_second = 1e4;
  limits.accept_burst = 1000;
  return limits;
}

TEST_F(WebServerTest, ClosesSlowClients) {
  const WebServer server = serve("0.0.0.0", impatient());
  Crowd crowd(server.port());
  crowd.add(2, "");
  crowd.add(2, "GET /?token=");
  for (int i = 0; i < 12 && crowd.still_open() > 0; ++i) {
    crowd.drip();
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  EXPECT_EQ(crowd.still_open(), 0) << "slow bytes do not extend the timeout";
}

TEST_F(WebServerTest, ReadsOnlyTheHeaderOfRejectedRequests) {
  const WebServer server = serve("0.0.0.0");
  Crowd crowd(server.port());
  crowd.add(1, "POST / HTTP/1.1\r\nHost: barn\r\nContent-Length: 1000000\r\n\r\n");
  for (int i = 0; i < 100 && crowd.still_open() > 0; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(crowd.still_open(), 0) << "before the body arrives or the request times out";
}

TEST_F(WebServerTest, AnswersTokenHoldersAmongHundredsOfOthers) {
  WebLimits limits = impatient();
  limits.request_timeout = std::chrono::seconds(30);
  const WebServer server = serve("0.0.0.0", limits);
  const std::string url = server.urls().back();
  const std::string target = url.substr(url.rfind('/'));
  const WebClient client(server.port());
  LiveClient listener(server.port(), "/live" + target.substr(1));
  Crowd crowd(server.port());
  for (int i = 0; i < 10; ++i) {
    crowd.add(10, "");
    crowd.add(5, "GET /?token=" + std::string(7, 'a'));
    crowd.add(5, std::string(20000, '\xff'));
    crowd.add(5, "GET /?token=wrong HTTP/1.1\r\nHost: barn\r\n\r\n");
    Crowd(server.port()).add(5, "");
    EXPECT_EQ(client.get(target).status, 200);
  }
  EXPECT_LE(crowd.still_open(), limits.pending);
}

TEST_F(WebServerTest, ReportsAnUnusableAddressOrPort) {
  const WebServer server = serve();
  const auto serve_at = [&](const std::string& address, int port) -> std::string {
    try {
      const WebServer other({address, port}, std::make_unique<EchoSite>(last_));
    } catch (const InputError& error) {
      return error.what();
    }
    return "served";
  };
  EXPECT_THAT(serve_at("127.0.0.1", server.port()), HasSubstr("is in use"));
  EXPECT_THAT(serve_at("barn", 0), HasSubstr("is not an IP address"));
  EXPECT_THAT(serve_at("192.0.2.1", 0), HasSubstr("cannot be used for listening"));
}

}  // namespace
}  // namespace byre
