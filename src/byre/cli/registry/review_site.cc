#include "byre/cli/registry/review_site.h"

#include "byre/cli/registry/command.h"
#include "byre/cli/shared/progress.h"
#include "byre/cli/shared/view_run.h"
#include "byre/input_error.h"
#include "byre/playback/report/report.h"
#include "byre/registry/blobs.h"
#include "byre/registry/listing.h"
#include "byre/registry/versions.h"
#include "byre/slam/system/resources.h"
#include "byre/viewer/web/web_map.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxMaps = 3;                               // in memory
constexpr const char* kBoundWaiting = "SET lock_timeout = '2s'";  // a lock of another client must not stop the page

constexpr std::array<std::pair<const char*, Review>, 3> kReviews = {
    {{"accept", Review::accept}, {"reject", Review::reject}, {"rollback", Review::rollback}}};

// Folder that only this account reads, removed at the end.
class PrivateFolder {
 public:
  PrivateFolder() : path_((fs::temp_directory_path() / "byre_review.XXXXXX").string()) {
    if (mkdtemp(path_.data()) == nullptr) {
      throw InputError(path_, "cannot be made: " + std::generic_category().message(errno), "set TMPDIR");
    }
  }
  ~PrivateFolder() {
    std::error_code error;
    fs::remove_all(path_, error);
  }
  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;

  fs::path path() const { return path_; }

 private:
  std::string path_;
};

// Text with %XX decoded.
std::string decoded(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned char byte = 0;
    const char* const digits = text.data() + i + 1;
    if (text[i] == '%' && i + 2 < text.size() && std::from_chars(digits, digits + 2, byte, 16).ptr == digits + 2) {
      result += static_cast<char>(byte);
      i += 2;
    } else {
      result += text[i];
    }
  }
  return result;
}

// Parts of a path between slashes, without the empty one before the first.
std::vector<std::string> parts_of(std::string_view path) {
  std::vector<std::string> parts;
  while (!path.empty()) {
    path.remove_prefix(1);
    const std::string_view part = path.substr(0, path.find('/'));
    parts.push_back(decoded(part));
    path.remove_prefix(part.size());
  }
  return parts;
}

WebResponse json_response(const Json& fields, int status = 200) {
  return {status, "application/json", dump_json(fields)};
}

std::string reason_in(const std::string& body) {
  const Json fields = Json::parse(body, nullptr, false);
  const auto found = fields.is_object() ? fields.find("reason") : fields.end();
  if (!fields.is_object() || found == fields.end() || !found->is_string()) {
    throw InputError("request", "is not JSON with the text \"reason\"");
  }
  const std::string reason = found->get<std::string>();
  if (reason.find_first_not_of(" \t\r\n") == std::string::npos) {
    throw InputError("reason", "is missing", "give one, for the history of the site");
  }
  return reason;
}

bool has_version(Connection& connection, std::int64_t site, const std::string& id) {
  return connection.run("SELECT FROM byre.version WHERE site = $1 AND id = $2", {site, id}).size() == 1;
}

// Sets the current plan that a map is registered on, or the reason why it is not shown.
void pull_plan_of(Connection& connection, std::int64_t site, const fs::path& folder, ViewedMap& map) {
  const std::vector<RegistryPlan> plans = current_plans(connection, site);
  const auto plan = std::ranges::find(plans, map.stored.plan->plan, &RegistryPlan::file);
  if (plan == plans.end()) {
    map.plan_note =
        fmt::format("The registry has no current plan {}, on which the map is registered.", map.stored.plan->plan);
    return;
  }
  try {
    map.plan = read_floor_plan(pull_plan(connection, site, *plan, folder).path);
    map.plan_note = fmt::format("Floor plan {} {} ({}), added by {} at {}", plan->name, plan->number, plan->file,
                                plan->added_by, plan->added_at);
  } catch (const InputError& error) {
    map.plan_note = fmt::format("Floor plan {} {}: {}", plan->name, plan->number, error.what());
  }
}

