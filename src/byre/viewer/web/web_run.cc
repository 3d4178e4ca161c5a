#include "byre/viewer/web/web_run.h"

#include "byre/base/text_file.h"
#include "byre/features/rectify.h"
#include "byre/io/image/image_codec.h"
#include "byre/viewer/web/web_messages.h"

#include <algorithm>
#include <iterator>
#include <string_view>
#include <utility>

#include <opencv2/imgcodecs.hpp>

namespace byre {
namespace {

using Json = nlohmann::json;

constexpr std::string_view kImagesFolder = "/images/";
constexpr std::size_t kFramesAMessage = 500;
constexpr int kTimeBetweenCopies = 500;  // least time between copies of the online map, in durations of the last copy

std::string scene_text(const RunDescription& run, const Rig& rig) {
  Json map;
  if (!run.map_name.empty()) map = run.map_name;
  return dump_json({{"mode", "run"},
                    {"name", run.name},
                    {"map", map},
                    {"frames", run.frames},
                    {"camera", camera_fields(rig)},
                    {"up_in_map", fields_or_null(run.up_in_map, vector_fields)},
                    {"plan", fields_or_null(run.plan, plan_fields)},
                    {"registration", fields_or_null(run.registration, registration_fields)}});
}

// Keeps the history of a run for pages opened later.
class RunSite : public WebSite {
 public:
  RunSite(const RunDescription& run, const RunViewerOptions& options, std::shared_ptr<RunMailbox> mailbox)
      : rectifier_(run.calibration),
        jpeg_quality_(options.jpeg_quality),
        scene_(scene_text(run, rectifier_.rig())),
        offline_(map_bytes(run.offline)),
        plan_(run.plan ? plan_png(*run.plan) : ""),
        mailbox_(std::move(mailbox)),
        online_(map_bytes({})),
        images_(options.max_image_bytes) {}

  WebResponse answer(const WebRequest& request) override {
    if (request.path == "/") return page_response();
    if (request.path == "/scene") return {200, "application/json", scene_};
    if (request.path == "/map/offline") return bytes_response(offline_);
    if (request.path == "/map/online") return bytes_response(online_);
    if (request.path == "/plan.png" && !plan_.empty()) return bytes_response(plan_, "image/png");
    if (const std::string* const image = find_image(request.path)) return bytes_response(*image);
    return not_found(request);
  }

  void refresh() override {
    RunMailbox::Content content = mailbox_->take();
    for (const ShownFrame& frame : content.frames) frames_.push_back(dump_json(frame_fields(frame)));
    if (content.newest) add_image(*content.newest);
    if (content.online) {
      online_ = map_bytes(*content.online);
      ++map_count_;
    }
    has_ended_ = has_ended_ || content.has_ended;
  }

  std::optional<WebMessage> next_message(ListenerProgress& progress) override {
    if (progress.frames < frames_.size()) return next_frames(progress);
    if (progress.maps < map_count_) {
      progress.maps = map_count_;
      return WebMessage{R"({"online_map":)" + std::to_string(map_count_) + "}"};
    }
    if (progress.images < image_count_) {
      progress.images = image_count_;
      return WebMessage{*images_.find_nearest(frames_.size()), true};
    }
    if (has_ended_ && !progress.end_sent) {
      progress.end_sent = true;
      return WebMessage{R"({"ended":true})"};
    }
    return std::nullopt;
  }

 private:
  const std::string* find_image(std::string_view path) const {
    if (!path.starts_with(kImagesFolder)) return nullptr;
    const std::optional<std::size_t> frame = parse_whole<std::size_t>(path.substr(kImagesFolder.size()));
    return frame ? images_.find_nearest(*frame) : nullptr;
  }

  void add_image(FrameScene& scene) {
    Image& left = scene.left;
    const cv::Mat rectified = rectifier_.left(cv::Mat(left.height, left.width, CV_8UC1, left.pixels.data()));
    const std::vector<std::uint8_t> jpeg = encode_image(".jpg", rectified, {cv::IMWRITE_JPEG_QUALITY, jpeg_quality_});
    const std::size_t frame = frames_.size() - 1;
    images_.add(frame, image_bytes(frame, scene.seen, jpeg));
    ++image_count_;
  }

