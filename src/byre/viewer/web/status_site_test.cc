#include "byre/viewer/web/status_site.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

WebRequest get(const std::string& path) {
  return {WebRequest::Method::get, path, ""};
}

TEST(StatusSite, ServesHealthAndMetrics) {
  const auto board = std::make_shared<StatusBoard>();
  StatusSite site(board);
  EXPECT_EQ(site.answer(get("/healthz")).status, 503) << "still empty";
  board->put({true, "trusted", "byre_frames_total 3\n"});
  const WebResponse health = site.answer(get("/healthz"));
  EXPECT_EQ(health.status, 200);
  EXPECT_EQ(health.body, "trusted\n");
  const WebResponse metrics = site.answer(get("/metrics"));
  EXPECT_EQ(metrics.body, "byre_frames_total 3\n");
  EXPECT_EQ(metrics.content_type, "text/plain; version=0.0.4; charset=utf-8");
  board->put({false, "untrusted: no pose", ""});
  EXPECT_EQ(site.answer(get("/healthz")).status, 503);
  EXPECT_EQ(site.answer(get("/other")).status, 404);
  EXPECT_EQ(site.answer({WebRequest::Method::post, "/metrics", ""}).status, 404);
}

TEST(StatusSite, ServesAFrontPage) {
  const auto board = std::make_shared<StatusBoard>();
  StatusSite site(board);
  EXPECT_NE(site.answer(get("/")).body.find("<p>starting</p>"), std::string::npos);
  board->put({false, "untrusted: <no pose>", "# TYPE byre_frames_total counter\nbyre_frames_total 3\nbyre_x 1\n"});
  const WebResponse page = site.answer(get("/"));
  EXPECT_EQ(page.status, 200);
  EXPECT_EQ(page.content_type, "text/html; charset=utf-8");
  EXPECT_NE(page.body.find("<p>untrusted: &lt;no pose&gt;</p>"), std::string::npos);
  EXPECT_NE(page.body.find("<pre>\nbyre_frames_total 3\nbyre_x 1\n</pre>"), std::string::npos);
  EXPECT_NE(page.body.find("<code>/healthz</code>"), std::string::npos);
}

}  // namespace
}  // namespace byre
