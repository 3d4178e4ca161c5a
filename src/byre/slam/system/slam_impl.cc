#include "byre/slam/system/slam_impl.h"

#include "byre/base/enum_names.h"
#include "byre/base/stopwatch.h"
#include "byre/features/image_view.h"
#include "byre/features/tag_detector.h"
#include "byre/geometry/calibration_change.h"
#include "byre/map/mapped_tag.h"
#include "byre/map/stored_calibration.h"
#include "byre/slam/upkeep/place_budget.h"

#include <algorithm>

#include <fmt/format.h>

namespace byre {
namespace {

constexpr double kMillisecondsPerSecond = 1e3;

// The second executor of a mission searches places in the offline map.
SessionExecutors make_lanes(Pace pace, bool is_mission, JobLog& log) {
  switch (pace) {
    case Pace::same_thread:
      return {make_logged_executor(make_inline_executor(), log), make_inline_executor()};
    case Pace::paced:
      return {make_logged_executor(make_paced_executor(kPacedLatency), log),
              make_paced_executor(is_mission ? kPacedSearchLatency : kPacedCorrectionLatency), make_inline_executor(),
              make_paced_executor(1)};
    case Pace::live:
      return {make_logged_executor(make_live_executor(), log), make_live_executor(), make_inline_executor(),
              make_live_executor()};
  }
  return {nullptr, nullptr};
}

const std::vector<SourceRecording>& earlier_recordings(const SlamInputs& inputs) {
  return inputs.offline ? inputs.offline->recordings() : inputs.extended.recordings;
}

OdometryCalibration initial_extrinsics(const Calibration& given, const SlamInputs& inputs) {
  const OdometryCalibration extrinsics =
      inputs.offline ? inputs.offline->extrinsics() : read_odometry_calibration(inputs.extended.notes);
  return odometry_calibration_for(extrinsics, earlier_recordings(inputs), given);
}

// The camera as the body, with extrinsics measured by hand.
WheelCalibration wheel_calibration_of(const Extrinsics& extrinsics) {
  const SensorMounting& camera = *extrinsics.camera;
  WheelCalibration measured = unknown_wheel_calibration();
  measured.base_from_body = camera.base_from_sensor;
  measured.metres_per_unit = 1.0 / extrinsics.wheel_scale;
  Eigen::Matrix<double, 7, 1> sigmas;
  sigmas.head<3>().setConstant(camera.sigma_rad);
  sigmas.segment<3>(3).setConstant(camera.sigma_m);
  sigmas[6] = extrinsics.wheel_scale_sigma;
  measured.covariance.topLeftCorner<7, 7>() = sigmas.cwiseAbs2().asDiagonal();
  return measured;
}

// Other cameras than those of the map may be mounted at another height or tilt.
SessionOptions session_options(const Calibration& given, const MethodOptions& options, const SlamInputs& inputs) {
  SessionOptions session = options.session;
  const std::vector<SourceRecording>& earlier = earlier_recordings(inputs);
  if (!inputs.offline) session.recording = static_cast<int>(earlier.size());
  if (inputs.extrinsics) {
    session.monocular_start.is_scaled_by_odometry = true;
    session.monocular_start.lever_arm_sigma = inputs.extrinsics->camera->sigma_m;
  }
  if (inputs.offline && !earlier.empty() && !has_same_cameras(earlier, given)) {
    session.mission.bounds.is_on_ground_of_map = false;
  }
  return session;
}

std::vector<TagFamily> tag_families(const SlamInputs& inputs) {
  std::vector<MappedTag> of_maps;
  for (const MissionMap& map : inputs.maps) {
    of_maps.insert(of_maps.end(), map.offline->tags().begin(), map.offline->tags().end());
  }
  return inputs.offline ? families_of(of_maps) : families_of(inputs.tags);
}

// Missions keep no pictures.
ExtractOptions extract_options(const MethodOptions& options, const SlamInputs& inputs) {
  ExtractOptions extract = options.extract;
  extract.picture = options.keep_pictures && !inputs.offline;
  return extract;
}

// Often in mapping, as only tags in keyframes are mapped.
Timestamp tag_interval(const SlamInputs& inputs) {
  return std::chrono::milliseconds(inputs.offline ? 250 : 60);
}

}  // namespace

std::string_view name_of(Pace pace) {
  return name_among<Pace::live>({"inline", "paced", "live"}, pace);
}

SlamImpl::SlamImpl(const Calibration& given, const MethodOptions& options, SlamInputs inputs,
                   const InputCheckOptions& check)
    : given_(given),
      options_(options),
      inputs_(std::move(inputs)),
      is_extended_(inputs_.before.has_value()),
      body_from_left_(given.body_from_left.rotation),
      initial_calibration_(stored_calibration(earlier_recordings(inputs_), given)),
      extractor_(initial_calibration_ ? initial_calibration_->calibration : given, extract_options(options, inputs_),
                 tag_families(inputs_), tag_interval(inputs_)),
      check_(given, extractor_.rig(), check),
      prior_(options.motion_limits),
      is_metric_(given.is_metric() || inputs_.offline || is_extended_),
      budget_(options.frame_deadline_ms / kMillisecondsPerSecond) {
  if (options.use_saved_extrinsics) prior_.begin_with(initial_extrinsics(given, inputs_));
  prior_.assume_upright(body_from_left_ * -Eigen::Vector3d::UnitY(), body_from_left_ * Eigen::Vector3d::UnitZ());
  if (inputs_.extrinsics) begin_with_extrinsics(*inputs_.extrinsics);
  if (!inputs_.offline) prior_.enable_mapping_mode();
  if (is_metric_) prior_.set_metric();
  if (inputs_.offline) begin_site();
  begin_session(extractor_.rig());
  if (options.self_calibrate) refine_calibration();
  if (is_extended_) session_->continue_map(std::move(*inputs_.before));
}

void SlamImpl::begin_session(const Rig& rig) {
  session_.emplace(rig, session_options(given_, options_, inputs_),
                   make_lanes(options_.pace, inputs_.offline != nullptr, log_),
                   options_.close_loops ? inputs_.vocabulary : std::nullopt, inputs_.offline);
  session_->set_odometry([this](Timestamp earlier, Timestamp later) { return prior_.path_between(earlier, later); },
                         [this, is_metric = given_.is_metric()](Timestamp earlier, Timestamp later) {
                           return prior_.reach(earlier, later, is_metric);
                         });
}

// Refines only the readout time if the calibration is refined already, or an extended map depends on it.
void SlamImpl::refine_calibration() {
  if (initial_calibration_ || is_extended_) {
    session_->refine_readout(initial_calibration_.value_or(RefinedCalibration{given_}));
  } else {
    session_->refine_calibration(given_, options_.self_calibration);
  }
}

void SlamImpl::begin_with_extrinsics(const Extrinsics& extrinsics) {
  const Pose left_from_body = inverse(given_.body_from_left);
  OdometryCalibration measured;
  measured.wheels = wheel_calibration_of(extrinsics);
  measured = moved(measured, left_from_body);
  prior_.begin_with_extrinsics(*measured.wheels, extrinsics.wheel_delay);
  if (!extrinsics.imu) return;
  const Eigen::Quaterniond left_from_base = extrinsics.camera->base_from_sensor.rotation.conjugate();
  prior_.set_gyroscope_extrinsics(body_from_left_ * left_from_base * extrinsics.imu->base_from_sensor.rotation);
}

void SlamImpl::set_gyro_extrinsics(const Eigen::Quaterniond& left_from_gyroscope) {
  if (inputs_.extrinsics && inputs_.extrinsics->imu) return;
  prior_.set_gyroscope_extrinsics(body_from_left_ * left_from_gyroscope);
}

FrameReport SlamImpl::process(const CameraImages& images, const std::optional<BodyMotion>& motion) {
  const InputFault fault = is_finished_ ? check_.note(InputFault::after_finishing) : check_.note(images);
  const auto since = take_motion(motion, images.left.time, is_dropped(fault));
  if (is_dropped(fault)) return dropped(images.left.time);
  buffer_.time = images.left.time;
  copy_grey(images.left, buffer_.left);
  const bool has_right = check_.may_use_right();
  if (!has_right) buffer_.right.reset();
  if (has_right) copy_grey(*images.right, buffer_.right ? *buffer_.right : buffer_.right.emplace());
  const bool has_depth = check_.may_use_depth();
  if (!has_depth) buffer_.depth.reset();
  if (has_depth) {
    copy_depth(*images.depth, given_.depth->units_per_metre, buffer_.depth ? *buffer_.depth : buffer_.depth.emplace());
  }
  return process_images(buffer_, since);
}

FrameReport SlamImpl::process(const ImageFrame& images, const std::optional<BodyMotion>& motion) {
  const InputFault fault = is_finished_ ? check_.note(InputFault::after_finishing) : check_.note(view_of(images));
  const bool are_all_usable =
      images.right.has_value() == check_.may_use_right() && images.depth.has_value() == check_.may_use_depth();
  const auto since = take_motion(motion, images.time, is_dropped(fault));
  if (is_dropped(fault)) return dropped(images.time);
  if (are_all_usable) return process_images(images, since);
  ImageFrame usable = images;
  if (!check_.may_use_right()) usable.right.reset();
  if (!check_.may_use_depth()) usable.depth.reset();
  return process_images(usable, since);
}

FrameReport SlamImpl::process(const Frame& frame, const std::optional<BodyMotion>& motion) {
  const InputFault fault = is_finished_ ? check_.note(InputFault::after_finishing) : check_.note(frame);
  const auto since = take_motion(motion, frame.time, is_dropped(fault));
  if (is_dropped(fault)) return dropped(frame.time);
  budget_.begin();
  const Stopwatch watch;
  FrameReport report = process_in_time(frame, since);
  seconds_ = {.track = report.track_seconds, .map = report.map_seconds, .total = watch.seconds()};
  return completed(std::move(report));
}

FrameReport SlamImpl::skip(Timestamp time, const std::optional<BodyMotion>& motion) {
  const InputFault fault = check_.note(InputFault::replaced);
  take_motion(motion, time, is_dropped(fault));
  return dropped(time);
}

void SlamImpl::submit(Timestamp time, std::function<FrameReport()> process, ReportCallback on_report,
                      const std::optional<BodyMotion>& motion) {
  calls_.rethrow_failure();
  const auto report = std::make_shared<ReportCallback>(std::move(on_report));
  const auto task = [report](const std::function<FrameReport()>& frame) {
    return [report, frame] {
      const FrameReport result = frame();
      if (*report) (*report)(result);
    };
  };
  calls_.submit(task(std::move(process)), task([this, time, motion] { return skip(time, motion); }),
                static_cast<std::size_t>(inputs_.max_waiting));
}

std::optional<BodyMotion> SlamImpl::checked(const std::optional<BodyMotion>& motion, Timestamp time) {
  if (!motion) return {};
  return prior_.checked(*motion, time, last_frame_ ? to_seconds(time) - to_seconds(*last_frame_) : 0.0);
}

std::optional<BodyMotion> SlamImpl::take_motion(const std::optional<BodyMotion>& motion, Timestamp time,
                                                bool is_dropped) {
  const std::optional<BodyMotion> sound = checked(motion, time);
  // Metric priors need a metric map.
  const auto since = is_metric_ && dropped_motion_ && sound ? std::optional(*dropped_motion_ * *sound) : std::nullopt;
  dropped_motion_ = is_dropped ? since : no_motion();
  return since;
}

FrameReport SlamImpl::process_images(const ImageFrame& images, const std::optional<BodyMotion>& motion) {
  const double submit_seconds_before = log_.submit_seconds;
  const Stopwatch watch;
  budget_.begin();
  const bool is_left_alone = images.right && !budget_.has_time_for_right_image();
  const Extraction extraction = extractor_.extract(images, is_left_alone ? ImagesUsed::left : ImagesUsed::all);
  if (extraction.frame.right_condition) row_error_.note(*extraction.frame.features, extractor_.rig());
  FrameReport report = process_in_time(extraction.frame, motion);
  seconds_ = {.rectify = extraction.times.rectify,
              .extract = extraction.times.extract,
              .stereo = extraction.times.stereo,
              .track = report.track_seconds,
              .map = report.map_seconds,
              .map_submit = log_.submit_seconds - submit_seconds_before,
              .total = watch.seconds()};
  return completed(std::move(report));
}

FrameReport SlamImpl::process_in_time(const Frame& frame, const std::optional<BodyMotion>& motion) {
  log_.job_seconds.clear();
  const bool uses_samples = !motion && !prior_.is_empty();
  const Timestamp since = last_frame_.value_or(frame.time);  // the first frame is where the measured path begins
  const auto measured_motion = uses_samples ? prior_.between(since, frame.time) : motion;
  session_->set_tilt(uses_samples ? prior_.tilt(frame.time) : std::nullopt);
  if (measured_motion || !prior_.is_empty()) session_->require_odometry();
  FrameReport report = session_->process(frame, measured_motion, &budget_);
  last_frame_ = frame.time;
  const auto next_map = inputs_.offline ? choose_map(frame, report) : std::nullopt;
  const bool is_begun = std::ranges::find(report.events, SessionEvent::initialised) != report.events.end();
  if (is_begun && session_->contradicts_odometry()) prior_.reject_extrinsics(frame.time);
  if (is_begun && !is_metric_) begin_wheels();
  const bool is_seen = report.inliers > 0;
  if (!given_.is_metric() && prior_.has_wheels()) prior_.set_focal_change(focal_change());
  prior_.note(frame.time, is_seen ? report.odometry_from_body : std::nullopt);
  if (is_seen && report.map_from_body && report.health.verdict == Verdict::trusted) {
    prior_.note_place(*report.map_from_body);
  }
  if (map_damage() != nullptr) {
    report.health.verdict = Verdict::untrusted;
    report.health.doubt = DistrustReason::map_damaged;
  }
  note_moved_tags(report);
  if (inputs_.offline) record_pose(frame, report);
  budget_.end();
  report.cuts = budget_.cuts();
  report.is_late = budget_.is_late();
  const auto first_new = warnings().begin() + static_cast<std::ptrdiff_t>(warnings_reported_);
  report.warnings.assign(first_new, warnings().end());
  warnings_reported_ = warnings().size();
  if (next_map) change_map(*next_map, report);
  return report;
}

// Thins out older poses of long missions evenly.
void SlamImpl::record_pose(const Frame& frame, const FrameReport& report) {
  constexpr std::size_t kMaxPoses = 7200;
  std::vector<PoseRecord>& poses = record_.poses;
  ++record_.frames;
  record_.trusted += report.health.verdict == Verdict::trusted;
  if (!report.map_from_body || (!poses.empty() && report.time - poses.back().time < record_spacing_)) return;
  PoseRecord& pose = poses.emplace_back();
  pose.time = report.time;
  pose.map_from_body = *report.map_from_body;
  std::size_t next = 0;
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) {
      pose.covariance[next++] = static_cast<float>(report.covariance(row, column));
    }
  }
  pose.verdict = static_cast<std::uint8_t>(report.health.verdict);
  pose.image = frame.condition.value_or(ImageCondition{});
  if (poses.size() < kMaxPoses) return;
  for (std::size_t i = 0; 2 * i < poses.size(); ++i) poses[i] = poses[2 * i];
  poses.resize(poses.size() / 2);
  record_spacing_ *= 2;
}

