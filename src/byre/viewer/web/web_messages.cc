#include "byre/viewer/web/web_messages.h"

#include "byre/base/printable.h"
#include "byre/input_error.h"
#include "byre/io/image/image_codec.h"
#include "byre/io/image/plan_pixels.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <type_traits>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace byre {
namespace {

static_assert(std::endian::native == std::endian::little, "else bytes would have to be swapped");

template <typename Value>
void append(std::string& bytes, Value value) {
  static_assert(std::is_arithmetic_v<Value>);
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(Value));
}

void append(std::string& bytes, const Pose& map_from_body) {
  for (const double value : map_from_body.translation) append(bytes, static_cast<float>(value));
  for (const double value : map_from_body.rotation.coeffs()) append(bytes, static_cast<float>(value));
}

std::uint8_t number_of(Origin origin) {
  return origin == Origin::online ? 1 : 0;
}

using Json = nlohmann::json;

constexpr double kMillimetresPerMetre = 1e3;
constexpr double kMillisecondsPerSecond = 1e3;

// Four decimals for short messages: 0.1 mm, and 0.01 degrees of a quaternion.
double rounded(double value) {
  return std::round(1e4 * value) / 1e4;
}

Json short_pose(const Pose& map_from_body) {
  Json fields = pose_fields(map_from_body);
  for (Json& field : fields) field = rounded(field);
  return fields;
}

}  // namespace

Json vector_fields(const Eigen::Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

Json pose_fields(const Pose& a_from_b) {
  const Eigen::Vector3d& origin = a_from_b.translation;
  const Eigen::Quaterniond& rotation = a_from_b.rotation;
  return {origin.x(), origin.y(), origin.z(), rotation.x(), rotation.y(), rotation.z(), rotation.w()};
}

Json frame_fields(const ShownFrame& frame) {
  const FrameReport& report = frame.report;
  const Health& health = report.health;
  Json fields = {{"time_s", to_seconds(report.time)},
                 {"state", to_string(report.state)},
                 {"verdict", to_string(health.verdict)},
                 {"doubt", to_string(health.doubt)},
                 {"pose", fields_or_null(report.map_from_body, short_pose)},
                 {"offline_inliers", health.offline_inliers},
                 {"offline_expected", health.offline_expected},
                 {"online_inliers", health.online_inliers},
                 {"expected", report.expected_points},
                 {"matches", report.matches},
                 {"features", report.features},
                 {"suspended", health.suspended},
                 {"inlier_share", rounded(health.inlier_share)},
                 {"spread", rounded(health.spread)},
                 {"sigma_mm", rounded(kMillimetresPerMetre * health.position_sigma)},
                 {"since_offline_m", rounded(health.distance_since_offline)},
                 {"track_ms", rounded(kMillisecondsPerSecond * report.track_seconds)},
                 {"online_keyframes", frame.online_keyframes},
                 {"online_points", frame.online_points}};
  if (const std::string_view advice = advice_for(health.doubt); !advice.empty()) fields["advice"] = advice;
  if (health.agreement) fields["disagreement_mm"] = rounded(kMillimetresPerMetre * health.agreement->translation);
  for (const SessionEvent event : report.events) fields["events"].push_back(to_string(event));
  return fields;
}

Json camera_fields(const Rig& rig) {
  return {{"width", rig.width}, {"height", rig.height}, {"focal", rig.focal},
          {"cx", rig.cx},       {"cy", rig.cy},         {"body_from_camera", pose_fields(rig.body_from_camera)}};
}

Json plan_fields(const FloorPlan& plan) {
  const Eigen::Matrix2d& step = plan.metres_per_pixel;
  return {{"name", plan.name},
          {"width", plan.width},
          {"height", plan.height},
          {"step_right", {step(0, 0), step(1, 0)}},
          {"step_down", {step(0, 1), step(1, 1)}},
          {"top_left", {plan.top_left_in_plan.x(), plan.top_left_in_plan.y()}}};
}

Json registration_fields(const PlanRegistration& registration) {
  const Pose& placed = registration.plan_from_map.target_from_source;
  return {{"plan", registration.plan}, {"scale", registration.plan_from_map.scale}, {"pose", pose_fields(placed)}};
}

std::string dump_json(const Json& json) {
  return printable_json(json.dump(-1, ' ', false, Json::error_handler_t::replace));
}

std::string plan_png(const FloorPlan& plan, int max_side) {
  cv::Mat image = render_plan(plan);
  if (image.empty()) throw InputError(plan.image.string(), "is not a readable image", "give a PNG, JPEG or PGM");
  const int longest = std::max(image.cols, image.rows);
  if (longest > max_side) {
    const double scale = static_cast<double>(max_side) / longest;
    cv::resize(image, image, {}, scale, scale, cv::INTER_AREA);
  }
  const std::vector<std::uint8_t> png = encode_image(".png", image);
  return {png.begin(), png.end()};
}

std::string map_bytes(const MapScene& scene) {
  constexpr std::size_t kBytesPerPoint = 13, kBytesPerKeyframe = 29;
  std::string bytes;
  bytes.reserve(8 + kBytesPerPoint * scene.points.size() + kBytesPerKeyframe * scene.keyframes.size());
  append(bytes, static_cast<std::uint32_t>(scene.points.size()));
  append(bytes, static_cast<std::uint32_t>(scene.keyframes.size()));
  for (const ScenePoint& point : scene.points) {
    for (const float value : point.position_in_map) append(bytes, value);
  }
  for (const SceneKeyframe& keyframe : scene.keyframes) append(bytes, keyframe.map_from_body);
  for (const ScenePoint& point : scene.points) append(bytes, number_of(point.origin));
  for (const SceneKeyframe& keyframe : scene.keyframes) append(bytes, number_of(keyframe.origin));
  return bytes;
}

std::string image_bytes(std::size_t frame, std::span<const SeenPoint> seen, std::span<const unsigned char> jpeg) {
  std::string bytes;
  append(bytes, static_cast<std::uint32_t>(frame));
  append(bytes, static_cast<std::uint32_t>(seen.size()));
  for (const SeenPoint& point : seen) {
    append(bytes, point.pixel.x());
    append(bytes, point.pixel.y());
  }
  for (const SeenPoint& point : seen) {
    append(bytes, static_cast<std::uint8_t>(number_of(point.point.origin) + (point.is_inlier ? 2 : 0)));
  }
  bytes.append(jpeg.begin(), jpeg.end());
  return bytes;
}

}  // namespace byre
