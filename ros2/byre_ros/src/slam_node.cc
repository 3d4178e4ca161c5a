// byre as a lifecycle node and component of rclcpp: rectified or raw grey pairs in, poses and transforms out.
// `byre node` has more inputs, checks and diagnostics; this is for graphs with lifecycle management or intra-process
// communication.

#include <array>
#include <cstdint>
#include <exception>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <byre/byre.h>
#include <geometry_msgs/msg/pose_with_covariance_stamped.hpp>
#include <geometry_msgs/msg/transform_stamped.hpp>
#include <nav_msgs/msg/odometry.hpp>
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_components/register_node_macro.hpp>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <rclcpp_lifecycle/lifecycle_publisher.hpp>
#include <sensor_msgs/msg/image.hpp>
#include <tf2_msgs/msg/tf_message.hpp>

namespace byre_ros {
namespace {

using sensor_msgs::msg::Image;

constexpr double kUnknownVariance = 1e6;
constexpr std::size_t kMaxWaiting = 10;  // images without the other one of their pair

std::int64_t nanoseconds(const builtin_interfaces::msg::Time& stamp) {
  return std::int64_t{stamp.sec} * 1'000'000'000 + stamp.nanosec;
}

std::optional<byre::PixelFormat> format_of(const std::string& encoding) {
  if (encoding == "mono8" || encoding == "8UC1") return byre::PixelFormat::grey8;
  if (encoding == "bgr8") return byre::PixelFormat::bgr8;
  if (encoding == "rgb8") return byre::PixelFormat::rgb8;
  return std::nullopt;
}

// Empty for an unsupported encoding, and for fewer bytes than the image has.
std::optional<byre::ImageView> view_of(const Image& image) {
  const auto format = format_of(image.encoding);
  const std::size_t bytes_per_pixel = format == byre::PixelFormat::grey8 ? 1 : 3;
  if (!format || image.step < image.width * bytes_per_pixel ||
      image.data.size() < std::size_t{image.step} * image.height)
    return std::nullopt;
  byre::ImageView view;
  view.data = image.data.data();
  view.width = static_cast<int>(image.width);
  view.height = static_cast<int>(image.height);
  view.stride = image.step;
  view.format = *format;
  view.time = byre::Timestamp(nanoseconds(image.header.stamp));
  return view;
}

geometry_msgs::msg::Pose pose_message(const byre::Pose& pose) {
  geometry_msgs::msg::Pose message;
  message.position.x = pose.translation.x();
  message.position.y = pose.translation.y();
  message.position.z = pose.translation.z();
  message.orientation.x = pose.rotation.x();
  message.orientation.y = pose.rotation.y();
  message.orientation.z = pose.rotation.z();
  message.orientation.w = pose.rotation.w();
  return message;
}

// byre's covariances are in the axes of the body, those of ROS in the axes of the header's frame.
std::array<double, 36> covariance_message(const byre::Matrix6& in_body, const Eigen::Quaterniond& frame_from_body) {
  byre::Matrix6 turn = byre::Matrix6::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = frame_from_body.toRotationMatrix();
  const byre::Matrix6 in_frame = turn * in_body * turn.transpose();
  std::array<double, 36> message{};
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column)
      message[static_cast<std::size_t>(6 * row + column)] = in_frame(row, column);
  }
  return message;
}

geometry_msgs::msg::TransformStamped transform_message(const builtin_interfaces::msg::Time& stamp,
                                                       const std::string& parent, const std::string& child,
                                                       const byre::Pose& parent_from_child) {
  geometry_msgs::msg::TransformStamped message;
  message.header.stamp = stamp;
  message.header.frame_id = parent;
  message.child_frame_id = child;
  const geometry_msgs::msg::Pose pose = pose_message(parent_from_child);
  message.transform.translation.x = pose.position.x;
  message.transform.translation.y = pose.position.y;
  message.transform.translation.z = pose.position.z;
  message.transform.rotation = pose.orientation;
  return message;
}

}  // namespace

