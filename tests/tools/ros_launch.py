"""Runs a launch file by the launch package of ROS 2, as `ros2 launch FILE NAME:=VALUE ...` does.

Needs the packages launch and launch_yaml of a ROS 2 installation.
"""

import sys

from launch import LaunchDescription, LaunchService
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import AnyLaunchDescriptionSource

file, *arguments = sys.argv[1:]
values = [tuple(argument.split(":=", 1)) for argument in arguments]
service = LaunchService(argv=arguments)
source = AnyLaunchDescriptionSource(file)
service.include_launch_description(LaunchDescription([IncludeLaunchDescription(source, launch_arguments=values)]))
sys.exit(service.run())
