"""The node with its parameters, and the robot's topics.

ros2 launch hqslam_ros hqslam.launch.py points:=/ouster/points params_file:=mine.yaml
"""

import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue


def generate_launch_description():
    usual = os.path.join(get_package_share_directory("hqslam_ros"), "config", "hqslam.yaml")
    arguments = {
        "params_file": (usual, "Parameters; the installed file has them all"),
        "points": ("points", "Topic of the LiDAR's points"),
        "imu": ("imu", "Topic of an inertial sensor; one that nobody publishes is none"),
        "use_sim_time": ("false", "Whether the clock is a bag's"),
    }
    given = {name: LaunchConfiguration(name) for name in arguments}
    return LaunchDescription(
        [
            DeclareLaunchArgument(name, default_value=usual, description=meaning)
            for name, (usual, meaning) in arguments.items()
        ]
        + [
            Node(
                package="hqslam_ros",
                executable="hqslam_node",
                name="hqslam",
                output="screen",
                parameters=[
                    given["params_file"],
                    {"use_sim_time": ParameterValue(given["use_sim_time"], value_type=bool)},
                ],
                remappings=[(name, given[name]) for name in ("points", "imu")],
            )
        ]
    )