// Parameters: map (empty: makes a map), save, calibration (its body frame is base_frame), map_frame, odom_frame,
// base_frame, publish_odom_to_base. Topics: left/image_raw, right/image_raw with equal stamps; ~/odometry, ~/pose, /tf.
class SlamNode : public rclcpp_lifecycle::LifecycleNode {
 public:
  using CallbackReturn = rclcpp_lifecycle::node_interfaces::LifecycleNodeInterface::CallbackReturn;

  explicit SlamNode(const rclcpp::NodeOptions& options) : LifecycleNode("byre", options) {
    for (const char* const name : {"map", "save", "calibration"}) declare_parameter<std::string>(name, "");
    declare_parameter<std::string>("map_frame", "map");
    declare_parameter<std::string>("odom_frame", "odom");
    declare_parameter<std::string>("base_frame", "base_link");
    declare_parameter<bool>("publish_odom_to_base", true);
  }

  CallbackReturn on_configure(const rclcpp_lifecycle::State&) override {
    map_frame_ = text("map_frame");
    odom_frame_ = text("odom_frame");
    base_frame_ = text("base_frame");
    publishes_odom_to_base_ = get_parameter("publish_odom_to_base").as_bool();
    try {
      const byre::Calibration calibration = byre::read_calibration(text("calibration"));
      has_right_ = calibration.right.has_value();
      slam_.emplace(text("map").empty() ? byre::Slam::mapping(calibration)
                                        : byre::Slam::on_map(calibration, text("map")));
    } catch (const std::exception& error) {
      RCLCPP_ERROR(get_logger(), "%s", error.what());
      return CallbackReturn::FAILURE;
    }
    odometry_ = create_publisher<nav_msgs::msg::Odometry>("~/odometry", rclcpp::QoS(10));
    pose_ = create_publisher<geometry_msgs::msg::PoseWithCovarianceStamped>("~/pose", rclcpp::QoS(1).transient_local());
    transforms_ = create_publisher<tf2_msgs::msg::TFMessage>("/tf", rclcpp::QoS(100));
    return CallbackReturn::SUCCESS;
  }

  CallbackReturn on_activate(const rclcpp_lifecycle::State& state) override {
    LifecycleNode::on_activate(state);  // activates the publishers
    const auto subscribe = [this](const std::string& topic, Waiting& waiting) {
      return create_subscription<Image>(topic, rclcpp::SensorDataQoS(), [this, &waiting](Image::ConstSharedPtr image) {
        waiting[nanoseconds(image->header.stamp)] = std::move(image);
        process_pairs();
      });
    };
    left_ = subscribe("left/image_raw", lefts_);
    if (has_right_) right_ = subscribe("right/image_raw", rights_);
    return CallbackReturn::SUCCESS;
  }

  CallbackReturn on_deactivate(const rclcpp_lifecycle::State& state) override {
    left_.reset();
    right_.reset();
    lefts_.clear();
    rights_.clear();
    LifecycleNode::on_deactivate(state);
    return CallbackReturn::SUCCESS;
  }

  CallbackReturn on_cleanup(const rclcpp_lifecycle::State&) override { return release(); }
  CallbackReturn on_shutdown(const rclcpp_lifecycle::State&) override { return release(); }

 private:
  using Waiting = std::map<std::int64_t, Image::ConstSharedPtr>;

  std::string text(const std::string& name) const { return get_parameter(name).as_string(); }

  // Saves the map if a file is given.
  CallbackReturn release() {
    left_.reset();
    right_.reset();
    bool is_saved = true;
    if (slam_ && !text("save").empty()) {
      try {
        slam_->save(text("save"));
      } catch (const std::exception& error) {
        RCLCPP_ERROR(get_logger(), "%s", error.what());
        is_saved = false;
      }
    }
    slam_.reset();
    map_from_odom_.reset();
    odometry_.reset();
    pose_.reset();
    transforms_.reset();
    return is_saved ? CallbackReturn::SUCCESS : CallbackReturn::FAILURE;
  }

