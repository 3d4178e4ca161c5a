"""Converts recordings of EuRoC, and of depth of TUM, to ROS 1 messages, from which bags are written."""
import decimal
import re
import struct
import zlib

import genpy
import numpy
from nav_msgs.msg import Odometry
from sensor_msgs.msg import CameraInfo, CompressedImage, Image, Imu
from tf2_msgs.msg import TFMessage

from bag_writers import transform


def numbers_of(text, field):
    found = re.search(field + r":[^\[]*\[([^\]]*)\]", text)
    return [float(number) for number in found[1].replace("\n", " ").split(",")]


class Camera:
    def __init__(self, folder):
        text = (folder / "sensor.yaml").read_text(encoding="utf-8")
        self.body_from_camera = numpy.array(numbers_of(text.split("T_BS")[1], "data")).reshape(4, 4)
        self.intrinsics = numbers_of(text, "intrinsics")
        self.distortion = numbers_of(text, "distortion_coefficients")
        self.size = [int(number) for number in numbers_of(text, "resolution")]
        lines = (folder / "data.csv").read_text(encoding="utf-8").split()
        self.images = [(int(line.split(",")[0]), folder / "data" / line.split(",")[1])
                       for line in lines if re.match(r"\d+,", line)]


def rotation_of(matrix):
    """Quaternion x, y, z, w of a rotation matrix, computed from its largest component for stability."""
    r = matrix[:3, :3]
    squares = [1 + r[0, 0] - r[1, 1] - r[2, 2], 1 - r[0, 0] + r[1, 1] - r[2, 2],
               1 - r[0, 0] - r[1, 1] + r[2, 2], 1 + numpy.trace(r)]
    largest = int(numpy.argmax(squares))
    s = 2 * numpy.sqrt(squares[largest])
    pairs = {0: [s / 4, (r[0, 1] + r[1, 0]) / s, (r[0, 2] + r[2, 0]) / s, (r[2, 1] - r[1, 2]) / s],
             1: [(r[0, 1] + r[1, 0]) / s, s / 4, (r[1, 2] + r[2, 1]) / s, (r[0, 2] - r[2, 0]) / s],
             2: [(r[0, 2] + r[2, 0]) / s, (r[1, 2] + r[2, 1]) / s, s / 4, (r[1, 0] - r[0, 1]) / s],
             3: [(r[2, 1] - r[1, 2]) / s, (r[0, 2] - r[2, 0]) / s, (r[1, 0] - r[0, 1]) / s, s / 4]}
    return pairs[largest]


def camchain(cameras):
    """Both cameras in Kalibr's format."""
    text = ""
    for i, camera in enumerate(cameras):
        text += f"cam{i}:\n  camera_model: pinhole\n  intrinsics: {camera.intrinsics}\n"
        text += f"  distortion_model: radtan\n  distortion_coeffs: {camera.distortion}\n  resolution: {camera.size}\n"
        if i == 1:
            chain = numpy.linalg.inv(camera.body_from_camera) @ cameras[0].body_from_camera
            text += "  T_cn_cnm1: " + str(chain.tolist()) + "\n"
    return text