FrameReport SlamImpl::completed(FrameReport report) {
  report.input = check_.last();
  state_ = report.state;
  had_pose_ = had_pose_ || report.map_from_body;
  if (!first_time_) first_time_ = report.time;
  last_time_ = report.time;
  return report;
}

FrameReport SlamImpl::dropped(Timestamp time) {
  log_.job_seconds.clear();
  seconds_ = {};
  FrameReport report;
  report.time = time;
  report.state = state_;
  report.input = check_.last();
  return report;
}

void SlamImpl::note_moved_tags(const FrameReport& report) {
  for (const MappedTag& tag : report.moved_tags) {
    moved_tags_.push_back(tag.id);
    const MappedTag& mapped = *std::ranges::find(inputs_.offline->tags(), tag.id, &MappedTag::id);
    const double distance = (tag.map_from_tag.translation - mapped.map_from_tag.translation).norm();
    prior_.warn({MotionSensor::tags, report.time,
                 fmt::format("{} is {:.2f} m from its place in the map; it is ignored", to_string(tag.id), distance),
                 "hang it at its place, remove a copy, or map again"});
  }
}

std::optional<FinishResult> SlamImpl::finish(const FinishHooks& hooks) {
  if (std::exchange(is_finished_, true)) return {};
  if (hooks.should_stop() || map_damage() != nullptr) finish_early();
  session_->finish();
  const bool is_mapped = had_pose_ && online().keyframe_count() > 0;
  if (hooks.should_stop() || !is_mapped || map_damage() != nullptr) return {};
  if (!inputs_.offline && (!options_.close_loops || !inputs_.vocabulary)) return {};
  const Stopwatch watch;
  FinishResult result;
  if (inputs_.offline) {
    session_->finish_mission(hooks);
  } else {
    extractor_.rest();
    result.report = session_->finish_map(hooks);
    if (prior_.reestimate(session_->final_trajectory(), true)) {
      result.report.add(session_->finish_map(hooks));
      prior_.reestimate(session_->final_trajectory(), false);
    }
    if (!given_.is_metric()) warn_of_focal_length();
    if (!is_metric_) scale_by_tags();
    if (!is_metric_) scale_by_wheels();
    if (is_metric_) {
      for (const MotionWarning& warning : map_tags(online(), inputs_.tags).warnings) prior_.warn(warning);
    }
    result.cut_short = hooks.should_stop();
  }
  result.seconds = watch.seconds();
  return result;
}