// Page of a version with its changes since its parent.
std::unique_ptr<WebSite> pull_page(const ReviewSiteOptions& options, const std::string& site_name,
                                   const std::string& id) {
  Connection connection = open_registry(options.uri);
  const std::int64_t site = site_number(connection, site_name);
  const Json parents = Json::parse(version_json(connection, site, id)).at("parents");
  const PrivateFolder folder;
  const fs::path file = folder.path() / "version.byre";
  ViewedMap map;
  map.name = site_name + " " + id;
  map.is_read_only = true;
  pull_map(connection, site, id, file);
  map.stored = load_map(file);
  if (options.plan) {
    if (map.stored.plan && map.stored.plan->plan == options.plan->name) map.plan = options.plan;
  } else if (map.stored.plan) {
    pull_plan_of(connection, site, folder.path() / "plan", map);
  }
  if (parents.empty()) return make_map_site(std::move(map));
  const auto parent = parents[0].get<std::string>();
  if (!has_version(connection, site, parent)) {
    map.next_step = "The registry does not have its parent " + parent + ": changes are not shown.";
    return make_map_site(std::move(map));
  }
  const fs::path file_of_parent = folder.path() / "parent.byre";
  pull_map(connection, site, parent, file_of_parent);
  map.changes = changes_between(parent, load_map(file_of_parent), map.stored);
  return make_map_site(std::move(map));
}

bool is_ready(const std::future<std::unique_ptr<WebSite>>& pulled) {
  return pulled.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

struct ServeOptions {
  std::string uri;
  ViewOptions view;
};

constexpr auto kPollPeriod = std::chrono::seconds(1);  // bound of the delay of changes without a notification

constexpr const char* kServeFooter = R"(Example:
  byre registry serve --registry postgresql://ann@db.example.org/byre

Shows sites, versions, sessions, jobs and robots in a browser, at the address printed on the standard error stream,
until Ctrl-C: for each version its map, its changes since its parent, and its history. A reviewer accepts, rejects and
rolls back versions there, each with a reason. The page has the rights of the account of --registry, for all users of
this computer; with --bind, for all who have the token.)";

// Wakes the server after each change in the registry, and when the connection breaks or is back.
void watch(Connection& connection, WebServer& server, const InterruptCatcher& interrupt) {
  std::string seen;
  bool is_listening = false, is_broken = false;
  while (!interrupt.caught()) {
    try {
      if (is_broken) connection.reconnect();
      if (!is_listening) {
        connection.run("LISTEN byre_accepted");
        connection.run("LISTEN byre_job");
      }
      const std::string key = listing_key(connection);
      if (key != seen || is_broken) server.wake();
      seen = key;
      is_listening = true;
      is_broken = false;
      connection.wait_for_notification(kPollPeriod);
    } catch (const ConnectionLost& lost) {
      if (!is_broken) {
        show_warnings(std::cerr, {lost.what()});
        server.wake();
      }
      is_listening = false;
      is_broken = true;
      std::this_thread::sleep_for(kPollPeriod);
    }
  }
}

ExitCode run_serve(const ServeOptions& options) {
  const InterruptCatcher interrupt;
  ReviewSiteOptions site{options.uri, {}};
  if (options.view.plan) site.plan = read_floor_plan(*options.view.plan);
  Connection watched = open_registry(options.uri, kPatience);
  raise_descriptor_limit();
  WebServer server(options.view.server, std::make_unique<ReviewSite>(std::move(site)));
  announce(server.urls());
  watch(watched, server, interrupt);
  return ExitCode::done;
}

}  // namespace

ReviewSite::ReviewSite(ReviewSiteOptions options)
    : options_(std::move(options)), connection_(open_registry(options_.uri, kPatience)) {
  connection_.run(kBoundWaiting);
}

std::optional<WebMessage> ReviewSite::next_message(ListenerProgress& progress) {
  if (progress.frames == news_) return std::nullopt;
  progress.frames = news_;
  return WebMessage{dump_json(Json{{"changed", news_}})};
}

WebResponse ReviewSite::answer(const WebRequest& request) {
  if (request.path == "/") return page_response();
  const Parts parts = parts_of(request.path);
  if (parts.empty()) return not_found(request);
  if (parts[0] == "maps") return request.method == WebRequest::Method::get ? map_response(parts) : not_found(request);
  try {
    use_connection();
    return answer_at(parts, request);
  } catch (const ConnectionLost& lost) {
    is_broken_ = true;
    return problem_response(503, lost.what());
  }
}

