// MCAP records of byre in other readers. RECORD: file of a run with images; TRAJECTORY: causal poses of that run.

import assert from "node:assert";
import {readFileSync} from "node:fs";
import test from "node:test";
import {readMcap} from "./read_mcap.mjs";

const found = await readMcap(process.env.RECORD);
const poses = readFileSync(process.env.TRAJECTORY, "utf8").trim().split("\n").filter((line) => !line.startsWith("#"))
  .map((line) => line.split(" ").map(Number));
const messages = (topic) => found.topics[topic].messages;

test("the file is complete, indexed and has the profile ros2", () => {
  assert.equal(found.streamed.profile, "ros2");
  assert.ok(found.streamed.isDone && found.isAscending);
  assert.equal(found.streamed.messages, found.counted);
  assert.equal(Object.values(found.topics).reduce((sum, topic) => sum + topic.messages.length, 0), found.counted);
  assert.deepEqual(found.compressions, ["zstd"]);
  assert.ok(Object.values(found.topics).every((topic) => topic.hasQos));
});

test("topics have the standard message types", () => {
  const types = Object.fromEntries(Object.entries(found.topics).map(([name, topic]) => [name, topic.type]));
  assert.equal(types["/tf"], "tf2_msgs/msg/TFMessage");
  assert.equal(types["/byre/odometry"], "nav_msgs/msg/Odometry");
  assert.equal(types["/byre/pose"], "geometry_msgs/msg/PoseWithCovarianceStamped");
  assert.equal(types["/diagnostics"], "diagnostic_msgs/msg/DiagnosticArray");
  assert.equal(types["/byre/points"], "sensor_msgs/msg/PointCloud2");
  assert.equal(types["/left/image_raw"], "sensor_msgs/msg/Image");
  assert.equal(types["/left/camera_info"], "sensor_msgs/msg/CameraInfo");
});

test("poses equal those of the trajectory", () => {
  const byTime = new Map(poses.map((pose) => [pose[0].toFixed(4), pose]));
  assert.ok(messages("/byre/pose").length > 0.8 * poses.length);
  for (const {header, pose} of messages("/byre/pose")) {
    const {x, y, z} = pose.pose.position;
    const expected = byTime.get((header.stamp.sec + 1e-9 * header.stamp.nanosec).toFixed(4));
    assert.ok(Math.hypot(x - expected[1], y - expected[2], z - expected[3]) < 1e-6);
    assert.equal(header.frame_id, "map");
    assert.equal(pose.covariance.length, 36);
  }
  const {covariance} = messages("/byre/pose").at(-1).pose; // the first pose is the origin, without uncertainty
  assert.ok(covariance[0] > 0 && covariance[35] > 0);
});

test("transforms lead from the map to the cameras", () => {
  const children = new Set([...messages("/tf"), ...messages("/tf_static")]
    .flatMap(({transforms}) => transforms.map((each) => `${each.header.frame_id} ${each.child_frame_id}`)));
  assert.deepEqual([...children].sort(),
    ["base_link left_camera", "left_camera right_camera", "map odom", "odom base_link"]);
});

test("diagnostics contain the verdict", () => {
  for (const {status: [{level, message, values}]} of messages("/diagnostics")) {
    const told = Object.fromEntries(values.map(({key, value}) => [key, value]));
    assert.equal(told.verdict, ["trusted", "degraded", "untrusted"][level]);
    assert.ok(message.startsWith(told.verdict));
  }
  assert.ok(messages("/diagnostics").at(-1).status[0].level < 2);
});

test("sizes of points and images match their headers", () => {
  const cloud = messages("/byre/points").at(-1);
  assert.ok(cloud.width > 100);
  assert.equal(cloud.data.length, cloud.width * cloud.point_step);
  assert.deepEqual(cloud.fields.map(({name}) => name), ["x", "y", "z", "intensity", "observations"]);
  const image = messages("/left/image_raw")[0];
  assert.equal(image.data.length, image.height * image.step);
  assert.equal(messages("/left/camera_info")[0].k.length, 9);
});

test("events are lines of JSON", () => {
  const events = messages("/byre/events").map(({data}) => JSON.parse(data).event);
  assert.ok(events.includes("initialised"));
});
