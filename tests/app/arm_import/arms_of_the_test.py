"""Descriptions of one small arm of four joints with a two-finger gripper, in URDF and in MJCF, and files that are wrong."""

from pathlib import Path

import trimesh

URDF = """<?xml version="1.0"?>
<robot name="Small Arm">
  <link name="base"><inertial><mass value="2"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><origin xyz="0 0 0.03"/><geometry><cylinder radius="0.06" length="0.06"/></geometry></collision></link>
  <link name="shoulder"><inertial><origin xyz="0 0.01 0.05" rpy="0.1 0.2 0.3"/><mass value="2.5"/>
    <inertia ixx="0.01" iyy="0.012" izz="0.008" ixy="0.001" ixz="0" iyz="0"/></inertial>
    <visual><origin xyz="0 0 0.04"/><geometry><mesh filename="meshes/block.stl" scale="0.001 0.001 0.001"/></geometry></visual>
    </link>
  <link name="upper"><inertial><origin xyz="0.02 0 0.15"/><mass value="2.0"/>
    <inertia ixx="0.02" iyy="0.02" izz="0.004" ixy="0" ixz="0.001" iyz="0"/></inertial>
    <collision><origin xyz="0 0 0.15"/><geometry><box size="0.08 0.08 0.3"/></geometry></collision></link>
  <link name="fore"><inertial><origin xyz="0 0 0.1"/><mass value="1.0"/>
    <inertia ixx="0.008" iyy="0.008" izz="0.001" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><origin xyz="0 0 0.12"/><geometry><cylinder radius="0.035" length="0.24"/></geometry></collision></link>
  <link name="cover"><inertial><mass value="0.2"/>
    <inertia ixx="0.0001" iyy="0.0001" izz="0.0001" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="wrist"><inertial><origin xyz="0 0 0.03"/><mass value="0.5"/>
    <inertia ixx="0.0005" iyy="0.0005" izz="0.0004" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><origin xyz="0 0 0.03"/><geometry><sphere radius="0.03"/></geometry></collision></link>
  <link name="flange"/>
  <link name="hand"><inertial><origin xyz="0 0 0.03"/><mass value="0.3"/>
    <inertia ixx="0.0003" iyy="0.0003" izz="0.0002" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="finger"><inertial><origin xyz="0 0 0.02"/><mass value="0.05"/>
    <inertia ixx="0.00001" iyy="0.00001" izz="0.00001" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="j1" type="revolute"><origin xyz="0 0 0.06"/><parent link="base"/><child link="shoulder"/><axis xyz="0 0 1"/>
    <limit lower="-2.9" upper="2.9" effort="60" velocity="2"/></joint>
  <joint name="j2" type="revolute"><origin xyz="0 0.02 0.08" rpy="0.1 0 0.2"/><parent link="shoulder"/><child link="upper"/>
    <axis xyz="0 1 0"/><limit lower="-2" upper="1.5" effort="60" velocity="2"/></joint>
  <joint name="j3" type="revolute"><origin xyz="0 0 0.3"/><parent link="upper"/><child link="fore"/><axis xyz="0 0.8 0.6"/>
    <limit lower="-2.5" upper="2.5" effort="30" velocity="2.5"/></joint>
  <joint name="j4" type="continuous"><origin xyz="0 0 0.25"/><parent link="fore"/><child link="wrist"/><axis xyz="1 0 0"/>
    <limit effort="12" velocity="3"/></joint>
  <joint name="lid" type="fixed"><origin xyz="0 0.04 0.1" rpy="0 0.5 0"/><parent link="fore"/><child link="cover"/></joint>
  <joint name="end" type="fixed"><origin xyz="0 0 0.06" rpy="0 0 0.4"/><parent link="wrist"/><child link="flange"/></joint>
  <joint name="mount" type="fixed"><origin xyz="0 0 0.01"/><parent link="flange"/><child link="hand"/></joint>
  <joint name="grip" type="prismatic"><origin xyz="0.02 0 0.06"/><parent link="hand"/><child link="finger"/><axis xyz="1 0 0"/>
    <limit lower="0" upper="0.04" effort="10" velocity="0.1"/></joint>
</robot>
"""

MJCF = """<mujoco model="Other Arm">
  <compiler angle="degree" meshdir="meshes" autolimits="true"/>
  <default>
    <default class="big"><joint range="-160 160" armature="0.2"/><motor ctrlrange="-50 50"/></default>
    <default class="drawn"><geom contype="0" conaffinity="0" group="2"/></default>
  </default>
  <asset><mesh name="block" file="block.stl" scale="0.001 0.001 0.001"/></asset>
  <worldbody>
    <geom type="plane" size="1 1 0.1"/>
    <body name="base" pos="0 0 0.1" euler="0 0 30">
      <geom type="cylinder" size="0.05 0.05"/>
      <body name="one" pos="0 0 0.1" childclass="big">
        <inertial pos="0 0.01 0.04" mass="2" diaginertia="0.01 0.01 0.006" quat="1 0.1 0 0"/>
        <joint name="a" axis="0 0 1"/>
        <geom class="drawn" type="mesh" mesh="block" pos="0 0 0.04"/>
        <body name="two" pos="0 0.05 0.08" quat="1 1 0 0">
          <inertial pos="0 0.15 0" mass="1.8" fullinertia="0.02 0.004 0.02 0.0001 0 0"/>
          <joint name="b" axis="0 0 1" pos="0.01 0 0" ref="20"/>
          <geom type="capsule" fromto="0 0 0 0 0.3 0" size="0.04"/>
          <body name="three" pos="0 0.3 0">
            <inertial pos="0 0.1 0" mass="0.9" diaginertia="0.006 0.001 0.006"/>
            <joint name="c" axis="0 0 1" range="-120 140"/>
            <geom type="box" size="0.03 0.12 0.03" pos="0 0.12 0"/>
            <site name="attachment_site" pos="0 0.26 0" quat="-1 1 0 0"/>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator>
    <motor class="big" joint="a"/>
    <position joint="b" kp="100" forcerange="-40 40"/>
    <motor joint="c" gear="20" ctrlrange="-1 1"/>
  </actuator>
  <keyframe><key name="home" qpos="0 -0.5 1.2"/></keyframe>
</mujoco>
"""


def block() -> bytes:
    """A block of 60 by 80 by 90 mm, in millimetres, as STL."""
    data = trimesh.creation.box([60.0, 80.0, 90.0]).export(file_type="stl")
    assert isinstance(data, bytes)
    return data


def laid_out(folder: Path, text: str, name: str = "arm.xml") -> Path:
    """A description in a folder, with its mesh."""
    (folder / "meshes").mkdir(parents=True, exist_ok=True)
    (folder / "meshes" / "block.stl").write_bytes(block())
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path
