#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

// ROS messages used by byre. Each lists the names of its fields, separated by spaces, and the fields, in wire order,
// for reading, writing and its definition (message_schema.h). Frames, units and signs are those of REP-103 and REP-105.
namespace byre::ros {

// Usually since 1970.
struct Time {
  static constexpr std::string_view kType = "builtin_interfaces/msg/Time";
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
  static void fields(auto& self, auto& visit) { visit("sec nanosec", self.sec, self.nanosec); }
};

std::chrono::nanoseconds to_nanoseconds(const Time& time);
Time to_time(std::chrono::nanoseconds time);  // seconds are truncated to 32 bits

struct Header {
  static constexpr std::string_view kType = "std_msgs/msg/Header";
  Time stamp{};
  std::string frame_id{};
  std::uint32_t seq = 0;  // message counter, ROS 1 only
  static void fields(auto& self, auto& visit) {
    visit.ros1_only(self.seq);
    visit("stamp frame_id", self.stamp, self.frame_id);
  }
};

struct String {
  static constexpr std::string_view kType = "std_msgs/msg/String";
  std::string data{};
  static void fields(auto& self, auto& visit) { visit("data", self.data); }
};

struct Point {
  static constexpr std::string_view kType = "geometry_msgs/msg/Point";
  double x = 0.0, y = 0.0, z = 0.0;
  static void fields(auto& self, auto& visit) { visit("x y z", self.x, self.y, self.z); }
};

struct Vector3 {
  static constexpr std::string_view kType = "geometry_msgs/msg/Vector3";
  double x = 0.0, y = 0.0, z = 0.0;
  static void fields(auto& self, auto& visit) { visit("x y z", self.x, self.y, self.z); }
};

struct Quaternion {
  static constexpr std::string_view kType = "geometry_msgs/msg/Quaternion";
  double x = 0.0, y = 0.0, z = 0.0, w = 1.0;
  static void fields(auto& self, auto& visit) { visit("x y z w", self.x, self.y, self.z, self.w); }
};

struct Pose {
  static constexpr std::string_view kType = "geometry_msgs/msg/Pose";
  Point position{};
  Quaternion orientation{};
  static void fields(auto& self, auto& visit) { visit("position orientation", self.position, self.orientation); }
};

struct PoseStamped {
  static constexpr std::string_view kType = "geometry_msgs/msg/PoseStamped";
  Header header{};
  Pose pose{};
  static void fields(auto& self, auto& visit) { visit("header pose", self.header, self.pose); }
};

struct PoseWithCovariance {
  static constexpr std::string_view kType = "geometry_msgs/msg/PoseWithCovariance";
  Pose pose{};
  std::array<double, 36> covariance{};  // x, y, z, then rotations about the parent's fixed axes; row-major
  static void fields(auto& self, auto& visit) { visit("pose covariance", self.pose, self.covariance); }
};

struct PoseWithCovarianceStamped {
  static constexpr std::string_view kType = "geometry_msgs/msg/PoseWithCovarianceStamped";
  Header header{};
  PoseWithCovariance pose{};
  static void fields(auto& self, auto& visit) { visit("header pose", self.header, self.pose); }
};

struct Twist {
  static constexpr std::string_view kType = "geometry_msgs/msg/Twist";
  Vector3 linear{};   // m/s
  Vector3 angular{};  // rad/s
  static void fields(auto& self, auto& visit) { visit("linear angular", self.linear, self.angular); }
};

struct TwistWithCovariance {
  static constexpr std::string_view kType = "geometry_msgs/msg/TwistWithCovariance";
  Twist twist{};
  std::array<double, 36> covariance{};  // linear, then angular; row-major
  static void fields(auto& self, auto& visit) { visit("twist covariance", self.twist, self.covariance); }
};

struct TwistStamped {
  static constexpr std::string_view kType = "geometry_msgs/msg/TwistStamped";
  Header header{};
  Twist twist{};  // motion of the header's frame, in its own axes
  static void fields(auto& self, auto& visit) { visit("header twist", self.header, self.twist); }
};

struct TwistWithCovarianceStamped {
  static constexpr std::string_view kType = "geometry_msgs/msg/TwistWithCovarianceStamped";
  Header header{};
  TwistWithCovariance twist{};  // motion of the header's frame, in its own axes
  static void fields(auto& self, auto& visit) { visit("header twist", self.header, self.twist); }
};

struct Transform {
  static constexpr std::string_view kType = "geometry_msgs/msg/Transform";
  Vector3 translation{};
  Quaternion rotation{};
  static void fields(auto& self, auto& visit) { visit("translation rotation", self.translation, self.rotation); }
};

// Transform from the child frame to the header's frame.
struct TransformStamped {
  static constexpr std::string_view kType = "geometry_msgs/msg/TransformStamped";
  Header header{};
  std::string child_frame_id{};
  Transform transform{};
  static void fields(auto& self, auto& visit) {
    visit("header child_frame_id transform", self.header, self.child_frame_id, self.transform);
  }
};

struct TFMessage {
  static constexpr std::string_view kType = "tf2_msgs/msg/TFMessage";
  std::vector<TransformStamped> transforms{};
  static void fields(auto& self, auto& visit) { visit("transforms", self.transforms); }
};

struct Odometry {
  static constexpr std::string_view kType = "nav_msgs/msg/Odometry";
  Header header{};
  std::string child_frame_id{};
  PoseWithCovariance pose{};    // pose of the child frame in the header's frame
  TwistWithCovariance twist{};  // motion in the child frame
  static void fields(auto& self, auto& visit) {
    visit("header child_frame_id pose twist", self.header, self.child_frame_id, self.pose, self.twist);
  }
};

struct Path {
  static constexpr std::string_view kType = "nav_msgs/msg/Path";
  Header header{};
  std::vector<PoseStamped> poses{};
  static void fields(auto& self, auto& visit) { visit("header poses", self.header, self.poses); }
};

struct MapMetaData {
  static constexpr std::string_view kType = "nav_msgs/msg/MapMetaData";
  Time map_load_time{};
  float resolution = 0.0f;   // m per cell
  std::uint32_t width = 0;   // cells
  std::uint32_t height = 0;  // cells
  Pose origin{};             // pose of the lower left corner of the first cell
  static void fields(auto& self, auto& visit) {
    visit("map_load_time resolution width height origin", self.map_load_time, self.resolution, self.width, self.height,
          self.origin);
  }
};

struct OccupancyGrid {
  static constexpr std::string_view kType = "nav_msgs/msg/OccupancyGrid";
  Header header{};
  MapMetaData info{};
  std::vector<std::int8_t> data{};  // rows from the bottom up; 0 free to 100 occupied, -1 unknown
  static void fields(auto& self, auto& visit) { visit("header info data", self.header, self.info, self.data); }
};

struct Image {
  static constexpr std::string_view kType = "sensor_msgs/msg/Image";
  Header header{};  // exposure time; optical frame of the camera: x right, y down, z forward
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::string encoding{};
  std::uint8_t is_bigendian = 0;
  std::uint32_t step = 0;  // bytes from one row to the next
  std::vector<std::uint8_t> data{};
  static void fields(auto& self, auto& visit) {
    visit("header height width encoding is_bigendian step data", self.header, self.height, self.width, self.encoding,
          self.is_bigendian, self.step, self.data);
  }
};

struct CompressedImage {
  static constexpr std::string_view kType = "sensor_msgs/msg/CompressedImage";
  Header header{};
  std::string format{};  // "jpeg", "png", or "bgr8; jpeg compressed bgr8"
  std::vector<std::uint8_t> data{};
  static void fields(auto& self, auto& visit) { visit("header format data", self.header, self.format, self.data); }
};

struct RegionOfInterest {
  static constexpr std::string_view kType = "sensor_msgs/msg/RegionOfInterest";
  std::uint32_t x_offset = 0, y_offset = 0;  // pixels
  std::uint32_t height = 0, width = 0;       // pixels; both zero: the whole image
  bool do_rectify = false;
  static void fields(auto& self, auto& visit) {
    visit("x_offset y_offset height width do_rectify", self.x_offset, self.y_offset, self.height, self.width,
          self.do_rectify);
  }
};

struct CameraInfo {
  static constexpr std::string_view kType = "sensor_msgs/msg/CameraInfo";
  Header header{};
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::string distortion_model{};
  std::vector<double> d{};     // distortion
  std::array<double, 9> k{};   // intrinsics of the raw image, row-major; all zero: uncalibrated
  std::array<double, 9> r{};   // rotation into the rectified frame
  std::array<double, 12> p{};  // projection of the rectified image; p[3] = -fx * baseline
  std::uint32_t binning_x = 0;
  std::uint32_t binning_y = 0;
  RegionOfInterest roi{};
  static void fields(auto& self, auto& visit) {
    visit("header height width distortion_model d k r p binning_x binning_y roi", self.header, self.height, self.width,
          self.distortion_model, self.d, self.k, self.r, self.p, self.binning_x, self.binning_y, self.roi);
  }
};

struct Imu {
  static constexpr std::string_view kType = "sensor_msgs/msg/Imu";
  Header header{};
  Quaternion orientation{};
  std::array<double, 9> orientation_covariance{};  // first element -1: no orientation
  Vector3 angular_velocity{};                      // rad/s
  std::array<double, 9> angular_velocity_covariance{};
  Vector3 linear_acceleration{};  // m/s^2, including gravity
  std::array<double, 9> linear_acceleration_covariance{};
  static void fields(auto& self, auto& visit) {
    visit(
        "header orientation orientation_covariance angular_velocity angular_velocity_covariance linear_acceleration "
        "linear_acceleration_covariance",
        self.header, self.orientation, self.orientation_covariance, self.angular_velocity,
        self.angular_velocity_covariance, self.linear_acceleration, self.linear_acceleration_covariance);
  }
};

struct PointField {
  static constexpr std::string_view kType = "sensor_msgs/msg/PointField";
  static constexpr std::string_view kConstants =
      "uint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\nuint8 UINT16=4\n"
      "uint8 INT32=5\nuint8 UINT32=6\nuint8 FLOAT32=7\nuint8 FLOAT64=8\n";
  static constexpr std::uint8_t kUint8 = 2, kUint32 = 6, kFloat32 = 7;
  std::string name{};
  std::uint32_t offset = 0;  // bytes from the start of the point
  std::uint8_t datatype = kFloat32;
  std::uint32_t count = 1;
  static void fields(auto& self, auto& visit) {
    visit("name offset datatype count", self.name, self.offset, self.datatype, self.count);
  }
};

struct PointCloud2 {
  static constexpr std::string_view kType = "sensor_msgs/msg/PointCloud2";
  Header header{};
  std::uint32_t height = 0;  // 1 for unordered points
  std::uint32_t width = 0;
  std::vector<PointField> point_fields{};  // named "fields" in the definition
  bool is_bigendian = false;
  std::uint32_t point_step = 0;  // bytes
  std::uint32_t row_step = 0;    // bytes
  std::vector<std::uint8_t> data{};
  bool is_dense = false;  // all points are valid
  static void fields(auto& self, auto& visit) {
    visit("header height width fields is_bigendian point_step row_step data is_dense", self.header, self.height,
          self.width, self.point_fields, self.is_bigendian, self.point_step, self.row_step, self.data, self.is_dense);
  }
};

struct KeyValue {
  static constexpr std::string_view kType = "diagnostic_msgs/msg/KeyValue";
  std::string key{};
  std::string value{};
  static void fields(auto& self, auto& visit) { visit("key value", self.key, self.value); }
};

struct DiagnosticStatus {
  static constexpr std::string_view kType = "diagnostic_msgs/msg/DiagnosticStatus";
  static constexpr std::string_view kConstants = "byte OK=0\nbyte WARN=1\nbyte ERROR=2\nbyte STALE=3\n";
  static constexpr std::byte kOk{0}, kWarn{1}, kError{2}, kStale{3};
  std::byte level = kOk;
  std::string name{};
  std::string message{};
  std::string hardware_id{};
  std::vector<KeyValue> values{};
  static void fields(auto& self, auto& visit) {
    visit("level name message hardware_id values", self.level, self.name, self.message, self.hardware_id, self.values);
  }
};

struct DiagnosticArray {
  static constexpr std::string_view kType = "diagnostic_msgs/msg/DiagnosticArray";
  Header header{};
  std::vector<DiagnosticStatus> status{};
  static void fields(auto& self, auto& visit) { visit("header status", self.header, self.status); }
};

}  // namespace byre::ros