  void process_pairs() {
    while (!lefts_.empty()) {
      const Image::ConstSharedPtr left = lefts_.begin()->second;
      const std::int64_t stamp = lefts_.begin()->first;
      rights_.erase(rights_.begin(), rights_.lower_bound(stamp));
      const bool has_partner = !rights_.empty() && rights_.begin()->first == stamp;
      // A later right image shows that the one of this pair is lost.
      const bool is_alone = !has_right_ || !rights_.empty() || lefts_.size() > kMaxWaiting;
      if (!has_partner && !is_alone) return;
      lefts_.erase(lefts_.begin());
      Image::ConstSharedPtr right;
      if (has_partner) {
        right = rights_.begin()->second;
        rights_.erase(rights_.begin());
      }
      process(*left, right.get());
    }
    while (rights_.size() > kMaxWaiting) rights_.erase(rights_.begin());
  }

  void process(const Image& left, const Image* right) {
    constexpr int kLogInterval = 5000;  // milliseconds
    const auto left_view = view_of(left);
    const auto right_view = right == nullptr ? std::nullopt : view_of(*right);
    if (!left_view || (right != nullptr && !right_view)) {
      RCLCPP_ERROR_THROTTLE(get_logger(), *get_clock(), kLogInterval, "images of encoding %s are not supported",
                            left.encoding.c_str());
      return;
    }
    publish(left.header.stamp, slam_->process(byre::CameraImages{*left_view, right_view}));
  }

  void publish(const builtin_interfaces::msg::Time& stamp, const byre::FrameReport& report) {
    const bool is_trusted = report.map_from_body && report.health.verdict != byre::Verdict::untrusted;
    tf2_msgs::msg::TFMessage transforms;
    if (is_trusted) {
      geometry_msgs::msg::PoseWithCovarianceStamped message;
      message.header.stamp = stamp;
      message.header.frame_id = map_frame_;
      message.pose.pose = pose_message(*report.map_from_body);
      message.pose.covariance = covariance_message(report.covariance, report.map_from_body->rotation);
      pose_->publish(message);
    }
    if (report.odometry_from_body) {
      const byre::Pose& odom_from_base = *report.odometry_from_body;
      nav_msgs::msg::Odometry message;
      message.header.stamp = stamp;
      message.header.frame_id = odom_frame_;
      message.child_frame_id = base_frame_;
      message.pose.pose = pose_message(odom_from_base);
      message.pose.covariance = covariance_message(report.odometry_covariance, odom_from_base.rotation);
      for (std::size_t i = 0; i < 6; ++i) message.twist.covariance[7 * i] = kUnknownVariance;  // no twist
      odometry_->publish(message);
      if (publishes_odom_to_base_) {
        transforms.transforms.push_back(transform_message(stamp, odom_frame_, base_frame_, odom_from_base));
      }
      if (is_trusted) map_from_odom_ = *report.map_from_body * byre::inverse(odom_from_base);
    }
    // An untrusted pose keeps the last transform; a lost one withdraws it, so that navigation stops.
    if (report.state == byre::State::lost || report.has(byre::SessionEvent::navigation_error)) map_from_odom_.reset();
    if (map_from_odom_ && publishes_odom_to_base_) {
      transforms.transforms.push_back(transform_message(stamp, map_frame_, odom_frame_, *map_from_odom_));
    }
    if (!transforms.transforms.empty()) transforms_->publish(transforms);
  }

  std::string map_frame_, odom_frame_, base_frame_;  // constant while configured
  bool publishes_odom_to_base_ = true;               // constant while configured
  bool has_right_ = false;                           // constant while configured
  std::optional<byre::Slam> slam_;                   // empty while unconfigured
  std::optional<byre::Pose> map_from_odom_;
  Waiting lefts_, rights_;  // by stamp
  rclcpp::Subscription<Image>::SharedPtr left_, right_;
  rclcpp_lifecycle::LifecyclePublisher<nav_msgs::msg::Odometry>::SharedPtr odometry_;
  rclcpp_lifecycle::LifecyclePublisher<geometry_msgs::msg::PoseWithCovarianceStamped>::SharedPtr pose_;
  rclcpp_lifecycle::LifecyclePublisher<tf2_msgs::msg::TFMessage>::SharedPtr transforms_;
};

}  // namespace byre_ros

RCLCPP_COMPONENTS_REGISTER_NODE(byre_ros::SlamNode)
