// Files of a EuRoC recording (Burri 2016).

#include "byre/simulation/euroc_writer.h"

#include "byre/base/output_file.h"
#include "byre/io/image/image_codec.h"
#include "byre/io/recording/euroc.h"
#include "byre/trajectory_file.h"

#include <algorithm>
#include <iomanip>
#include <limits>
#include <sstream>
#include <string>

#include <opencv2/imgcodecs.hpp>

namespace byre {
namespace {

namespace fs = std::filesystem;

void make_folder_of(const fs::path& path) {
  std::error_code failure;
  fs::create_directories(path.parent_path(), failure);  // failures are reported when the file is written
}

std::ostringstream exact_text() {
  std::ostringstream text;
  text << std::setprecision(std::numeric_limits<double>::max_digits10);
  return text;
}

void write_text(const fs::path& path, const std::ostringstream& text) {
  make_folder_of(path);
  write_atomically(path, text.view());
}

// Precondition: a stereo calibration.
Pose body_from_right(const Calibration& calibration) {
  return calibration.body_from_left * inverse(calibration.right->right_from_left);
}

double mean_rate_hz(const std::vector<Timestamp>& times) {
  if (times.size() < 2) return 0.0;
  return static_cast<double>(times.size() - 1) / to_seconds(times.back() - times.front());
}

void write_sensor(const fs::path& path, const Camera& camera, const Pose& body_from_camera, double rate_hz) {
  make_folder_of(path);
  write_atomically(path, write_euroc_sensor({camera, body_from_camera}, rate_hz, "rendered"));
}

std::string image_name(Timestamp time) {
  return std::to_string(time.count()) + ".png";
}

void write_image_list(const fs::path& folder, const std::vector<Timestamp>& times) {
  const fs::path path = folder / "data.csv";
  std::ostringstream file = exact_text();
  file << "#timestamp [ns],filename\n";
  for (const Timestamp time : times) file << time.count() << "," << image_name(time) << "\n";
  write_text(path, file);
}

void write_camera(const fs::path& folder, const Camera& camera, const Pose& body_from_camera,
                  const std::vector<Timestamp>& times) {
  write_sensor(folder / "sensor.yaml", camera, body_from_camera, mean_rate_hz(times));
  write_image_list(folder, times);
  std::error_code failure;
  fs::create_directories(folder / "data", failure);
}

void write_recorded_image(const fs::path& folder, const Image& image, Timestamp time) {
  const fs::path path = folder / "data" / image_name(time);
  cv::Mat pixels(image.height, image.width, CV_8UC1);
  std::ranges::copy(image.pixels, pixels.data);
  constexpr int kFastest = 1;  // noise does not compress, so higher levels only cost time
  write_image_file(path, pixels, {cv::IMWRITE_PNG_COMPRESSION, kFastest});
}

// Velocity by central differences, metres per second.
Eigen::Vector3d velocity_in_world(const Trajectory& truth, std::size_t i) {
  const StampedPose& before = truth[i == 0 ? 0 : i - 1];
  const StampedPose& after = truth[std::min(i + 1, truth.size() - 1)];
  if (after.time == before.time) return Eigen::Vector3d::Zero();
  return (after.world_from_body.translation - before.world_from_body.translation) /
         to_seconds(after.time - before.time);
}

void write_truth(const fs::path& folder, const Trajectory& truth) {
  const fs::path path = folder / "data.csv";
  std::ostringstream file = exact_text();
  file << "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], "
          "v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1], b_w_RS_S_x [rad s^-1], b_w_RS_S_y [rad s^-1], "
          "b_w_RS_S_z [rad s^-1], b_a_RS_S_x [m s^-2], b_a_RS_S_y [m s^-2], b_a_RS_S_z [m s^-2]\n";
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const auto& [rotation, translation] = truth[i].world_from_body;
    const Eigen::Vector3d velocity = velocity_in_world(truth, i);
    file << truth[i].time.count();
    for (const double value : translation) file << "," << value;
    file << "," << rotation.w() << "," << rotation.x() << "," << rotation.y() << "," << rotation.z();
    for (const double value : velocity) file << "," << value;
    file << ",0,0,0,0,0,0\n";  // biases of gyroscope and accelerometer, unused
  }
  write_text(path, file);
}

}  // namespace

EurocWriter::EurocWriter(const Calibration& calibration, const std::vector<Timestamp>& times, const Trajectory& truth,
                         const fs::path& folder)
    : mav_(folder / "mav0") {
  write_camera(mav_ / "cam0", calibration.left, calibration.body_from_left, times);
  if (calibration.right) {
    write_camera(mav_ / "cam1", calibration.right->camera, body_from_right(calibration), times);
  }
  write_truth(mav_ / "state_groundtruth_estimate0", truth);
}

void write_motion(const MotionSamples& motion, const fs::path& folder) {
  write_trajectory(motion.wheels, folder / "wheel.txt");
  const fs::path imu = folder / "mav0" / "imu0", path = imu / "data.csv", axes = imu / "sensor.yaml";
  make_folder_of(axes);
  write_atomically(axes,
                   "sensor_type: imu\ncomment: rendered\nT_BS:\n  cols: 4\n  rows: 4\n"
                   "  data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\n");
  std::ostringstream file = exact_text();
  file << "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
          "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n";
  for (std::size_t i = 0; i < motion.rates.size(); ++i) {
    const auto& [time, rate] = motion.rates[i];
    const Eigen::Vector3d& acceleration = motion.accelerations[i].acceleration;
    file << time.count() << "," << rate.x() << "," << rate.y() << "," << rate.z() << "," << acceleration.x() << ","
         << acceleration.y() << "," << acceleration.z() << "\n";
  }
  write_text(path, file);
}

void write_true_calibration(const Calibration& calibration, const std::vector<Timestamp>& times,
                            const fs::path& folder) {
  const char* const name = "true_sensor.yaml";
  const fs::path mav = folder / "mav0";
  write_sensor(mav / "cam0" / name, calibration.left, calibration.body_from_left, mean_rate_hz(times));
  if (!calibration.right) return;
  write_sensor(mav / "cam1" / name, calibration.right->camera, body_from_right(calibration), mean_rate_hz(times));
}

void EurocWriter::write(const ImageFrame& frame) const {
  write_recorded_image(mav_ / "cam0", frame.left, frame.time);
  if (frame.right) write_recorded_image(mav_ / "cam1", *frame.right, frame.time);
}

}  // namespace byre
