#pragma once

#include "byre/floor_plan.h"
#include "byre/map/map_file.h"
#include "byre/map/plan/floor_plan.h"
#include "byre/tag.h"
#include "byre/viewer/scene.h"
#include "byre/viewer/web/web_server.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace byre {

// Changes of a map since an earlier version of it.
struct MapChanges {
  std::string before;  // name of the earlier version
  MapScene scene;      // points that only the earlier version has (offline) and that only this one has (online)
};

// Map to view and, with a plan, to register on it.
struct ViewedMap {
  std::string name;
  StoredMap stored;
  std::optional<FloorPlan> plan;
  std::string plan_note;                           // sentence on the origin of the plan, or on its absence
  std::optional<std::filesystem::path> output;     // file for the registered copy; empty: saving is disabled
  double pick_sigma = PlanCorrespondence{}.sigma;  // metres
  PlanRegistrationOptions registration;
  std::optional<double> body_height;  // metres; empty: not given, so that of the registration is assumed
  std::vector<Tag> tags;              // surveyed ones of the map are picks as well
  bool is_read_only = false;          // no points are picked
  std::string next_step;              // sentence with a command
  std::optional<MapChanges> changes;
};

// Changes since an earlier version, named as on the page.
MapChanges changes_between(const std::string& name, const StoredMap& before, const StoredMap& after);

// Page and data of a map.
std::unique_ptr<WebSite> make_map_site(ViewedMap map);

// Shows a map in a browser, and registers it on a plan by picked points.
class MapViewer {
 public:
  // Throws InputError as WebServer does, and if the plan's image cannot be read.
  MapViewer(ViewedMap map, const WebServerOptions& server);

  const std::vector<std::string>& urls() const { return server_.urls(); }

 private:
  WebServer server_;  // constant after construction
};

}  // namespace byre
