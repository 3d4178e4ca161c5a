// Commands and parameters of byre node as services, called by Fast DDS with the request ids of rmw_cyclonedds.

#include "mqtt_peer.h"
#include "node_fixture.h"

#include <cstdint>

#include <gmock/gmock.h>

namespace byre::testing_ros2 {
namespace {

using testing::HasSubstr;

// Calls one service, and keeps only replies to itself, like ROS clients.
template <typename Request, typename RequestType, typename Response, typename ResponseType>
class Client {
 public:
  Client(FastPeer& peer, const std::string& service, std::uint64_t id)
      : id_(id),
        requests_(peer.writer("rq/byre/" + service + "Request", TypeSupport(new RequestType), kVolatile)),
        replies_(peer, "rr/byre/" + service + "Reply", kVolatile) {}

  bool has_subscriber() const { return FastPeer::has_subscriber(requests_); }

  std::optional<Response> call(Request request, std::chrono::seconds patience = std::chrono::seconds(20)) {
    request.client(id_);
    request.number(++number_);
    requests_->write(&request);
    return replies_.find(
        [&](const Response& response) { return response.client() == id_ && response.number() == number_; }, patience);
  }
  // Repeats a request without an effect, as DDS drops replies to readers that it has not discovered.
  std::optional<Response> ask(const Request& request) {
    std::optional<Response> response;
    for (int i = 0; i < 20 && !response; ++i) response = call(request, std::chrono::seconds(2));
    return response;
  }

