#include "byre/viewer/web/web_map.h"

#include "byre/base/output_file.h"
#include "byre/base/text_file.h"
#include "byre/input_error.h"
#include "byre/io/recording/timed_files.h"
#include "byre/map/plan/pick_guidance.h"
#include "byre/map/plan/plan_matching.h"
#include "byre/map/point_grey.h"
#include "byre/map/stored_calibration.h"
#include "byre/viewer/plan_picks.h"
#include "byre/viewer/web/web_messages.h"

#include <cmath>
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
  const auto number = parse_whole<std::uint32_t>(path);
  if (!number) return nullptr;
  const Keyframe* const keyframe = map.find_keyframe({map.origin(), *number});
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
    fields["residuals"].push_back({{"error_m", {residual.error_in_plan.x(), residual.error_in_plan.y()}},
                                   {"sigma_m", residual.sigma},
                                   {"is_outlier", residual.is_outlier}});
  }
  for (const PlanDoubt doubt : fit.doubts) fields["doubts"].push_back(to_string(doubt));
  return fields;
}

// Places in pictures as [keyframe, u, v], shares of the picture's width and height.
Json view_fields(const MapGraph& map, const std::vector<KeyframePixel>& views) {
  Json fields = Json::array();
  for (const auto& [id, pixel] : views) {
    const Rig& rig = rig_of(map, *map.keyframe_header(id));
    fields.push_back({id.number, (pixel.x() + 0.5) / rig.width, (pixel.y() + 0.5) / rig.height});
  }
  return fields;
}

