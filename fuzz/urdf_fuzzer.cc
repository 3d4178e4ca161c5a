// Reads any text as a URDF: the extrinsics must be finite and of unit rotations, or be refused by an InputError.

#include "byre/input_error.h"
#include "byre/io/calibration/frame_tree.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string_view>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace {

// Valid start of mutations.
constexpr std::string_view kRobot =
    "<robot name=\"r\"><link name=\"base_link\"/><link name=\"mast\"/><link name=\"imu_link\"/>"
    "<link name=\"left_optical_frame\"/><link name=\"right_optical_frame\"/>"
    "<joint name=\"a\" type=\"fixed\"><parent link=\"base_link\"/><child link=\"mast\"/>"
    "<origin xyz=\"0.4 0.1 1e-1\" rpy=\"0 -.2 3\"/></joint>"
    "<joint name=\"b\" type=\"fixed\"><parent link=\"mast\"/><child link=\"left_optical_frame\"/></joint>"
    "<joint name=\"c\" type=\"revolute\"><parent link=\"mast\"/><child link=\"right_optical_frame\"/></joint>"
    "<joint name=\"d\" type=\"fixed\"><parent link=\"mast\"/><child link=\"imu_link\"/></joint></robot>";

bool is_sound(const std::optional<byre::SensorMounting>& mounting) {
  if (!mounting) return true;
  const byre::Pose& pose = mounting->base_from_sensor;
  return pose.translation.norm() <= 20.0 && std::abs(pose.rotation.norm() - 1.0) < 1e-9;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const std::string text(reinterpret_cast<const char*>(data), size);
    const byre::Extrinsics extrinsics = byre::extrinsics_of(byre::parse_urdf(text, "fuzz.urdf"), {});
    if (!extrinsics.camera || !is_sound(extrinsics.camera) || !is_sound(extrinsics.imu)) std::abort();
  } catch (const byre::InputError&) {
  }
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned int /*seed*/) {
  constexpr std::size_t kSmallest = 24;
  if (size < kSmallest) {
    size = std::min(kRobot.size(), max_size);
    std::memcpy(data, kRobot.data(), size);
  }
  return LLVMFuzzerMutate(data, size, max_size);
}
