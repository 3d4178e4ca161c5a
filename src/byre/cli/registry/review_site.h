#pragma once

#include "byre/floor_plan.h"
#include "byre/registry/connection.h"
#include "byre/viewer/web/web_site.h"

#include <chrono>
#include <cstddef>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace byre::cli {

struct ReviewSiteOptions {
  std::string uri;                // registry, see Connection
  std::optional<FloorPlan> plan;  // shown with versions registered on it; empty: current plans of the registry
};

// Time after which the page reports a server without an answer.
inline constexpr std::chrono::seconds kPatience{5};

// Page of a registry, with the rights of one account. Paths: /sites, /sites/SITE, /sites/SITE/events,
// /sites/SITE/VERSION: JSON of listing.h; POST /sites/SITE/VERSION/accept, reject, rollback: reviews;
// /maps/SITE/VERSION/: page of the map with its changes since its parent. Its listeners get a message after each
// refresh().
class ReviewSite : public WebSite {
 public:
  // Throws as open_registry().
  explicit ReviewSite(ReviewSiteOptions options);

  WebResponse answer(const WebRequest& request) override;
  void refresh() override { ++news_; }
  std::optional<WebMessage> next_message(ListenerProgress& progress) override;

 private:
  using Parts = std::vector<std::string>;  // parts of a path

  struct MapPage {
    std::string site;
    std::string version;
    std::future<std::unique_ptr<WebSite>> pulled;
    std::unique_ptr<WebSite> page;  // null: not pulled yet
  };

  void use_connection();  // connects again if it is broken
  WebResponse answer_at(const Parts& parts, const WebRequest& request);
  WebResponse version_response(std::int64_t site, const std::string& version);
  WebResponse review(const Parts& parts, const WebRequest& request);
  WebResponse map_response(const Parts& parts);
  // Pulls the map unless it is there. The end of maps_ while too many others are being pulled.
  std::vector<MapPage>::iterator map_page(const std::string& site, const std::string& version);

  ReviewSiteOptions options_;  // constant after construction
  Connection connection_;
  bool is_broken_ = false;  // the connection is
  std::size_t news_ = 0;
  std::vector<MapPage> maps_;  // the newest last
};

}  // namespace byre::cli