void ReviewSite::use_connection() {
  if (!is_broken_) return;
  connection_.reconnect();
  connection_.run(kBoundWaiting);
  is_broken_ = false;
}

WebResponse ReviewSite::answer_at(const Parts& parts, const WebRequest& request) {
  const bool is_get = request.method == WebRequest::Method::get;
  if (is_get && request.path == "/scene") {
    return json_response({{"mode", "registry"},
                          {"name", connection_.place()},
                          {"account", connection_.run("SELECT current_user").text(0, 0)}});
  }
  if (parts[0] != "sites") return not_found(request);
  if (!is_get) return parts.size() == 4 ? review(parts, request) : not_found(request);
  if (parts.size() == 1) return {200, "application/json", sites_json(connection_)};
  if (parts.size() > 3) return not_found(request);
  const std::int64_t site = site_number(connection_, parts[1]);
  if (parts.size() == 2) return {200, "application/json", site_json(connection_, site)};
  if (parts[2] == "events") return {200, "application/json", events_json(connection_, site)};
  return version_response(site, parts[2]);
}

// The version, and what each review of it would do now. That of the accepted one rolls back to the one before.
WebResponse ReviewSite::version_response(std::int64_t site, const std::string& version) {
  Json fields = Json::parse(version_json(connection_, site, version));
  for (const auto& [name, review] : kReviews) {
    const bool is_of_earlier = review == Review::rollback && fields["state"] == "accepted";
    const ReviewTrial trial =
        try_review(connection_, review, site, is_of_earlier ? std::nullopt : std::optional(version));
    fields["reviews"][name] = {{"version", trial.version}, {"refusal", trial.refusal}};
  }
  return json_response(fields);
}

WebResponse ReviewSite::review(const Parts& parts, const WebRequest& request) {
  const auto* const named = std::ranges::find(kReviews, parts[3], [](const auto& each) { return each.first; });
  if (named == kReviews.end()) return not_found(request);
  const std::string reason = reason_in(request.body);
  const std::int64_t site = site_number(connection_, parts[1]);
  return json_response({{"version", review_version(connection_, named->second, site, parts[2], reason)}});
}

WebResponse ReviewSite::map_response(const Parts& parts) {
  std::string path;
  for (std::size_t i = 3; i < parts.size(); ++i) path += "/" + parts[i];
  const WebRequest request{WebRequest::Method::get, path, ""};
  if (path == "/") return page_response();
  if (path.empty()) return not_found(request);
  const auto map = map_page(parts[1], parts[2]);
  if (map == maps_.end() || !map->page) {
    if (map == maps_.end() || !is_ready(map->pulled))
      return json_response({{"waiting", "Pulling the map from the registry"}}, 202);
    std::future<std::unique_ptr<WebSite>> pulled = std::move(map->pulled);
    try {
      map->page = pulled.get();
    } catch (const ConnectionLost& lost) {
      maps_.erase(map);  // the next request pulls it again
      return problem_response(503, lost.what());
    } catch (const std::exception&) {
      maps_.erase(map);
      throw;
    }
  }
  return map->page->answer(request);
}

std::vector<ReviewSite::MapPage>::iterator ReviewSite::map_page(const std::string& site, const std::string& version) {
  const auto is_it = [&](const MapPage& each) { return each.site == site && each.version == version; };
  const auto found = std::ranges::find_if(maps_, is_it);
  if (found != maps_.end()) return found;
  if (maps_.size() == kMaxMaps) {
    const auto oldest =
        std::ranges::find_if(maps_, [](const MapPage& each) { return each.page || is_ready(each.pulled); });
    if (oldest == maps_.end()) return oldest;
    maps_.erase(oldest);
  }
  maps_.push_back({site, version, std::async(std::launch::async, pull_page, options_, site, version), nullptr});
  return maps_.end() - 1;
}

Action declare_registry_serve(CLI::App& command) {
  const auto options = std::make_shared<ServeOptions>();
  add_registry(command, options->uri);
  declare_viewer_options(
      command, options->view,
      "Floor plan, shown with versions that are registered on it, instead of the current plans of the registry");
  command.footer(kServeFooter);
  return [options](std::ostream&) { return run_serve(*options); };
}

}  // namespace byre::cli
