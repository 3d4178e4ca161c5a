#include "byre/camera/frame_sink.h"

#include "byre/base/output_file.h"
#include "byre/camera/still_image.h"
#include "byre/input_error.h"
#include "byre/io/bag/mcap_writer.h"
#include "byre/io/recording/euroc.h"
#include "byre/playback/report/ros_report.h"

#include <cassert>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace byre {
namespace {

namespace fs = std::filesystem;

// A camera's folder of a EuRoC recording. An image is listed after its file is complete.
class EurocCamera {
 public:
  explicit EurocCamera(fs::path folder) : folder_(std::move(folder)) {
    std::error_code error;
    fs::create_directories(folder_ / "data", error);
    list_.emplace(folder_ / "data.csv", FileContent::table);
    list_->append("#timestamp [ns],filename\n");
    list_->publish();
  }

  void write_image(const Image& image, Timestamp time) const {
    const std::vector<std::uint8_t> bytes = png_of(image);
    write_atomically(folder_ / "data" / name_of(time), std::as_bytes(std::span(bytes)), Durability::unsynced);
  }

  void list(Timestamp time) { list_->append(std::to_string(time.count()) + "," + name_of(time) + "\n"); }

 private:
  static std::string name_of(Timestamp time) { return std::to_string(time.count()) + ".png"; }

  fs::path folder_;  // constant after construction
  std::optional<OutputFile> list_;
};

class EurocSink final : public FrameSink {
 public:
  EurocSink(const fs::path& folder, const RecordedCameras& cameras) : left_(new_camera(folder / "mav0" / "cam0")) {
    const fs::path mav = folder / "mav0";
    if (cameras.has_right) right_.emplace(new_camera(mav / "cam1"));
    if (!cameras.calibration) return;
    const Calibration& calibration = *cameras.calibration;
    write_sensor(mav / "cam0", {calibration.left, calibration.body_from_left, calibration.readout_time}, cameras);
    if (!cameras.has_right) return;
    assert(calibration.right);
    write_sensor(mav / "cam1",
                 {calibration.right->camera, calibration.body_from_left * inverse(calibration.right->right_from_left),
                  calibration.readout_time},
                 cameras);
  }

  void write(const ImageFrame& frame) override {
    left_.write_image(frame.left, frame.time);
    const bool is_pair = right_ && frame.right;
    if (is_pair) right_->write_image(*frame.right, frame.time);
    if (is_pair) right_->list(frame.time);
    left_.list(frame.time);
  }

 private:
  static fs::path new_camera(const fs::path& folder) {
    if (!fs::exists(folder / "data.csv")) return folder;
    throw InputError(folder.string(), "already contains a recording", "name another folder");
  }

  static void write_sensor(const fs::path& folder, const EurocSensor& sensor, const RecordedCameras& cameras) {
    write_atomically(folder / "sensor.yaml",
                     write_euroc_sensor(sensor, cameras.rate_hz, "recorded by byre " BYRE_VERSION));
  }

  EurocCamera left_;
  std::optional<EurocCamera> right_;
};

class McapSink final : public FrameSink {
 public:
  McapSink(const fs::path& path, const RecordedCameras& cameras)
      : writer_(path), calibration_(cameras.calibration), left_(add_camera("/left")) {
    if (cameras.has_right) right_ = add_camera("/right");
    if (calibration_) mounts_ = writer_.add(ros::topic_of<ros::TFMessage>("/tf_static", ros::Durability::latched));
  }

  void write(const ImageFrame& frame) override {
    constexpr Timestamp kFlushInterval = std::chrono::seconds(1);
    if (!last_flush_ && calibration_)
      writer_.put_message(*mounts_, frame.time, ros_camera_extrinsics(*calibration_, frame.time));
    write_image(left_, frame.left, calibration_ ? &calibration_->left : nullptr, kLeftFrame, frame.time);
    if (right_ && frame.right) {
      write_image(*right_, *frame.right, calibration_ ? &calibration_->right->camera : nullptr, kRightFrame,
                  frame.time);
    }
    if (last_flush_ && frame.time - *last_flush_ < kFlushInterval) return;
    writer_.flush();
    last_flush_ = frame.time;
  }

  void finish() override { writer_.close(); }

 private:
  struct Topics {
    std::uint16_t image = 0;
    std::optional<std::uint16_t> info{};  // only for a calibrated camera
  };

  Topics add_camera(const std::string& name) {
    Topics topics{writer_.add(ros::topic_of<ros::Image>(name + "/image_raw"))};
    if (calibration_) topics.info = writer_.add(ros::topic_of<ros::CameraInfo>(name + "/camera_info"));
    return topics;
  }

  void write_image(const Topics& topics, const Image& image, const Camera* camera, const char* frame, Timestamp time) {
    writer_.put_message(topics.image, time, ros_image(image, frame, time));
    if (camera != nullptr) writer_.put_message(*topics.info, time, ros_camera_info(*camera, frame, time));
  }

  McapWriter writer_;
  std::optional<Calibration> calibration_;  // constant after construction
  Topics left_;
  std::optional<Topics> right_;
  std::optional<std::uint16_t> mounts_;
  std::optional<Timestamp> last_flush_;
};

}  // namespace

std::unique_ptr<FrameSink> open_sink(const fs::path& path, const RecordedCameras& cameras) {
  if (path.extension() == ".mcap") return std::make_unique<McapSink>(path, cameras);
  return std::make_unique<EurocSink>(path, cameras);
}

}  // namespace byre