def grey_pixels(file, sample=1):
    """Pixels of a PNG of grey values of sample bytes, big endian, by the PNG specification."""
    data, packed, at = file.read_bytes(), b"", 8
    width, height = struct.unpack(">II", data[16:24])
    while at < len(data):
        size, = struct.unpack(">I", data[at:at + 4])
        if data[at + 4:at + 8] == b"IDAT":
            packed += data[at + 8:at + 8 + size]
        at += size + 12
    size = width * sample
    lines, pixels, above = zlib.decompress(packed), bytearray(), bytes(size)
    for row in range(height):
        kind, line = lines[row * (size + 1)], bytearray(lines[row * (size + 1) + 1:(row + 1) * (size + 1)])
        for i in range(size):
            up = above[i]
            left, corner = (line[i - sample], above[i - sample]) if i >= sample else (0, 0)
            if kind == 1:
                line[i] = (line[i] + left) & 255
            elif kind == 2:
                line[i] = (line[i] + up) & 255
            elif kind == 3:
                line[i] = (line[i] + (left + up) // 2) & 255
            elif kind == 4:
                a, b, c = abs(up - corner), abs(left - corner), abs(left + up - 2 * corner)
                line[i] = (line[i] + (left if a <= b and a <= c else up if b <= c else corner)) & 255
        above = bytes(line)
        pixels += line
    return width, height, bytes(pixels)


def stamped(message, number, time):
    message.header.seq = number
    message.header.stamp = genpy.Time(time // 10**9, time % 10**9)
    message.header.frame_id = "camera"
    return message


def image_message(file, raw):
    if not raw:
        return CompressedImage(format="png", data=file.read_bytes())
    width, height, pixels = grey_pixels(file)
    return Image(height=height, width=width, encoding="mono8", step=width, data=pixels)


def info_message(camera, number):
    fx, fy, cx, cy = camera.intrinsics
    info = CameraInfo(height=camera.size[1], width=camera.size[0], distortion_model="plumb_bob")
    info.D = [*camera.distortion, 0.0]
    info.K = [fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0]
    info.R = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
    info.header.frame_id = f"cam{number}"
    return info


def messages_of(cameras, frames, raw):
    """(topic, message, time in ns) of both cameras' first frames, with log times slightly after their stamps."""
    begin = cameras[0].images[0][0]
    mounts = [transform("base_link", f"cam{i}", camera.body_from_camera, rotation_of(camera.body_from_camera))
              for i, camera in enumerate(cameras)]
    messages = [("/tf_static", TFMessage(transforms=mounts), begin)]
    suffix = "" if raw else "/compressed"
    for i, camera in enumerate(cameras):
        messages.append((f"/cam{i}/camera_info", info_message(camera, i), begin + 1))
        for number, (time, file) in enumerate(camera.images[:frames]):
            message = stamped(image_message(file, raw), number, time)
            messages.append((f"/cam{i}/image_raw{suffix}", message, time + 3_000_000 + i))
    return sorted(messages, key=lambda message: message[2])


def motion_of(messages):
    """Messages of a gyroscope at 100 Hz and of wheels at 50 Hz during the others, of a robot that hardly moves."""
    begin, end = min(time for _, _, time in messages), max(time for _, _, time in messages)
    motion = []
    for i, time in enumerate(range(begin, end, 10**7)):
        imu = Imu()
        imu.header.stamp, imu.header.frame_id = genpy.Time(time // 10**9, time % 10**9), "imu"
        imu.angular_velocity.x, imu.angular_velocity.z = 0.001 * (i % 3), -0.002
        imu.linear_acceleration.z = 9.81
        motion.append(("/imu", imu, time))
        if i % 2 == 0:
            wheels = Odometry()
            wheels.header.stamp, wheels.header.frame_id, wheels.child_frame_id = imu.header.stamp, "odom", "base_link"
            wheels.pose.pose.position.x, wheels.pose.pose.orientation.w = 0.0001 * i, 1.0
            wheels.twist.twist.linear.x = 0.01
            motion.append(("/odom", wheels, time))
    return sorted(messages + motion, key=lambda each: each[2])


def depth_messages_of(folder, frames):
    """(topic, message, time in ns) of the first colour images of a TUM recording, and of depths around them, metres."""
    def images(name, count):
        lines = [line.split() for line in (folder / name).read_text(encoding="utf-8").splitlines()
                 if not line.startswith("#")]
        return [(int(decimal.Decimal(time) * 10**9), folder / file) for time, file in lines[:count]]

    messages = []
    for time, file in images("rgb.txt", frames):
        image = CompressedImage(format="rgb8; png compressed bgr8", data=file.read_bytes())
        messages.append(("/camera/rgb/image_color/compressed", stamped(image, 0, time), time))
    for time, file in images("depth.txt", frames + 2):
        width, height, pixels = grey_pixels(file, 2)
        metres = numpy.frombuffer(pixels, ">u2").astype("<f4") / numpy.float32(5000)
        image = Image(height=height, width=width, encoding="32FC1", step=4 * width, data=metres.tobytes())
        messages.append(("/camera/depth/image", stamped(image, 0, time), time))
    return sorted(messages, key=lambda each: each[2])