std::optional<RefinedCalibration> SlamImpl::calibration() const {
  const auto refined = session_->self_calibration();
  return refined ? refined : initial_calibration_;
}

StoredMap SlamImpl::stored_metadata() const {
  StoredMap stored = inputs_.extended;
  stored.scale = is_metric_ ? MapScale::metric : MapScale::unknown;
  stored.recordings.push_back(
      {inputs_.recording, given_, first_time_.value_or(Timestamp{}), last_time_, calibration()});
  write_odometry_calibration(prior_.calibration_to_store(), stored.notes);
  std::vector<MappedTag> tags;
  if (inputs_.offline) tags = inputs_.offline->tags();
  if (!inputs_.offline && is_metric_) tags = map_tags(online(), inputs_.tags).tags;
  std::erase_if(tags, [this](const MappedTag& tag) { return std::ranges::count(moved_tags_, tag.id) > 0; });
  write_tags(tags, stored.notes);
  if (scale_sigma_ && !is_scaled_by_tags_) stored.notes[kMetresNote] = metres_note(*scale_sigma_);
  return stored;
}

StoredMap SlamImpl::stored_map() const {
  const MapView map = session_->map();
  StoredMap stored = stored_metadata();
  stored.map = map.offline() ? offline_copy(standalone_copy(map)) : offline_copy(session_->joined_online());
  return stored;
}

std::pair<StoredMap, SessionRecord> SlamImpl::session_to_store() const {
  constexpr int kMaxKeyframes = 75;  // 4 MB of images of 752x480
  MapGraph thin = online();
  thin_out(thin, kMaxKeyframes);
  MapGraph map = standalone_copy(MapView(session_->map().offline(), thin));
  SessionRecord record = record_;
  record.map_id = inputs_.maps[active_->index()].id;
  record.points = session_->point_records();
  record.copied_points = static_cast<std::uint32_t>(map.point_count() - thin.point_count());
  StoredMap stored = stored_metadata();
  stored.map = offline_copy(std::move(map));
  return {std::move(stored), std::move(record)};
}

StoredMap SlamImpl::take_stored_map() {
  if (session_->map().offline()) return stored_map();
  StoredMap stored = stored_metadata();
  stored.map = offline_copy(session_->take_online());
  return stored;
}

}  // namespace byre
