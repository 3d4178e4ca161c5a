"""Writers of bags that share no code with byre: rosbag of ROS 1, sqlite3, and MCAP by its specification."""
import pathlib
import sqlite3
import struct

import genpy
import roslz4
import rosbag
from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import Odometry
from sensor_msgs.msg import CameraInfo, CompressedImage, Image, Imu
from tf2_msgs.msg import TFMessage


class Cdr:
    """Serialiser for the ROS 2 message encoding (CDR)."""

    def __init__(self):
        self.bytes = bytearray(b"\x00\x01\x00\x00")

    def number(self, code, *values):
        for value in values:
            size = struct.calcsize("<" + code)
            self.bytes += b"\0" * (-(len(self.bytes) - 4) % size)
            self.bytes += struct.pack("<" + code, value)
        return self

    def text(self, text):
        data = text.encode() + b"\0"
        self.number("I", len(data)).bytes.extend(data)
        return self

    def blob(self, data):
        self.number("I", len(data)).bytes.extend(data)
        return self

    def header(self, header):
        return self.number("i", header.stamp.secs).number("I", header.stamp.nsecs).text(header.frame_id)


def cdr(message):
    """Converts a ROS 1 message to ROS 2 encoding."""
    out = Cdr()
    if isinstance(message, CompressedImage):
        out.header(message.header).text(message.format).blob(message.data)
    elif isinstance(message, Image):
        out.header(message.header).number("I", message.height, message.width).text(message.encoding)
        out.number("B", message.is_bigendian).number("I", message.step).blob(message.data)
    elif isinstance(message, CameraInfo):
        out.header(message.header).number("I", message.height, message.width).text(message.distortion_model)
        out.number("I", len(message.D)).number("d", *message.D, *message.K, *message.R, *message.P)
        out.number("I", message.binning_x, message.binning_y, 0, 0, 0, 0).number("B", 0)
    elif isinstance(message, Imu):
        q, w, a = message.orientation, message.angular_velocity, message.linear_acceleration
        out.header(message.header).number("d", q.x, q.y, q.z, q.w, *message.orientation_covariance, w.x, w.y, w.z)
        out.number("d", *message.angular_velocity_covariance, a.x, a.y, a.z, *message.linear_acceleration_covariance)
    elif isinstance(message, Odometry):
        p, q = message.pose.pose.position, message.pose.pose.orientation
        v, w = message.twist.twist.linear, message.twist.twist.angular
        out.header(message.header).text(message.child_frame_id).number("d", p.x, p.y, p.z, q.x, q.y, q.z, q.w)
        out.number("d", *message.pose.covariance, v.x, v.y, v.z, w.x, w.y, w.z, *message.twist.covariance)
    elif isinstance(message, TFMessage):
        out.number("I", len(message.transforms))
        for each in message.transforms:
            t, q = each.transform.translation, each.transform.rotation
            out.header(each.header).text(each.child_frame_id).number("d", t.x, t.y, t.z, q.x, q.y, q.z, q.w)
    else:
        raise TypeError(type(message))
    return bytes(out.bytes)


def ros2_type(message):
    return message._type.replace("/", "/msg/")


def write_rosbag(path, messages, compression):
    """messages: (topic, message, time in ns)."""
    with rosbag.Bag(str(path), "w", compression=compression) as bag:
        for topic, message, time in messages:
            bag.write(topic, message, genpy.Time(time // 10**9, time % 10**9))


def topics_of(messages):
    topics = {}
    for topic, message, _ in messages:
        topics.setdefault(topic, [len(topics) + 1, ros2_type(message), 0])[2] += 1
    return topics


def write_metadata(folder, file, storage, messages):
    counts = "".join(
        f"    - topic_metadata:\n        name: {topic}\n        type: {kind}\n        serialization_format: cdr\n"
        f"        offered_qos_profiles: \"\"\n      message_count: {count}\n"
        for topic, (_, kind, count) in topics_of(messages).items())
    times = [time for _, _, time in messages]
    (folder / "metadata.yaml").write_text(
        f"rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: {storage}\n"
        f"  duration:\n    nanoseconds: {max(times) - min(times)}\n"
        f"  starting_time:\n    nanoseconds_since_epoch: {min(times)}\n  message_count: {len(messages)}\n"
        f"  topics_with_message_count:\n{counts}  compression_format: \"\"\n  compression_mode: \"\"\n"
        f"  relative_file_paths:\n    - {file}\n", encoding="utf-8")


def write_rosbag2_sqlite(folder, messages):
    folder.mkdir()
    database = sqlite3.connect(folder / "walk_0.db3")
    database.executescript(
        "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,"
        " serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
        "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL,"
        " data BLOB NOT NULL); CREATE INDEX timestamp_idx ON messages (timestamp ASC);")
    topics = topics_of(messages)
    for topic, (number, kind, _) in topics.items():
        database.execute("INSERT INTO topics VALUES(?, ?, ?, 'cdr', '')", (number, topic, kind))
    for topic, message, time in messages:
        database.execute("INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)",
                         (topics[topic][0], time, cdr(message)))
    database.commit()
    database.close()
    write_metadata(folder, "walk_0.db3", "sqlite3", messages)


def mcap_text(text):
    return struct.pack("<I", len(text)) + text.encode()


def mcap_record(kind, content):
    return struct.pack("<BQ", kind, len(content)) + content


def write_rosbag2_mcap(folder, messages):
    """One lz4 chunk per twenty messages, no summary."""
    folder.mkdir()
    topics = topics_of(messages)
    head = b""
    for topic, (number, kind, _) in topics.items():
        head += mcap_record(3, struct.pack("<H", number) + mcap_text(kind) + mcap_text("ros2msg") + mcap_text(""))
        head += mcap_record(4, struct.pack("<HH", number, number) + mcap_text(topic) + mcap_text("cdr") + b"\0" * 4)
    file = b"\x89MCAP0\r\n" + mcap_record(1, mcap_text("ros2") + mcap_text("test"))
    for begin in range(0, len(messages), 20):
        records = head if begin == 0 else b""
        part = messages[begin:begin + 20]
        for topic, message, time in part:
            records += mcap_record(5, struct.pack("<HIQQ", topics[topic][0], 0, time, time) + cdr(message))
        packed = roslz4.compress(records)
        times = [time for _, _, time in part]
        file += mcap_record(6, struct.pack("<QQQI", min(times), max(times), len(records), 0) + mcap_text("lz4")
                            + struct.pack("<Q", len(packed)) + packed)
    file += mcap_record(15, b"\0" * 4) + mcap_record(2, b"\0" * 20) + b"\x89MCAP0\r\n"
    pathlib.Path(folder / "walk_0.mcap").write_bytes(file)
    write_metadata(folder, "walk_0.mcap", "mcap", messages)


def transform(parent, child, parent_from_child, rotation):
    """rotation: x, y, z, w."""
    message = TransformStamped()
    message.header.frame_id, message.child_frame_id = parent, child
    t, q = message.transform.translation, message.transform.rotation
    t.x, t.y, t.z = parent_from_child[:3, 3]
    q.x, q.y, q.z, q.w = rotation
    return message
