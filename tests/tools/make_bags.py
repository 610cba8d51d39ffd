"""Recordings of other programs: a directory by rosbags, and files by the Python package mcap in every form.

make_bags.py FOLDER writes FOLDER/rosbags (a directory), FOLDER/{none,lz4,zstd,unchunked}.mcap with the same messages.
"""

import sys
from pathlib import Path

import numpy as np
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

START = 1_700_000_000_000_000_000


def messages(store):
    """Topic, type, log time and message, in order."""
    types = store.types
    header = lambda n: types["std_msgs/msg/Header"](
        stamp=types["builtin_interfaces/msg/Time"](sec=n, nanosec=7 * n), frame_id="base"
    )
    vector = types["geometry_msgs/msg/Vector3"]
    for n in range(200):
        imu = types["sensor_msgs/msg/Imu"](
            header=header(n),
            orientation=types["geometry_msgs/msg/Quaternion"](x=0.0, y=0.1 * n, z=-1e-300, w=1.0),
            orientation_covariance=np.arange(9, dtype=np.float64) * n,
            angular_velocity=vector(x=float("nan"), y=float("inf"), z=-float("inf")),
            angular_velocity_covariance=np.zeros(9),
            linear_acceleration=vector(x=1.5, y=-2.5, z=9.81),
            linear_acceleration_covariance=np.full(9, 0.1),
        )
        yield "/imu", "sensor_msgs/msg/Imu", START + 10_000_000 * n, imu
        if n % 10 == 0:
            state = types["sensor_msgs/msg/JointState"](
                header=header(n),
                name=[f"joint_{k}" for k in range(n // 10)] + ["", "né"],
                position=np.linspace(0, 1, n),
                velocity=np.array([], dtype=np.float64),
                effort=np.array([n], dtype=np.float64),
            )
            yield "/joints", "sensor_msgs/msg/JointState", START + 10_000_000 * n + 5, state
            cloud = types["sensor_msgs/msg/CompressedImage"](
                header=header(n), format="jpeg", data=np.arange(n % 256, dtype=np.uint8)
            )
            yield "/camera/image", "sensor_msgs/msg/CompressedImage", START + 10_000_000 * n + 6, cloud


def main(folder):
    store = get_typestore(Stores.ROS2_HUMBLE)
    folder = Path(folder)
    with Writer(folder / "rosbags", version=8, storage_plugin=StoragePlugin.MCAP) as writer:
        connections = {}
        for topic, kind, time, message in messages(store):
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=store)
            writer.write(connections[topic], time, store.serialize_cdr(message, kind))
    forms = {
        "none": {"compression": CompressionType.NONE, "chunk_size": 4096},
        "lz4": {"compression": CompressionType.LZ4, "chunk_size": 4096},
        "zstd": {"compression": CompressionType.ZSTD, "chunk_size": 4096},
        "unchunked": {"use_chunking": False},
    }
    for name, options in forms.items():
        with open(folder / f"{name}.mcap", "wb") as file:
            writer = McapWriter(file, **options)
            writer.start(profile="ros2", library="make_bags")
            channels = {}
            for n, (topic, kind, time, message) in enumerate(messages(store)):
                if topic not in channels:
                    text, _ = store.generate_msgdef(kind, ros_version=2)
                    schema = writer.register_schema(kind, "ros2msg", text.encode())
                    channels[topic] = writer.register_channel(topic, "cdr", schema)
                # Every other message in big endian.
                data = bytes(store.serialize_cdr(message, kind, little_endian=n % 2 == 0))
                writer.add_message(channels[topic], time, data, time - 3, n)
            writer.finish()


if __name__ == "__main__":
    main(sys.argv[1])
