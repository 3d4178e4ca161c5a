#include "byre/viewer/web/web_map.h"

#include "byre/base/output_file.h"
#include "byre/input_error.h"
#include "byre/io/recording/input_files.h"
#include "byre/map/point_grey.h"
#include "byre/viewer/plan_picks.h"
#include "byre/viewer/scene.h"
#include "byre/viewer/web/web_messages.h"

#include <charconv>
#include <cstdint>
#include <string_view>
#include <utility>

#include <fmt/core.h>

namespace byre {
namespace {

using Json = nlohmann::json;

constexpr std::string_view kPicturesFolder = "/pictures/";

// Keyframe of a path "/pictures/NUMBER" that has a picture.
const Keyframe* find_pictured(const MapGraph& map, std::string_view path) {
  if (!path.starts_with(kPicturesFolder)) return nullptr;
  path.remove_prefix(kPicturesFolder.size());
  std::uint32_t number = 0;
  const auto [end, error] = std::from_chars(path.data(), path.data() + path.size(), number);
  if (error != std::errc() || end != path.data() + path.size()) return nullptr;
  const Keyframe* const keyframe = map.find_keyframe({map.origin(), number});
  return keyframe != nullptr && keyframe->picture ? keyframe : nullptr;
}

// Grey value of each point, in order of ids; those without a patch are medium grey.
std::string grey_bytes(const MapGraph& map) {
  constexpr std::uint8_t kUnknown = 128;
  std::string greys;
  for (const PointId id : map.point_ids()) {
    greys += static_cast<char>(grey_of(map, *map.find_point(id)).value_or(kUnknown));
  }
  return greys;
}

Json fit_fields(const PlanFit& fit) {
  Json fields = {{"registration", registration_fields(fit.registration)},
                 {"rms_m", fit.rms},
                 {"residual_m", residual_of(fit)},
                 {"is_far_off", has_large_residual(fit)},
                 {"residuals", Json::array()},
                 {"doubts", Json::array()}};
  for (const PlanResidual& residual : fit.residuals) {
    fields["residuals"].push_back(
        {{"error_m", {residual.error_in_plan.x(), residual.error_in_plan.y()}}, {"is_outlier", residual.is_outlier}});
  }
  for (const PlanDoubt doubt : fit.doubts) fields["doubts"].push_back(to_string(doubt));
  return fields;
}

// Keyframes with a picture.
Json picture_fields(const StoredMap& stored) {
  Json fields = Json::array();
  for (const KeyframeId id : stored.map.keyframe_ids()) {
    const Keyframe& keyframe = *stored.map.keyframe_header(id);
    if (!keyframe.picture) continue;
    const SourceRecording& recording = stored.recordings[static_cast<std::size_t>(keyframe.recording)];
    fields.push_back({{"keyframe", id.number},
                      {"recording", recording.name},
                      {"time_s", to_seconds(keyframe.frame.time - recording.first_time)}});
  }
  return fields;
}

std::string string_of(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

WebResponse json_response(const Json& fields) {
  return {200, "application/json", dump_json(fields)};
}

class MapSite : public WebSite {
 public:
  explicit MapSite(ViewedMap map)
      : map_(std::move(map)),
        driving_plane_(fit_driving_plane(map_.stored.map)),
        points_(map_bytes(scene_of(map_.stored.map))),
        plan_(map_.plan ? plan_png(*map_.plan) : "") {}

  WebResponse answer(const WebRequest& request) override {
    const bool is_post = request.method == WebRequest::Method::post;
    if (request.path == "/registration" && is_post) return json_response(fit_fields(fit(picks_of(request))));
    if (request.path == "/save" && is_post) return json_response({{"written", save(request)}});
    if (request.path == "/") return page_response();
    if (request.path == "/scene") return json_response(scene_fields());
    if (request.path == "/map/offline") return bytes_response(points_);
    if (request.path == "/map/greys") return bytes_response(grey_bytes(map_.stored.map));
    if (const Keyframe* const keyframe = find_pictured(map_.stored.map, request.path)) {
      return bytes_response(string_of(keyframe->picture.jpeg()), "image/jpeg");
    }
    if (request.path == "/plan.png" && map_.plan) return bytes_response(plan_, "image/png");
    return not_found(request);
  }

 private:
  Json scene_fields() const {
    const auto up_of = [](const DrivingPlane& plane) { return vector_fields(plane.up_in_map); };
    const auto text_of = [](const std::filesystem::path& path) { return path.string(); };
    return {{"mode", "map"},
            {"name", map_.name},
            {"is_metric", map_.stored.scale == MapScale::metric},
            {"up_in_map", fields_or_null(driving_plane_, up_of)},
            {"plan", fields_or_null(map_.plan, plan_fields)},
            {"registration", fields_or_null(map_.stored.plan, registration_fields)},
            {"pictures", picture_fields(map_.stored)},
            {"output", fields_or_null(map_.output, text_of)}};
  }

  std::vector<PlanPick> picks_of(const WebRequest& request) const {
    if (!map_.plan) throw InputError(map_.name, "has no floor plan to register on", "start \"byre view\" with --plan");
    return parse_plan_picks(request.body, map_.stored.map);
  }

  PlanFit fit(const std::vector<PlanPick>& picks) const {
    if (!driving_plane_) {
      throw InputError(map_.name,
                       "does not determine the vertical: it has no keyframes, or they have no common upright direction",
                       "map a recording of a camera that stays upright");
    }
    const Scale scale = map_.stored.scale == MapScale::metric ? Scale::fixed : Scale::free;
    const std::vector<PlanCorrespondence> correspondences = correspondences_of(picks, map_.stored, map_.pick_sigma);
    std::optional<PlanFit> found = register_on_plan(correspondences, *driving_plane_, scale, map_.registration);
    if (!found) {
      throw InputError("picks", "do not determine the pose of the map on the plan",
                       "pick three or more distant places, and check for wrong picks");
    }
    found->registration.plan = map_.plan->name;
    return *found;
  }

  // Returns the names of the written files.
  std::vector<std::string> save(const WebRequest& request) {
    const std::vector<PlanPick> picks = picks_of(request);
    if (!map_.output) throw InputError(map_.name, "cannot be saved", "start \"byre view\" with -o FILE");
    const PlanFit found = fit(picks);
    if (const double residual = residual_of(found); residual > accepted_residual(request.body)) {
      throw InputError("picks", fmt::format("have residuals of {:.2f} m on the map", residual),
                       "correct them, or confirm the residual");
    }
    map_.stored.plan = found.registration;
    save_map(map_.stored, *map_.output);
    const std::filesystem::path csv_path = picks_path(*map_.output);
    write_atomically(csv_path, picks_csv(picks));
    return {map_.output->string(), csv_path.string()};
  }

  ViewedMap map_;  // constant except for the registration, which saving updates

  // Constant after construction.
  std::optional<DrivingPlane> driving_plane_;
  std::string points_;
  std::string plan_;  // PNG; empty without a plan
};

}  // namespace

MapViewer::MapViewer(ViewedMap map, const WebServerOptions& server)
    : server_(server, std::make_unique<MapSite>(std::move(map))) {}

}  // namespace byre