  WebMessage next_frames(ListenerProgress& progress) const {
    const std::size_t end = std::min(frames_.size(), progress.frames + kFramesAMessage);
    std::string text = R"({"frames":[)" + frames_[progress.frames];
    for (std::size_t i = progress.frames + 1; i < end; ++i) text += "," + frames_[i];
    progress.frames = end;
    return {text + "]}"};
  }

  // Constant after construction.
  Rectifier rectifier_;
  int jpeg_quality_;
  std::string scene_;
  std::string offline_;
  std::string plan_;  // PNG; empty without a plan
  std::shared_ptr<RunMailbox> mailbox_;

  // Owned by the server's thread.
  std::vector<std::string> frames_;  // JSON per frame
  std::string online_;
  std::size_t map_count_ = 0;  // online maps so far
  ImageStore images_;
  std::size_t image_count_ = 0;  // images so far, including dropped ones
  bool has_ended_ = false;
};

}  // namespace

void ImageStore::add(std::size_t frame, std::string bytes) {
  bytes_ += bytes.size();
  const auto [place, is_new] = images_.try_emplace(frame);
  bytes_ -= place->second.size();
  place->second = std::move(bytes);
  while (bytes_ > max_bytes_ && images_.size() > 2) thin_out();
}

void ImageStore::thin_out() {
  const std::size_t older = images_.size() / 2;
  auto image = images_.begin();
  for (std::size_t i = 0; i < older; i += 2) {
    ++image;  // keeps the first image
    bytes_ -= image->second.size();
    image = images_.erase(image);
  }
}

const std::string* ImageStore::find_nearest(std::size_t frame) const {
  if (images_.empty()) return nullptr;
  const auto after = images_.lower_bound(frame);
  if (after == images_.end()) return &images_.rbegin()->second;
  if (after == images_.begin() || after->first == frame) return &after->second;
  const auto before = std::prev(after);
  return frame - before->first <= after->first - frame ? &before->second : &after->second;
}

// Replaced values are freed outside the lock.

void RunMailbox::put(ShownFrame frame, FrameScene scene) {
  std::optional<FrameScene> incoming = std::move(scene);
  const std::lock_guard lock(mutex_);
  content_.frames.push_back(std::move(frame));
  content_.newest.swap(incoming);
}

void RunMailbox::put(MapScene online) {
  std::optional<MapScene> incoming = std::move(online);
  const std::lock_guard lock(mutex_);
  content_.online.swap(incoming);
}

void RunMailbox::put_end() {
  const std::lock_guard lock(mutex_);
  content_.has_ended = true;
}

RunMailbox::Content RunMailbox::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(content_, {});
}

RunViewer::RunViewer(RunDescription description, const RunViewerOptions& options)
    : map_interval_(options.map_interval),
      last_time_(description.last_time),
      mailbox_(std::make_shared<RunMailbox>()),
      topics_(std::make_shared<LiveTopics>()),
      server_(options.server, std::make_unique<RunSite>(description, options, mailbox_), topics_) {}

void RunViewer::show(const Image& recorded_left, const FrameReport& report, const Session& session) {
  const MapGraph& online = session.map().online();
  mailbox_->put({report, online.keyframe_count(), online.point_count()},
                {report, recorded_left, session.seen_points()});
  if (report.time == last_time_ || std::chrono::steady_clock::now() >= next_map_) copy_map(online);
  server_.wake();
}

void RunViewer::copy_map(const MapGraph& online) {
  const auto start = std::chrono::steady_clock::now();
  mailbox_->put(scene_of(online));
  const auto end = std::chrono::steady_clock::now();
  next_map_ = end + std::max<std::chrono::steady_clock::duration>(map_interval_, kTimeBetweenCopies * (end - start));
}

void RunViewer::end_run() {
  mailbox_->put_end();
  server_.wake();
}

}  // namespace byre
