#include "enums.h"

#include <utility>
#include <vector>

namespace byre::python {
namespace {

template <typename Enum>
void bind_enum(py::module_& module, const char* name, const char* doc,
               const std::vector<std::pair<const char*, Enum>>& members) {
  py::list values;
  for (const auto& [member, value] : members) values.append(py::make_tuple(member, static_cast<int>(value)));
  py::object type = py::module_::import("enum").attr("Enum")(name, values, py::arg("module") = "byre");
  type.attr("__doc__") = doc;
  module.attr(name) = type;
  PythonEnum<Enum>::type = type.release();
}

void bind_enums_of_input(py::module_& module) {
  bind_enum<CameraModel>(module, "CameraModel",
                         "Lens models as defined by EuRoC, Kalibr and OpenCV. Distortion: k1, k2, p1, p2, k3 for "
                         "radial_tangential, k1 to k4 for equidistant.",
                         {{"pinhole", CameraModel::pinhole},
                          {"radial_tangential", CameraModel::radial_tangential},
                          {"equidistant", CameraModel::equidistant},
                          {"rational", CameraModel::rational},
                          {"unified", CameraModel::unified},
                          {"extended_unified", CameraModel::extended_unified},
                          {"double_sphere", CameraModel::double_sphere},
                          {"field_of_view", CameraModel::field_of_view},
                          {"thin_prism_fisheye", CameraModel::thin_prism_fisheye}});
  bind_enum<CameraChoice>(
      module, "CameraChoice",
      "Cameras of a recording to use: both of a stereo pair, one of them, or the left one with the depth camera.",
      {{"stereo", CameraChoice::stereo},
       {"left", CameraChoice::left},
       {"right", CameraChoice::right},
       {"rgbd", CameraChoice::rgbd}});
  bind_enum<PixelFormat>(module, "PixelFormat",
                         "Pixel format of an image. grey8, bgr8 and rgb8: uint8; grey16: uint16.",
                         {{"grey8", PixelFormat::grey8},
                          {"grey16", PixelFormat::grey16},
                          {"bgr8", PixelFormat::bgr8},
                          {"rgb8", PixelFormat::rgb8}});
  bind_enum<InputFault>(module, "InputFault",
                        "Fault of the input of a frame. From no_image on the frame is dropped without processing.",
                        {{"none", InputFault::none},
                         {"after_gap", InputFault::after_gap},
                         {"missing_right", InputFault::missing_right},
                         {"late_right", InputFault::late_right},
                         {"missing_depth", InputFault::missing_depth},
                         {"late_depth", InputFault::late_depth},
                         {"no_image", InputFault::no_image},
                         {"wrong_size", InputFault::wrong_size},
                         {"wrong_format", InputFault::wrong_format},
                         {"wrong_features", InputFault::wrong_features},
                         {"repeated_time", InputFault::repeated_time},
                         {"out_of_order", InputFault::out_of_order},
                         {"replaced", InputFault::replaced},
                         {"after_finishing", InputFault::after_finishing}});
}

void bind_enums_of_reports(py::module_& module) {
  bind_enum<State>(
      module, "State",
      "State of tracking. relocalising: pose lost, or not confirmed yet; lost: no confirmed pose for 10 s.",
      {{"initialising", State::initialising},
       {"tracking", State::tracking},
       {"relocalising", State::relocalising},
       {"lost", State::lost}});
  bind_enum<Verdict>(
      module, "Verdict",
      "Reliability of the pose in the map. trusted: error below 0.2 m; degraded: weakly supported, drive slowly; "
      "untrusted: do not use it.",
      {{"trusted", Verdict::trusted}, {"degraded", Verdict::degraded}, {"untrusted", Verdict::untrusted}});
  bind_enum<DistrustReason>(module, "DistrustReason", "Main reason against trusting a pose; none for a trusted one.",
                            {{"none", DistrustReason::none},
                             {"no_pose", DistrustReason::no_pose},
                             {"blinded", DistrustReason::blinded},
                             {"not_registered", DistrustReason::not_registered},
                             {"unconfirmed", DistrustReason::unconfirmed},
                             {"off_the_map", DistrustReason::off_the_map},
                             {"few_points", DistrustReason::few_points},
                             {"few_offline_points", DistrustReason::few_offline_points},
                             {"clustered", DistrustReason::clustered},
                             {"uncertain", DistrustReason::uncertain},
                             {"maps_disagree", DistrustReason::maps_disagree},
                             {"frozen", DistrustReason::frozen},
                             {"right_camera", DistrustReason::right_camera},
                             {"cameras_disagree", DistrustReason::cameras_disagree},
                             {"calibration", DistrustReason::calibration},
                             {"bridged", DistrustReason::bridged},
                             {"dirty", DistrustReason::dirty},
                             {"map_damaged", DistrustReason::map_damaged},
                             {"off_the_plane", DistrustReason::off_the_plane},
                             {"in_wall", DistrustReason::in_wall},
                             {"outside", DistrustReason::outside},
                             {"behind_wall", DistrustReason::behind_wall}});
  bind_enum<SessionEvent>(module, "Event", "Event in a frame, for logs and operators.",
                          {{"initialised", SessionEvent::initialised},
                           {"localised", SessionEvent::localised},
                           {"pose_lost", SessionEvent::pose_lost},
                           {"relocalised", SessionEvent::relocalised},
                           {"blinded", SessionEvent::blinded},
                           {"left_mapped_area", SessionEvent::left_mapped_area},
                           {"entered_mapped_area", SessionEvent::entered_mapped_area},
                           {"navigation_error", SessionEvent::navigation_error},
                           {"restarted", SessionEvent::restarted},
                           {"place_refused", SessionEvent::place_refused},
                           {"place_refuted", SessionEvent::place_refuted},
                           {"online_corrected", SessionEvent::online_corrected},
                           {"loop_found", SessionEvent::loop_found},
                           {"map_corrected", SessionEvent::map_corrected},
                           {"recalibrated", SessionEvent::recalibrated},
                           {"dirt_found", SessionEvent::dirt_found},
                           {"dirt_gone", SessionEvent::dirt_gone},
                           {"tag_moved", SessionEvent::tag_moved},
                           {"map_changed", SessionEvent::map_changed}});
  bind_enum<LocalisationFailure>(module, "LocalisationFailure",
                                 "Reason why an image was not localised, ordered by the progress of the attempt.",
                                 {{"none", LocalisationFailure::none},
                                  {"too_few_features", LocalisationFailure::too_few_features},
                                  {"no_similar_keyframe", LocalisationFailure::no_similar_keyframe},
                                  {"too_few_matches", LocalisationFailure::too_few_matches},
                                  {"geometry_disagrees", LocalisationFailure::geometry_disagrees},
                                  {"too_few_inliers", LocalisationFailure::too_few_inliers},
                                  {"clustered", LocalisationFailure::clustered},
                                  {"uncertain", LocalisationFailure::uncertain},
                                  {"impossible", LocalisationFailure::impossible},
                                  {"unlikely", LocalisationFailure::unlikely},
                                  {"ambiguous", LocalisationFailure::ambiguous}});
}

}  // namespace

void bind_enums(py::module_& module) {
  bind_enums_of_input(module);
  bind_enums_of_reports(module);
  bind_enum<Workers>(module, "Workers",
                     "Threads of mapping. live: worker threads, for robots; repeatable: worker threads, equal images "
                     "yield equal poses; none: mapping inside process().",
                     {{"live", Workers::live}, {"repeatable", Workers::repeatable}, {"none", Workers::none}});
  bind_enum<TrajectoryFormat>(
      module, "TrajectoryFormat",
      "Trajectory file formats. tum: time_s tx ty tz qx qy qz qw; euroc: time_ns,px,py,pz,qw,qx,qy,qz; kitti: twelve "
      "numbers of the 3x4 pose, without times.",
      {{"tum", TrajectoryFormat::tum}, {"euroc", TrajectoryFormat::euroc}, {"kitti", TrajectoryFormat::kitti}});
}

}  // namespace byre::python
