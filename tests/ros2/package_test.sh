#!/usr/bin/env bash
# The ROS 2 package as far as it can be tried without ROS: package.xml against CMakeLists.txt, and
# the launch file with stand-ins for what it imports.
#   package_test.sh SOURCE_FOLDER
set -euo pipefail
PYTHONDONTWRITEBYTECODE=1 python3 - "$1" <<'PYTHON'
import pathlib
import re
import runpy
import sys
import types
from xml.etree import ElementTree

source = pathlib.Path(sys.argv[1])
package = source / "tools" / "ros2"
cmake = (package / "CMakeLists.txt").read_text()
xml = ElementTree.parse(package / "package.xml").getroot()

listed = re.search(r"IN ITEMS ([^)]*)\)", cmake).group(1).split()
depends = {tag.text for kind in ("buildtool_depend", "depend") for tag in xml.findall(kind)}
assert depends == set(listed) | {"hqslam"}, depends ^ set(listed)
assert xml.findtext("name") in cmake
version = re.search(r"project\(hqslam VERSION (\S+)", (source / "CMakeLists.txt").read_text()).group(1)
assert xml.findtext("version") == version
included = "".join(path.read_text() for path in (package / "src").iterdir())
for name in depends - {"ament_cmake", "hqslam"}:
    assert f"#include <{name}/" in included, name


class Said:
    def __init__(self, *args, **named):
        self.args, self.named = args, named


def stand_in(name, **contents):
    sys.modules[name] = types.ModuleType(name)
    vars(sys.modules[name]).update(contents)


stand_in("ament_index_python")
stand_in("ament_index_python.packages", get_package_share_directory=lambda name: str(package))
stand_in("launch", LaunchDescription=list)
stand_in("launch.actions", DeclareLaunchArgument=Said)
stand_in("launch.substitutions", LaunchConfiguration=str)
stand_in("launch_ros")
stand_in("launch_ros.actions", Node=Said)
stand_in("launch_ros.parameter_descriptions", ParameterValue=lambda value, value_type: value)
*arguments, node = runpy.run_path(str(package / "launch" / "hqslam.launch.py"))["generate_launch_description"]()
usual = {argument.args[0]: argument.named["default_value"] for argument in arguments}
assert pathlib.Path(usual["params_file"]).is_file()
assert node.named["package"] == xml.findtext("name")
assert f"EXECUTABLE {node.named['executable']})" in cmake
topics = set(re.findall(r'create_subscription<\w+>\(\s*"(\w+)"', included))
assert {name for name, _ in node.named["remappings"]} == topics, topics
assert "params_file" in node.named["parameters"]
PYTHON
