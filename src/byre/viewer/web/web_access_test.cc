#include "byre/viewer/web/web_access.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

TEST(WebAccess, AcceptsLoopbackNamesOnAnyPort) {
  const WebAccess access = access_to("127.0.0.1");
  for (const char* host : {"localhost", "localhost:8017", "127.0.0.1:9000", "[::1]:8017"}) {
    EXPECT_THAT(rejection_reason(access, {host, "", "/"}), IsEmpty()) << host;
  }
  for (const char* host : {"", "elsewhere.example:8017", "localhost.elsewhere.example", "[::2]:8017"}) {
    EXPECT_THAT(rejection_reason(access, {host, "", "/"}), Not(IsEmpty())) << host;
  }
}

TEST(WebAccess, AcceptsOnlyTheOwnPage) {
  const WebAccess access = access_to("127.0.0.1");
  EXPECT_THAT(rejection_reason(access, {"localhost:8017", "http://localhost:8017", "/"}), IsEmpty());
  EXPECT_THAT(rejection_reason(access, {"localhost:8017", "http://localhost:8018", "/"}), Not(IsEmpty()));
  EXPECT_THAT(rejection_reason(access, {"localhost:8017", "null", "/"}), Not(IsEmpty()));
}

TEST(WebAccess, AllowsOnlyTheProtocolToFoxgloveApplications) {
  const WebAccess access = access_to("127.0.0.1");
  for (const char* page : {"", "https://app.foxglove.dev", "file://", "http://localhost:8080", "https://[::1]"}) {
    EXPECT_THAT(rejection_reason(access, {"localhost:8017", page, "/", true}), IsEmpty()) << page;
  }
  for (const char* page : {"https://elsewhere.example", "https://app.foxglove.dev.elsewhere.example", "null",
                           "http://localhost.elsewhere.example", "http://127.0.0.1.elsewhere.example"}) {
    EXPECT_THAT(rejection_reason(access, {"localhost:8017", page, "/", true}), Not(IsEmpty())) << page;
  }
  EXPECT_THAT(rejection_reason(access, {"localhost:8017", "https://app.foxglove.dev", "/", false}), Not(IsEmpty()));
}

TEST(WebAccess, RequiresTheTokenFromFoxgloveThroughTheNetwork) {
  const WebAccess access = access_to("192.0.2.7");
  const std::string with_token = "/?token=" + access.token;
  EXPECT_THAT(rejection_reason(access, {"barn.example", "https://own.example", with_token, true}), IsEmpty());
  EXPECT_THAT(rejection_reason(access, {"barn.example", "https://app.foxglove.dev", "/", true}), Not(IsEmpty()));
}

TEST(WebAccess, RequiresTheTokenThroughTheNetwork) {
  const WebAccess access = access_to("192.0.2.7");
  EXPECT_THAT(access.token, SizeIs(32));
  EXPECT_NE(access.token, access_to("192.0.2.7").token);
  EXPECT_THAT(rejection_reason(access, {"barn.example", "", "/?token=" + access.token}), IsEmpty());
  for (const std::string& wrong : {std::string(), access.token.substr(1), access.token + "0", std::string(32, '0')}) {
    EXPECT_THAT(rejection_reason(access, {"barn.example", "", "/?token=" + wrong}), Not(IsEmpty())) << wrong;
  }
}

TEST(WebAccess, SplitsATarget) {
  EXPECT_EQ(path_of("/images/7?token=abc"), "/images/7");
  EXPECT_EQ(path_of("/"), "/");
  EXPECT_EQ(query_value("/?first=1&token=abc", "token"), "abc");
  EXPECT_EQ(query_value("/?tokens=1", "token"), "");
  EXPECT_EQ(query_value("/?&&token", "token"), "");
}

}  // namespace
}  // namespace byre
