#include "byre/viewer/web_server.h"

#include "byre/input/input_error.h"
#include "byre/viewer/web_client_scene.h"

#include <atomic>
#include <stdexcept>

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

// Says back what it was asked, and counts up to a number for its listeners.
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
  WebServer serve(const std::string& address = "127.0.0.1") {
    return {{address, 0}, std::make_unique<EchoSite>(last_)};
  }

  std::atomic<int> last_ = 0;
};

TEST_F(WebServerTest, HandsRequestsToTheSite) {
  const WebServer server = serve();
  const WebClient client(server.port());
  EXPECT_EQ(server.url(), "http://127.0.0.1:" + std::to_string(server.port()) + "/");
  EXPECT_EQ(client.get("/page?a=b").body, "get /page ");
  EXPECT_EQ(client.post("/picks", "[1]").body, "post /picks [1]");
}

TEST_F(WebServerTest, TurnsExceptionsIntoAnswers) {
  const WebServer server = serve();
  const WebClient client(server.port());
  EXPECT_EQ(client.get("/bad").status, 400);
  EXPECT_EQ(client.get("/bad").json().at("problem"), "the input: is bad");
  EXPECT_EQ(client.get("/broken").status, 500);
  EXPECT_EQ(client.get("/broken").json().at("problem"), "it broke");
  EXPECT_EQ(client.ask("DELETE", "/", "", {}).status, 405);
}

TEST_F(WebServerTest, RefusesOtherNamesAndOtherPages) {
  const WebServer server = serve();
  const WebClient client(server.port());
  EXPECT_EQ(client.get("/", {{"Host", "elsewhere.example"}}).status, 403);
  EXPECT_EQ(client.get("/", {{"Origin", "http://elsewhere.example"}}).status, 403);
  EXPECT_THROW(LiveClient(server.port(), "/another"), boost::system::system_error);
}

TEST_F(WebServerTest, AsksForTheTokenOnceItIsOpenToTheNetwork) {
  const WebServer server = serve("0.0.0.0");
  const WebClient client(server.port());
  const std::string page = "http://127.0.0.1:" + std::to_string(server.port());
  ASSERT_THAT(server.url(), StartsWith(page + "/?token="));
  const std::string target = server.url().substr(page.size());
  EXPECT_EQ(client.get(target).status, 200);
  EXPECT_EQ(client.get("/").status, 403);
  EXPECT_EQ(client.get(target + "0").status, 403);
  EXPECT_THROW(LiveClient(server.port(), "/live"), boost::system::system_error);
  EXPECT_NO_THROW(LiveClient(server.port(), "/live" + target.substr(1)));
}

TEST_F(WebServerTest, TellsListenersWhatIsNewWhenItIsWoken) {
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

TEST_F(WebServerTest, EndsWithListenersOpen) {
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

TEST_F(WebServerTest, SaysWhatIsWrongWithAnAddressOrPort) {
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
  EXPECT_THAT(serve_at("barn", 0), HasSubstr("is no IP address"));
  EXPECT_THAT(serve_at("192.0.2.1", 0), HasSubstr("cannot be listened on"));
}

}  // namespace
}  // namespace byre