// Keyframes with a picture. up_in_map: empty without a plan, for which alone the width of a view is needed.
Json picture_fields(const StoredMap& stored, const std::optional<Eigen::Vector3d>& up_in_map) {
  Json fields = Json::array();
  for (const KeyframeId id : stored.map.keyframe_ids()) {
    const Keyframe& keyframe = *stored.map.keyframe_header(id);
    if (!keyframe.picture) continue;
    const SourceRecording& recording = stored.recordings[static_cast<std::size_t>(keyframe.recording)];
    fields.push_back(
        {{"keyframe", id.number},
         {"recording", recording.name},
         {"time_s", to_seconds(keyframe.frame.time - recording.first_time)},
         {"width_of_view", up_in_map ? width_of_view(stored.map, *stored.map.find_keyframe(id), *up_in_map) : 0.0}});
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
        driving_plane_(fit_driving_plane(map_.stored.map, up_of_base(map_.stored))),
        points_(map_bytes(scene_of(map_.stored.map))),
        plan_(map_.plan ? plan_png(*map_.plan) : "") {}

  WebResponse answer(const WebRequest& request) override {
    const bool is_post = request.method == WebRequest::Method::post;
    if (request.path == "/registration" && is_post) return json_response(registration_of(request));
    if (request.path == "/proposal" && is_post) return json_response(proposal_fields());
    if (request.path == "/place" && is_post) return json_response(place_fields(request));
    if (request.path == "/save" && is_post) return json_response({{"written", save(request)}});
    if (request.path == "/") return page_response();
    if (request.path == "/scene") return json_response(scene_fields());
    if (request.path == "/map/offline") return bytes_response(points_);
    if (request.path == "/map/changes" && map_.changes) return bytes_response(map_bytes(map_.changes->scene));
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
    const auto before_of = [](const MapChanges& changes) { return changes.before; };
    return {
        {"mode", "map"},
        {"name", map_.name},
        {"is_metric", map_.stored.scale == MapScale::metric},
        {"up_in_map", fields_or_null(driving_plane_, up_of)},
        {"plan", fields_or_null(map_.plan, plan_fields)},
        {"plan_note", map_.plan_note},
        {"registration", fields_or_null(map_.stored.plan, registration_fields)},
        {"pictures", picture_fields(map_.stored, driving_plane_ && map_.plan ? std::optional(driving_plane_->up_in_map)
                                                                             : std::nullopt)},
        {"output", fields_or_null(map_.output, text_of)},
        {"is_read_only", map_.is_read_only},
        {"next_step", map_.next_step},
        {"before", fields_or_null(map_.changes, before_of)},
        {"tags", tag_correspondences(map_.stored, map_.tags).size()}};
  }

  std::vector<PlanPick> picks_of(const WebRequest& request) const {
    if (!map_.plan) throw InputError(map_.name, "has no floor plan to register on", "start \"byre view\" with --plan");
    return parse_plan_picks(request.body, map_.stored.map);
  }

  const DrivingPlane& plane() const {
    if (!driving_plane_) {
      throw InputError(map_.name,
                       "does not determine the vertical: it has no keyframes, or they have no common upright direction",
                       "map a recording of a camera that stays upright");
    }
    return *driving_plane_;
  }

  // With residuals of the picks, then of the surveyed tags.
  PlanFit fit(const std::vector<PlanPick>& picks) const {
    const Scale scale = map_.stored.scale == MapScale::metric ? Scale::fixed : Scale::free;
    std::vector<PlanCorrespondence> correspondences =
        correspondences_of(picks, map_.stored, plane(), map_.pick_sigma, map_.registration.body_height);
    const std::vector<PlanCorrespondence> of_tags = tag_correspondences(map_.stored, map_.tags);
    correspondences.insert(correspondences.end(), of_tags.begin(), of_tags.end());
    std::optional<PlanFit> found = register_on_plan(correspondences, plane(), scale, map_.registration);
    if (!found) {
      throw InputError("picks", "do not determine the pose of the map on the plan",
                       "pick three or more distant places, and check for wrong picks");
    }
    found->registration.plan = map_.plan->name;
    return *found;
  }

  // Fit with the next best pick.
  Json registration_of(const WebRequest& request) const {
    const PlanFit found = fit(picks_of(request));
    Json fields = fit_fields(found);
    const auto next = next_pick(map_.stored.map, plane(), found.registration, map_.pick_sigma);
    fields["next"] = fields_or_null(next, [this](const NextPick& pick) {
      return Json{{"plan", {pick.point_in_plan.x(), pick.point_in_plan.y()}},
                  {"pixels", view_fields(map_.stored.map, pick.views)},
                  {"sigma_before_m", pick.sigma_before},
                  {"sigma_after_m", pick.sigma_after}};
    });
    return fields;
  }

  // Further pictures that show the place at one pixel, or the sigma of the place seen at several.
  Json place_fields(const WebRequest& request) const {
    const std::vector<KeyframePixel> pixels = parse_picture_pixels(request.body, map_.stored.map);
    if (pixels.size() == 1) return {{"views", view_fields(map_.stored.map, further_views(map_.stored.map, pixels[0]))}};
    const MapPosition place = place_of_pixels("the place", pixels, map_.stored);
    return {{"sigma", std::sqrt(place.covariance.trace() / 3.0)}};
  }

  // Registration by the walls, for confirmation by a person.
  Json proposal_fields() {
    if (!map_.plan || map_.stored.scale != MapScale::metric) {
      throw InputError(map_.name, "has no plan or no metric scale", "pick points");
    }
    const std::optional<PlanMatch> match =
        match_with_plan(map_.stored.map, plane(), read_plan_pixels(*map_.plan), map_.body_height);
    if (!match) throw InputError(map_.name, "has no obstacles to match, or the plan has no walls", "pick points");
    proposed_ = match->fit;
    Json fields = fit_fields(*proposed_);
    fields["description"] = describe_match(*match);
    fields["doubt"] = match->doubt ? Json(to_string(*match->doubt)) : Json();
    return fields;
  }

  // Returns the names of the written files.
  std::vector<std::string> save(const WebRequest& request) {
    const bool is_proposal = proposed_ && is_about_proposal(request.body);
    const std::vector<PlanPick> picks = is_proposal ? std::vector<PlanPick>() : picks_of(request);
    if (!map_.output) throw InputError(map_.name, "cannot be saved", "start \"byre view\" with -o FILE");
    const PlanFit found = is_proposal ? *proposed_ : fit(picks);
    if (const double residual = residual_of(found); residual > accepted_residual(request.body)) {
      throw InputError("picks", fmt::format("have residuals of {:.2f} m on the map", residual),
                       "correct them, or confirm the residual");
    }
    map_.stored.plan = found.registration;
    save_map(map_.stored, *map_.output);
    if (is_proposal) return {map_.output->string()};
    const std::filesystem::path csv_path = picks_path(*map_.output);
    write_atomically(csv_path, picks_csv(picks, map_.stored));
    return {map_.output->string(), csv_path.string()};
  }

  std::optional<PlanFit> proposed_;
  ViewedMap map_;  // constant except for the registration, which saving updates

  // Constant after construction.
  std::optional<DrivingPlane> driving_plane_;
  std::string points_;
  std::string plan_;  // PNG; empty without a plan
};

}  // namespace

MapChanges changes_between(const std::string& name, const StoredMap& before, const StoredMap& after) {
  const Map earlier(before), later(after);
  return {name, scene_of(earlier, later, earlier.difference(later))};
}

std::unique_ptr<WebSite> make_map_site(ViewedMap map) {
  return std::make_unique<MapSite>(std::move(map));
}

MapViewer::MapViewer(ViewedMap map, const WebServerOptions& server) : server_(server, make_map_site(std::move(map))) {}

}  // namespace byre