 private:
  std::uint64_t id_;
  std::int64_t number_ = 0;
  eprosima::fastdds::dds::DataWriter* requests_;
  Inbox<Response, ResponseType> replies_;
};

using Trigger = Client<std_srvs::srv::Trigger_Request, std_srvs::srv::Trigger_RequestPubSubType,
                       std_srvs::srv::Trigger_Response, std_srvs::srv::Trigger_ResponsePubSubType>;
using SetBool = Client<std_srvs::srv::SetBool_Request, std_srvs::srv::SetBool_RequestPubSubType,
                       std_srvs::srv::SetBool_Response, std_srvs::srv::SetBool_ResponsePubSubType>;
using LoadMap = Client<nav2_msgs::srv::LoadMap_Request, nav2_msgs::srv::LoadMap_RequestPubSubType,
                       nav2_msgs::srv::LoadMap_Response, nav2_msgs::srv::LoadMap_ResponsePubSubType>;
using SetInitialPose =
    Client<nav2_msgs::srv::SetInitialPose_Request, nav2_msgs::srv::SetInitialPose_RequestPubSubType,
           nav2_msgs::srv::SetInitialPose_Response, nav2_msgs::srv::SetInitialPose_ResponsePubSubType>;

using ListParameters =
    Client<rcl_interfaces::srv::ListParameters_Request, rcl_interfaces::srv::ListParameters_RequestPubSubType,
           rcl_interfaces::srv::ListParameters_Response, rcl_interfaces::srv::ListParameters_ResponsePubSubType>;
using GetParameters =
    Client<rcl_interfaces::srv::GetParameters_Request, rcl_interfaces::srv::GetParameters_RequestPubSubType,
           rcl_interfaces::srv::GetParameters_Response, rcl_interfaces::srv::GetParameters_ResponsePubSubType>;
using GetParameterTypes =
    Client<rcl_interfaces::srv::GetParameterTypes_Request, rcl_interfaces::srv::GetParameterTypes_RequestPubSubType,
           rcl_interfaces::srv::GetParameterTypes_Response, rcl_interfaces::srv::GetParameterTypes_ResponsePubSubType>;
using DescribeParameters =
    Client<rcl_interfaces::srv::DescribeParameters_Request, rcl_interfaces::srv::DescribeParameters_RequestPubSubType,
           rcl_interfaces::srv::DescribeParameters_Response,
           rcl_interfaces::srv::DescribeParameters_ResponsePubSubType>;
using SetParameters =
    Client<rcl_interfaces::srv::SetParameters_Request, rcl_interfaces::srv::SetParameters_RequestPubSubType,
           rcl_interfaces::srv::SetParameters_Response, rcl_interfaces::srv::SetParameters_ResponsePubSubType>;
using SetParametersAtomically = Client<rcl_interfaces::srv::SetParametersAtomically_Request,
                                       rcl_interfaces::srv::SetParametersAtomically_RequestPubSubType,
                                       rcl_interfaces::srv::SetParametersAtomically_Response,
                                       rcl_interfaces::srv::SetParametersAtomically_ResponsePubSubType>;

constexpr const char* kOffered = "node:\n  services: true\n";

TEST_F(ByreNode, AnswersServicesToTheirCallers) {
  const std::vector<ImageFrame>& frames = Room::shared().frames();
  NodeProcess node(folder_, kOffered + mission(), domain_);
  Trigger save(peer_, "save", 0x1234567890abcdef), relocalise(peer_, "relocalise", 2), other(peer_, "save", 3);
  LoadMap load(peer_, "load_map", 4);
  SetInitialPose hint(peer_, "set_initial_pose", 5);
  ASSERT_TRUE(is_connected() && save.has_subscriber() && relocalise.has_subscriber() && load.has_subscriber() &&
              hint.has_subscriber())
      << node.stderr_output();
  ASSERT_TRUE(answer_to(feed_, odometry_, frames[0])) << node.stderr_output();

  const auto saved = save.call({});
  ASSERT_TRUE(saved.has_value()) << node.stderr_output();
  EXPECT_FALSE(saved->success());
  EXPECT_THAT(saved->message(), HasSubstr("set slam.save"));
  EXPECT_TRUE(other.call({}).has_value()) << "another client";

  nav2_msgs::srv::LoadMap_Request map;
  map.map_url("../secret");
  const auto refused = load.call(map);
  EXPECT_TRUE(refused && refused->result() == 255) << node.stderr_output();
  map.map_url("room.byre");
  const auto loaded = load.call(map);
  EXPECT_TRUE(loaded && loaded->result() == 0) << node.stderr_output();

  nav2_msgs::srv::SetInitialPose_Request pose;
  pose.pose().header().frame_id("map");
  EXPECT_TRUE(hint.call(pose).has_value());
  EXPECT_TRUE(node.has_logged("searching within 3.0 m of it")) << node.stderr_output();
  const auto looked = relocalise.call({});
  EXPECT_TRUE(looked && looked->success()) << node.stderr_output();
  EXPECT_TRUE(answer_to(feed_, odometry_, frames[1])) << node.stderr_output();
  EXPECT_EQ(node.stop(), 0);
}

TEST_F(ByreNode, PausesMappingByServiceAndByCommand) {
  const std::vector<ImageFrame>& frames = Room::shared().frames();
  NodeProcess node(folder_, kOffered + mapping(), domain_);
  SetBool pause(peer_, "pause_mapping", 1);
  ASSERT_TRUE(is_connected() && pause.has_subscriber()) << node.stderr_output();
  std_srvs::srv::SetBool_Request is_paused;
  is_paused.data(true);
  const auto paused = pause.call(is_paused);
  ASSERT_TRUE(paused && paused->success()) << node.stderr_output();
  feed_.send(frames[0]);
  EXPECT_TRUE(diagnosis(diagnostics_, "byre: localisation", "no pose")) << "no map begins";
  command("resume mapping");
  EXPECT_TRUE(
      events_.find([](const auto& event) { return event.data().find("mapping is resumed") != std::string::npos; }));
  EXPECT_TRUE(answer_to(feed_, odometry_, frames[1])) << node.stderr_output();
  EXPECT_EQ(node.stop(), 0);
}

// As `ros2 param` calls them, and with the endpoints in the graph.
TEST_F(ByreNode, AnswersParameterServices) {
  using namespace rcl_interfaces::srv;
  Graph graph(peer_, "ros_discovery_info", kLatched);
  NodeProcess node(folder_, kOffered + mission(), domain_);
  ListParameters list(peer_, "list_parameters", 1);
  GetParameters get(peer_, "get_parameters", 2);
  GetParameterTypes types(peer_, "get_parameter_types", 3);
  DescribeParameters describe(peer_, "describe_parameters", 4);
  SetParameters set(peer_, "set_parameters", 5);
  SetParametersAtomically set_together(peer_, "set_parameters_atomically", 6);

  ListParameters_Request all;
  all.depth(0);
  const auto listed = list.ask(all);
  ASSERT_TRUE(listed.has_value()) << node.stderr_output();
  const std::vector<std::string>& names = listed->result().names();
  EXPECT_THAT(names, testing::IsSupersetOf({"slam.map", "grid.resolution", "images.reliable", "mqtt.port"}));

  GetParameters_Request values;
  values.names({"slam.map", "grid.resolution", "images.reliable", "mqtt.port", "no.such"});
  const auto got = get.ask(values);
  ASSERT_TRUE(got && got->values().size() == 5) << node.stderr_output();
  EXPECT_EQ(got->values()[0].string_value(), Room::shared().map().string());
  EXPECT_EQ(got->values()[1].double_value(), 0.05);
  EXPECT_TRUE(got->values()[2].bool_value());
  EXPECT_EQ(got->values()[3].integer_value(), 1883);
  GetParameterTypes_Request typed;
  typed.names(values.names());
  const auto found = types.ask(typed);
  ASSERT_TRUE(found.has_value());
  EXPECT_THAT(found->types(), testing::ElementsAre(4, 3, 1, 2, 0));
  values.names(names);
  const auto every = get.ask(values);
  EXPECT_TRUE(every && every->values().size() == names.size());

  DescribeParameters_Request described;
  described.names({"grid.footprint"});
  const auto description = describe.ask(described);
  ASSERT_TRUE(description && description->descriptors().size() == 1);
  EXPECT_TRUE(description->descriptors()[0].read_only());
  EXPECT_THAT(description->descriptors()[0].description(), HasSubstr("radius of the robot"));

  rcl_interfaces::msg::Parameter changed;
  changed.name("grid.footprint");
  changed.value().type(3);
  changed.value().double_value(1.0);
  SetParameters_Request one;
  one.parameters({changed});
  const auto refused = set.ask(one);
  ASSERT_TRUE(refused && refused->results().size() == 1);
  EXPECT_FALSE(refused->results()[0].successful());
  EXPECT_THAT(refused->results()[0].reason(), HasSubstr("grid.footprint is read-only"));
  SetParametersAtomically_Request together;
  together.parameters({changed});
  const auto refused_together = set_together.ask(together);
  EXPECT_TRUE(refused_together && !refused_together->result().successful());

  // 5 commands and 6 services for parameters.
  const auto announced = graph.find([](const auto& message) {
    return !message.node_entities_info_seq().empty() &&
           message.node_entities_info_seq()[0].reader_gid_seq().size() >= 11 &&
           message.node_entities_info_seq()[0].writer_gid_seq().size() >= 11;
  });
  EXPECT_TRUE(announced.has_value());
  EXPECT_EQ(node.stop(), 0);
}

// Requests in the native form of Fast DDS have no id.
TEST_F(ByreNode, IgnoresMalformedRequests) {
  NodeProcess node(folder_, kOffered + mission(), domain_);
  TypeSupport bare(new std_srvs::srv::BareTrigger_RequestPubSubType);
  bare->setName("std_srvs::srv::dds_::Trigger_Request_");
  auto* const requests = peer_.writer("rq/byre/saveRequest", bare, kVolatile);
  ASSERT_TRUE(is_connected() && FastPeer::has_subscriber(requests)) << node.stderr_output();
  std_srvs::srv::BareTrigger_Request request;
  requests->write(&request);
  command("hello again");
  ASSERT_TRUE(events_.find([](const auto& event) { return event.data().find("hello again") != std::string::npos; }));
  // Commands and requests are read in any order.
  const std::string refusal = "/byre/save is called by another middleware than rmw_cyclonedds_cpp";
  EXPECT_TRUE(eventually([&] { return node.stderr_output().find(refusal) != std::string::npos; }))
      << node.stderr_output();
  EXPECT_EQ(node.stop(), 0);
}

}  // namespace
}  // namespace byre::testing_ros2
