"""The settings schema: its table, its ranges, its hash."""

import math

import msgspec
import pytest

from pendant.all_settings import Settings, apply, describe, digest, find, safety_checksum, value_of
from pendant.settings.renamed import RENAMED
from pendant.settings.schema import SettingError, SettingRow, Value, ticks
from tests.items import each_of

# name: (default, low, high, unit, requirement, locked), copied from the spec by hand
EXPECTED = {
    "following.on": (True, None, None, "", "RL-1", True),
    "following.joint": (0.6, 0.2, 1.0, "", "RL-1", True),
    "following.tool": (0.025, 0.005, 0.1, "m", "RL-1", True),
    "collision.on": (True, None, None, "", "RL-3", True),
    "collision.force": (50.0, 20.0, 250.0, "N", "RL-3", True),
    "collision.clamping": (150.0, 50.0, 250.0, "N", "RL-3", True),
    "activation.period": (1.0, 0.0, 15.0, "s", "FD-7", True),
    "sequence.on": (True, None, None, "", "FD-24", True),
    "sequence.period": (1.0, 0.0, 5.0, "s", "FD-9", True),
    "sequence.stored": (False, None, None, "", "FD-9", True),
    "sequence.age": (2.0, 0.5, 15.0, "s", "FD-9", True),
    "sequence.amplified": (False, None, None, "", "FD-9", True),
    "sequence.beyond_limit": ("refuse", None, None, "", "FD-10", True),
    "sequence.dynamic.acceleration": (False, None, None, "", "FD-12b", True),
    "sequence.dynamic.payload": (False, None, None, "", "FD-12b", True),
    "sequence.dynamic.drift": (False, None, None, "", "FD-12b", True),
    "sequence.dynamic.pushed": (False, None, None, "", "FD-12b", True),
    "sequence.dynamic.vertical": (False, None, None, "", "FD-12b", True),
    "free_drive.allowed_from.normal": (False, None, None, "", "FD-1", True),
    "free_drive.allowed_from.teach": (True, None, None, "", "FD-1", True),
    "free_drive.allowed_from.run": (False, None, None, "", "FD-1", True),
    "free_drive.allowed_from.teach_first": (False, None, None, "", "FD-1", True),
    "free_drive.period": (3.0, 0.5, 30.0, "s", "FD-14", False),
    "free_drive.restart_period": (3.0, 0.5, 30.0, "s", "FD-15", False),
    "unexplained.sensor": (True, None, None, "", "FD-19", True),
    "free_drive.restart_begins": ("standstill", None, None, "", "FD-15", True),
    "limits.maintain.load_share": (0.0, 0.0, 1.0, "", "FD-13", True),
    "free_drive.signal_renews": (True, None, None, "", "FD-16", True),
    "free_drive.longest": (30.0, 0.5, 30.0, "s", "FD-16", True),
    "free_drive.ends_by_period": (True, None, None, "", "FD-24", True),
    "free_drive.remainders": (True, None, None, "", "FD-20", True),
    "free_drive.way_back": (True, None, None, "", "FD-22", True),
    "free_drive.cool_down": (2.0, 0.0, 30.0, "s", "FD-12c", True),
    "free_drive.gain": (1.0, 0.0, 3.0, "", "FD-3", True),
    "free_drive.force_cap": (50.0, 5.0, 100.0, "N", "FD-3", True),
    "hold.silence": (0.5, 0.1, 1.0, "s", "FD-23", True),
    "button.short_press": (0.4, 0.1, 2.0, "s", "FD-8a", True),
    "button.hold_to_run": (False, None, None, "", "FD-8a", True),
    "soft.on": (True, None, None, "", "FD-12b", True),
    "soft.onset": (0.5, 0.1, 0.9, "", "FD-12b", True),
    "soft.force": (120.0, 10.0, 300.0, "N", "FD-12b", True),
    "soft.torque": (0.7, 0.05, 1.0, "of rated", "FD-12b", True),
    "soft.payload": (True, None, None, "", "FD-12b", True),
    "soft.payload_share": (0.05, 0.0, 0.5, "1/kg", "FD-12b", True),
    "soft.drift": (True, None, None, "", "FD-12b", True),
    "soft.drift_time": (2.0, 0.2, 30.0, "s", "FD-12b", True),
    "soft.drift_share": (0.5, 0.1, 1.0, "", "FD-12b", True),
    "soft.acceleration": (False, None, None, "", "FD-12b", True),
    "soft.acceleration_share": (0.25, 0.0, 2.0, "s²/m", "FD-12b", True),
    "soft.pushed": (False, None, None, "", "FD-12b", True),
    "soft.force_share": (0.02, 0.0, 0.2, "1/N", "FD-12b", True),
    "soft.torque_share": (0.1, 0.0, 2.0, "1/(N·m)", "FD-12b", True),
    "soft.vertical": (False, None, None, "", "FD-12b", True),
    "soft.vertical_share": (0.5, 0.1, 1.0, "", "FD-12b", True),
    "soft.hard": (False, None, None, "", "FD-12b", True),
    "axes.on": (True, None, None, "", "FD-4", False),
    "axes.x": (True, None, None, "", "FD-4", False),
    "axes.y": (True, None, None, "", "FD-4", False),
    "axes.z": (True, None, None, "", "FD-4", False),
    "axes.rx": (True, None, None, "", "FD-4", False),
    "axes.ry": (True, None, None, "", "FD-4", False),
    "axes.rz": (True, None, None, "", "FD-4", False),
    **{f"joints.{name}": (True, None, None, "", "FD-4", False) for name in ("on", *(f"j{k}" for k in range(1, 13)))},
    "axes.frame": ("base", None, None, "", "FD-4", False),
    "axes.roll": (0.0, -3.15, 3.15, "rad", "FD-4", False),
    "axes.pitch": (0.0, -3.15, 3.15, "rad", "FD-4", False),
    "axes.yaw": (0.0, -3.15, 3.15, "rad", "FD-4", False),
    "axes.resistance": (True, None, None, "", "FD-4", True),
    "axes.near": (0.04, 0.011, 0.1, "m", "FD-4", True),
    "axes.too_near": (0.01, 0.001, 0.01, "m", "FD-4", True),
    "haptics.on": (False, None, None, "", "HF-1", False),
    "haptics.amplitude": (0.004, 0.001, 0.008, "rad", "HF-2", True),
    **{
        f"haptics.{name}": (True, None, None, "", "HF-1", False)
        for name in ("left", "entered", "confirmation", "border", "ending", "contact")
    },
    "joint_limits.on": (True, None, None, "", "FD-4", True),
    "joint_limits.damping_zone": (0.1, 0.01, 0.5, "rad", "FD-4", True),
    "joint_limits.stiff_zone": (0.05, 0.01, 0.3, "rad", "FD-4", True),
    "joint_limits.damping": (0.25, 0.05, 0.4, "s/rad", "FD-4", True),
    "unexplained.motion": (True, None, None, "", "FD-19", True),
    "unexplained.payload": (True, None, None, "", "FD-19", True),
    "unexplained.speed": (0.02, 0.005, 0.25, "m/s", "FD-19", True),
    "unexplained.time": (0.3, 0.02, 2.0, "s", "FD-19", True),
    "unexplained.distance": (0.015, 0.002, 0.1, "m", "FD-19", True),
    "unexplained.force": (1.0, 0.5, 20.0, "N", "FD-19", True),
    "walls.on": (True, None, None, "", "FD-24", True),
    "walls.new_anchors": (True, None, None, "", "VW-3", True),
    "walls.sizes": (True, None, None, "", "VW-8", True),
    "walls.resistance": (True, None, None, "", "VW-7", True),
    "walls.tether": (True, None, None, "", "VW-4", True),
    "walls.activation_radius": (0.005, 0.001, 0.1, "m", "VW-6", True),
    "walls.operation_radius": (0.03, 0.005, 1.0, "m", "VW-6", True),
    "walls.band": (0.005, 0.0, 0.5, "m", "VW-7", True),
    "walls.push": (0.0, 0.0, 100.0, "N", "VW-7", True),
    "walls.averaging": (0.02, 0.02, 10.0, "s", "VW-4", True),
    "walls.safety_period": (1.0, 0.1, 10.0, "s", "VW-3", True),
    "walls.push_back": (1.0, 1.0, 50.0, "N", "VW-5", True),
    "walls.tether_reaction": ("stay", None, None, "", "VW-6", True),
    "enabling.on": (False, None, None, "", "FD-23", True),
    "robot_limits.on": (True, None, None, "", "RL-4", True),
    "robot_limits.transition": (0.5, 0.1, 1.0, "s", "RL-4", True),
    "robot_limits.normal.tool_speed": (1.5, 0.05, 5.0, "m/s", "RL-4", True),
    "robot_limits.normal.elbow_speed": (1.5, 0.05, 5.0, "m/s", "RL-4", True),
    "robot_limits.normal.tool_force": (150.0, 50.0, 250.0, "N", "RL-3", True),
    "robot_limits.normal.elbow_force": (150.0, 50.0, 250.0, "N", "RL-3", True),
    "robot_limits.normal.momentum": (25.0, 1.0, 100.0, "kg·m/s", "RL-4", True),
    "robot_limits.normal.power": (300.0, 10.0, 1000.0, "W", "RL-4", True),
    "robot_limits.normal.stopping_time": (0.4, 0.1, 2.0, "s", "RL-4", True),
    "robot_limits.normal.stopping_distance": (0.5, 0.02, 3.0, "m", "RL-4", True),
    "robot_limits.reduced.tool_speed": (0.75, 0.05, 5.0, "m/s", "RL-4", True),
    "robot_limits.reduced.elbow_speed": (0.75, 0.05, 5.0, "m/s", "RL-4", True),
    "robot_limits.reduced.tool_force": (120.0, 50.0, 250.0, "N", "RL-3", True),
    "robot_limits.reduced.elbow_force": (120.0, 50.0, 250.0, "N", "RL-3", True),
    "robot_limits.reduced.momentum": (10.0, 1.0, 100.0, "kg·m/s", "RL-4", True),
    "robot_limits.reduced.power": (200.0, 10.0, 1000.0, "W", "RL-4", True),
    "robot_limits.reduced.stopping_time": (0.3, 0.1, 2.0, "s", "RL-4", True),
    "robot_limits.reduced.stopping_distance": (0.3, 0.02, 3.0, "m", "RL-4", True),
    **{
        f"robot_limits.{mode}.joint_speeds.j{joint}": (6.4832, 0.1, 6.4832, "rad/s", "RL-4", True)
        for mode in ("normal", "reduced")
        for joint in range(1, 7)
    },
    **{
        f"robot_limits.{mode}.positions.j{joint}_{end}": (default, -6.3358, 6.3358, "rad", "RL-6", True)
        for mode in ("normal", "reduced")
        for joint in range(1, 7)
        for end, default in (("min", -6.3358), ("max", 6.3358))
    },
    "static.speed": (0.01, 0.001, 0.1, "rad/s", "static", True),
    "static.time": (0.1, 0.02, 2.0, "s", "static", True),
    "program.speed": (1.0, 0.0, 1.0, "", "CD-15", False),
    "tools.ramp": (1.0, 0.0, 10.0, "s", "tools", False),
    "tools.measure": (0.5, 0.1, 5.0, "s", "tools", False),
    "tools.room": (0.1, 0.02, 0.5, "m", "tools", False),
    "tools.clearance": (0.03, 0.005, 0.2, "m", "tools", False),
}
SIGNALS = {
    "signals.button": (True, None, None, "", "FD-5", True),
    "signals.digital": (False, None, None, "", "FD-5", True),
    "signals.digital_input": (0.0, 0.0, 7.0, "", "FD-5", True),
    "signals.leaving": (False, None, None, "", "FD-17", True),
    "signals.leaving_input": (1.0, 0.0, 7.0, "", "FD-17", True),
    "signals.push.on": (False, None, None, "", "FD-5", True),
    "signals.push.threshold": (15.0, 5.0, 50.0, "N", "FD-5", True),
    "signals.push.force_limit": (80.0, 10.0, 200.0, "N", "FD-6", True),
    "signals.push.torque_limit": (2.5, 0.2, 20.0, "N·m", "FD-6", True),
    "signals.push.torque_period": (0.0, 0.0, 5.0, "s", "FD-6", True),
    "signals.push.angle": (30.0, 0.0, 90.0, "°", "FD-6", True),
    "signals.push.direction": ("along", None, None, "", "FD-6", True),
    "signals.push.x": (0.0, -1.0, 1.0, "", "FD-6", True),
    "signals.push.y": (0.0, -1.0, 1.0, "", "FD-6", True),
    "signals.push.z": (0.0, -1.0, 1.0, "", "FD-6", True),
    "signals.push.frame": ("base", None, None, "", "FD-6", True),
    "signals.push.off_axis": (30.0, 1.0, 200.0, "N", "FD-6", True),
    "signals.push.radius": (0.0, 0.0, 1.0, "m", "FD-6", True),
    "signals.push.place_x": (0.0, -1.0, 1.0, "m", "FD-6", True),
    "signals.push.place_y": (0.0, -1.0, 1.0, "m", "FD-6", True),
    "signals.push.place_z": (0.0, -1.0, 1.0, "m", "FD-6", True),
    "signals.push.reported": (False, None, None, "", "FD-6a", True),
    "signals.push.pauses": (False, None, None, "", "FD-6a", True),
    "signals.push.resumes": (False, None, None, "", "FD-6a", True),
    "signals.push.stops": (False, None, None, "", "FD-6a", True),
    "signals.twist.on": (False, None, None, "", "FD-5", True),
    "signals.twist.threshold": (3.0, 0.5, 20.0, "N·m", "FD-5", True),
    "signals.twist.force_limit": (10.0, 1.0, 50.0, "N", "FD-5", True),
    "signals.joints.on": (False, None, None, "", "FD-5", True),
    "signals.joints.threshold": (6.0, 1.0, 100.0, "N·m", "FD-5", True),
    "signals.joints.first": (1.0, 1.0, 12.0, "", "FD-5", True),
    "signals.joints.last": (6.0, 1.0, 12.0, "", "FD-5", True),
    "signals.pattern.on": (False, None, None, "", "FD-5", True),
    "signals.pattern.count": (2.0, 2.0, 5.0, "", "FD-5", True),
    "signals.pattern.shortest": (0.08, 0.02, 1.0, "s", "FD-5", True),
    "signals.pattern.longest": (0.28, 0.05, 2.0, "s", "FD-5", True),
    "signals.presses.on": (False, None, None, "", "FD-5", True),
    "signals.presses.of": ("button", None, None, "", "FD-5", True),
    "signals.presses.count": (3.0, 2.0, 5.0, "", "FD-5", True),
    "signals.presses.shortest": (0.06, 0.02, 1.0, "s", "FD-5", True),
    "signals.presses.longest": (0.4, 0.05, 2.0, "s", "FD-5", True),
    "signals.posture.on": (False, None, None, "", "FD-5", True),
    "signals.posture.together": (False, None, None, "", "FD-5", True),
    "signals.posture.count": (2.0, 1.0, 3.0, "", "FD-5", True),
    **{
        f"signals.posture.joint_{number}": (joint, 1.0, 12.0, "", "FD-5", True)
        for number, joint in ((1, 6.0), (2, 5.0), (3, 6.0))
    },
    **{f"signals.posture.angle_{number}": (0.005, -0.5, 0.5, "rad", "FD-5", True) for number in (1, 2, 3)},
    "signals.posture.within": (3.0, 0.1, 10.0, "s", "FD-5", True),
    "signals.turn.on": (False, None, None, "", "FD-5", True),
    "signals.turn.joint": (6.0, 1.0, 12.0, "", "FD-5", True),
    "signals.turn.angle": (0.005, 0.0005, 0.5, "rad", "FD-5", True),
    "signals.force_step.on": (False, None, None, "", "FD-5", True),
    "signals.force_step.threshold": (10.0, 5.0, 50.0, "N", "FD-5", True),
    "signals.force_step.rise": (0.1, 0.01, 0.5, "s", "FD-5", True),
    "signals.force_step.quiet": (0.5, 0.1, 5.0, "s", "FD-5", True),
    "signals.tap.on": (False, None, None, "", "FD-5", True),
    "signals.tap.threshold": (6.0, 1.0, 70.0, "m/s²", "FD-5", True),
    "signals.tap.longest": (0.1, 0.01, 0.5, "s", "FD-5", True),
    "activation.sum_presences": (False, None, None, "", "FD-7", True),
    "handshake.on": (False, None, None, "", "FD-8", True),
    "handshake.by": ("any", None, None, "", "FD-8", True),
    "handshake.when": ("before", None, None, "", "FD-8", True),
    "handshake.delay": (0.0, 0.0, 5.0, "s", "FD-8", True),
    "handshake.feedback": (0.5, 0.0, 5.0, "s", "FD-8", True),
    "handshake.window": (3.0, 1.0, 10.0, "s", "FD-8", True),
    "handshake.hold": (0.2, 0.0, 1.0, "s", "FD-8", True),
    "let_go.on": (True, None, None, "", "FD-8a", True),
    "let_go.force": (3.0, 0.5, 10.0, "N", "FD-8a", True),
    "let_go.time": (0.1, 0.0, 1.0, "s", "FD-8a", True),
    "let_go.within": (2.0, 0.2, 10.0, "s", "FD-8a", True),
}
EXPECTED |= SIGNALS
LIMITS = {
    "activation": {
        "flange_displacement": (0.002, 0.0005, 0.01, "m", "FD-9"),
        "flange_speed": (0.02, 0.002, 0.1, "m/s", "FD-9"),
        "flange_acceleration": (1.5, 0.5, 20.0, "m/s²", "FD-9"),
        "joint_displacement": (0.01, 0.0005, 0.1, "rad", "FD-9"),
        "joint_speed": (0.05, 0.01, 0.5, "rad/s", "FD-9"),
        "joint_acceleration": (5.0, 0.5, 50.0, "rad/s²", "FD-9"),
        "motor_torque": (0.9, 0.01, 1.0, "of rated", "FD-9"),
        "motor_current": (0.9, 0.01, 1.0, "of largest", "FD-9"),
        "joint_torque": (0.04, 0.01, 1.0, "of rated", "FD-9"),
        "payload_force": (6.2, 1.0, 50.0, "N", "FD-9"),
        "payload_torque": (1.5, 0.1, 10.0, "N·m", "FD-9"),
        "payload_error": (0.3, 0.1, 5.0, "kg", "FD-9"),
        "user_force": (12.0, 1.0, 50.0, "N", "FD-9"),
        "user_torque": (1.5, 0.1, 10.0, "N·m", "FD-9"),
    },
    "maintain": {
        "user_force": (8.0, 1.0, 100.0, "N", "FD-13"),
        "user_torque": (1.5, 0.1, 20.0, "N·m", "FD-13"),
        "joint_torque": (8.0, 0.5, 100.0, "N·m", "FD-13"),
        "joint_speed": (0.05, 0.005, 1.0, "rad/s", "FD-13"),
        "flange_speed": (0.02, 0.002, 1.0, "m/s", "FD-13"),
        "flange_acceleration": (1.5, 0.5, 20.0, "m/s²", "FD-13"),
        "flange_displacement": (0.01, 0.001, 0.5, "m", "FD-13"),
    },
    "operation": {
        "tcp_speed": (1.5, 0.05, 5.0, "m/s", "FD-18"),
        "elbow_speed": (1.5, 0.05, 5.0, "m/s", "FD-18"),
        "joint_speed": (3.0, 0.1, 6.0, "rad/s", "FD-18"),
        "flange_acceleration": (40.0, 1.0, 78.0, "m/s²", "FD-18"),
        "joint_torque": (0.8, 0.01, 2.0, "of rated", "FD-18"),
        "user_force": (90.0, 5.0, 100.0, "N", "FD-18"),
        "flange_displacement": (0.5, 0.005, 2.0, "m", "FD-18"),
    },
}
"""Stage, parameter: default, low, high, unit, requirement."""

TIMES = {"operation.user_force": 0.1, "operation.joint_torque": 0.05}
OFF = {
    "activation.joint_displacement",
    "activation.joint_acceleration",
    "activation.motor_torque",
    "activation.motor_current",
    "operation.flange_displacement",
}
STOPS = {"operation.flange_acceleration", "operation.joint_torque"}

for stage, parameters in LIMITS.items():
    for parameter, cell in parameters.items():
        where = f"{stage}.{parameter}"
        EXPECTED[f"limits.{where}.max"] = (*cell, True)
        EXPECTED[f"limits.{where}.time"] = (TIMES.get(where, 0.0), 0.0, 2.0, "s", "FD-12a", True)
        EXPECTED[f"limits.{where}.on"] = (where not in OFF, None, None, "", "FD-25", True)
        if stage == "operation":
            EXPECTED[f"limits.{where}.reaction"] = ("stop" if where in STOPS else "leave", None, None, "", "FD-18", True)
TERMS = {
    "feed_forward": ("AF-4", True),
    "friction": ("AF-7", True),
    "adaptive": ("AF-2", True),
    "torque_feedback": ("AF-5", True),
    "theta": ("AF-5", True),
    "theta_speed": ("AF-5", True),
    "theta_acceleration": ("AF-5", False),
    "q": ("AF-5", True),
    "q_speed": ("AF-5", False),
    "q_acceleration": ("AF-5", False),
    "motor_torque": ("AF-5", False),
    "tcp_pose": ("AF-5", False),
    "tcp_speed": ("AF-5", False),
    "from_dynamics": ("AF-3", True),
    "from_deflection": ("AF-3", True),
    "from_motor": ("AF-3", True),
}
EXPECTED |= {f"joint_control.{name}": (on, None, None, "", ident, True) for name, (ident, on) in TERMS.items()}
EXPECTED["joint_control.fed_back"] = ("deflection", None, None, "", "AF-5", True)
EXPECTED["joint_control.friction_from"] = ("dynamics", None, None, "", "AF-2", True)
EXPECTED["limits.activation.load_share"] = (0.25, 0.0, 1.0, "", "FD-9", True)

CONTACT_SWITCHES = {
    "on": (False, "CD-1", False),
    "audible": (False, "CD-15", False),
    "tool": (True, "CD-2", True),
    "flange": (False, "CD-2", True),
    "links": (True, "CD-2", True),
    "opposite": (True, "CD-0", True),
    "instant": (True, "CD-3", True),
    "difference": (True, "CD-4", True),
    "ratio": (True, "CD-5", True),
    "ratio_of_values": (True, "CD-5", True),
    "statistical": (True, "CD-6", True),
    "slow": (True, "CD-7", True),
    "rules_needed": ("any", "CD-10", True),
    "statistic": ("mean", "CD-8", True),
    "look_back": (True, "CD-14", True),
    "retrospective": (True, "CD-9", True),
}
CONTACT_NUMBERS = {
    "sensitivity": (1.0, 0.25, 4.0, "", "CD-12", False),
    "hard_count": (2.0, 1.0, 10.0, "", "CD-9", True),
    "soft_count": (4.0, 3.0, 10.0, "", "CD-9", True),
    "slow_count": (20.0, 5.0, 50.0, "", "CD-9", True),
    "misses": (0.0, 0.0, 10.0, "", "CD-9", True),
    "clear_limit": (5.0, 4.0, 20.0, "", "CD-9", True),
    "clear_acceleration": (0.7, 0.2, 10.0, "m/s²", "CD-9", True),
    "angle": (0.3, 0.0, 0.95, "", "CD-0", True),
    "force_noise": (0.0, 0.0, 2.0, "N", "CD-0", True),
    "acceleration_noise": (0.0, 0.0, 2.0, "m/s²", "CD-0", True),
    "turn_noise": (1.2, 0.0, 20.0, "rad/s²", "CD-0", True),
    "link_limit": (6.0, 2.0, 20.0, "", "CD-2", True),
    "noise_limit": (3.0, 1.0, 6.0, "", "CD-0", True),
    "hard_limit": (4.0, 2.0, 20.0, "", "CD-4", True),
    "hard_payload": (0.4, 0.0, 5.0, "N/kg", "CD-11", True),
    "ratio_share": (0.5, 0.05, 1.0, "", "CD-5", True),
    "ratio_acceleration": (1.0, 0.2, 10.0, "m/s²", "CD-5", True),
    "value_force": (8.0, 1.0, 50.0, "N", "CD-3", True),
    "value_acceleration": (3.0, 0.1, 20.0, "m/s²", "CD-3", True),
    "confidence": (3.6, 2.0, 10.0, "", "CD-6", True),
    "slow_force": (0.7, 0.2, 20.0, "N", "CD-7", True),
    "slow_payload": (0.1, 0.0, 5.0, "N/kg", "CD-11", True),
    "clamping_ratio": (4.0, 1.0, 50.0, "kg", "CD-7", True),
    "payload_error": (0.25, 0.0, 1.0, "", "CD-11", True),
    "speed_share": (0.0, 0.0, 2.0, "s/m", "CD-11", True),
    "free_drive_factor": (3.0, 1.0, 10.0, "", "CD-11", True),
    "force_step": (3.0, 1.0, 20.0, "", "CD-4", True),
    "acceleration_step": (3.0, 1.0, 20.0, "", "CD-4", True),
    "older_pairs": (0.0, 0.0, 10.0, "", "CD-9", True),
    "tested": (5.0, 2.0, 20.0, "", "CD-6", True),
    "window": (30.0, 10.0, 200.0, "", "CD-6", True),
    "newest": (10.0, 2.0, 20.0, "", "CD-7", True),
    "oldest": (20.0, 5.0, 50.0, "", "CD-7", True),
    "program_factor": (1.0, 1.0, 10.0, "", "CD-11", True),
    "commanded_share": (0.0, 0.0, 2.0, "s²/m", "CD-11", True),
    "target_share": (0.0, 0.0, 0.5, "1/N", "CD-11", True),
    "torque_share": (0.0, 0.0, 0.5, "1/(N·m)", "CD-11", True),
    "current_share": (0.0, 0.0, 10.0, "", "CD-11", True),
}
EXPECTED |= {f"contact.{name}": (on, None, None, "", ident, locked) for name, (on, ident, locked) in CONTACT_SWITCHES.items()}
EXPECTED |= {f"contact.{name}": cell for name, cell in CONTACT_NUMBERS.items()}

NUMBERS = [row for row in describe() if row.low is not None and not row.is_count]
COUNTS = [row for row in describe() if row.is_count]
SWITCHES = [row for row in describe() if row.is_switch]
CHOICES = [row for row in describe() if row.choices]


def test_every_setting_is_a_number_a_count_a_switch_or_a_choice() -> None:
    names = [row.name for row in (*NUMBERS, *COUNTS, *SWITCHES, *CHOICES)]
    assert sorted(names) == sorted(EXPECTED)
    assert {row.name for row in COUNTS} == {
        "contact.hard_count", "contact.soft_count", "contact.slow_count", "contact.misses", "signals.digital_input",
        "signals.leaving_input", "signals.joints.first", "signals.joints.last", "signals.pattern.count", "signals.turn.joint",
        "signals.presses.count", "signals.posture.count", "signals.posture.joint_1", "signals.posture.joint_2",
        "signals.posture.joint_3", "contact.force_step", "contact.acceleration_step", "contact.older_pairs", "contact.tested",
        "contact.window", "contact.newest", "contact.oldest",
    }  # fmt: skip


def test_a_user_is_shown_a_tenth_to_a_quarter_of_all_settings() -> None:
    """Everybody needs what starts free-drive, how long it lasts, walls, contact and the locks; experts the rest."""
    basic = {row.name for row in describe() if row.basic}
    assert 0.1 * len(EXPECTED) < len(basic) < 0.25 * len(EXPECTED)
    assert {"activation.period", "free_drive.period", "walls.on", "contact.on", "limits.operation.tcp_speed.max"} <= basic
    assert not {"limits.operation.tcp_speed.time", "contact.hard_count", "static.speed"} & basic


def test_every_setting_is_as_the_spec_says() -> None:
    shown = {row.name: (row.default, row.low, row.high, row.unit, row.id, row.locked) for row in describe()}
    assert shown == EXPECTED


def test_every_setting_has_a_short_text() -> None:
    for row in describe():
        assert 5 < len(row.text) <= 80, row.name


def test_what_all_limits_have_says_which_limit_it_is_of() -> None:
    """FD-25."""
    whose = {name.rpartition(".")[0]: find(name).text for name in EXPECTED if name.endswith(".max")}
    for name, text in whose.items():
        assert find(f"{name}.on").text == f"{text}: checked"
        assert find(f"{name}.time").text == f"{text}: allowed time beyond"


def test_defaults_are_the_shipped_settings() -> None:
    assert {row.name: value_of(Settings(), row.name) for row in describe()} == {row.name: row.default for row in describe()}


@each_of(NUMBERS, lambda row: row.name)
def test_a_number_is_taken_up_to_its_range_and_not_beyond(row: SettingRow) -> None:
    assert row.low is not None
    assert row.high is not None
    for value in (row.low, row.high, (row.low + row.high) / 2, math.nextafter(row.low, math.inf)):
        assert value_of(apply(Settings(), {row.name: value}), row.name) == value
    below, above = math.nextafter(row.low, -math.inf), math.nextafter(row.high, math.inf)
    for value in (below, above, math.nan, math.inf, -math.inf, 10**400, "1", True, None, [1.0]):
        with pytest.raises(SettingError) as caught:
            apply(Settings(), {row.name: value})
        assert caught.value.name == row.name
        assert caught.value.value is value
        assert caught.value.allowed == f"a number from {row.low:g} to {row.high:g} {row.unit}".rstrip()


@each_of(COUNTS, lambda row: row.name)
def test_a_count_is_a_whole_number_of_its_range(row: SettingRow) -> None:
    assert row.low is not None
    assert row.high is not None
    low, high = int(row.low), int(row.high)
    for value in (low, high, float(low), float(low + 1)):  # a file may say 3.0
        taken = value_of(apply(Settings(), {row.name: value}), row.name)
        assert taken == value
        assert isinstance(taken, int)
    for value in (low - 1, high + 1, low + 0.5, math.nextafter(low, math.inf), math.nan, math.inf, "1", True, None):
        with pytest.raises(SettingError) as caught:
            apply(Settings(), {row.name: value})
        assert caught.value.value is value
        assert caught.value.allowed == f"a whole number from {low} to {high}"


@each_of(CHOICES, lambda row: row.name)
def test_a_choice_is_one_of_its_words(row: SettingRow) -> None:
    for word in row.choices:
        taken = value_of(apply(Settings(), {row.name: word}), row.name)
        assert taken == word
        assert type(taken) is str  # as a file says it
    for value in ("", "Stop", True, False, 0, 1.0, None, ["leave"]):
        with pytest.raises(SettingError) as caught:
            apply(Settings(), {row.name: value})
        assert caught.value.value is value
        assert caught.value.allowed == "one of " + ", ".join(row.choices)


@each_of(RENAMED.items())
def test_an_old_name_is_answered_with_the_new_one(old: str, new: str) -> None:
    assert old not in EXPECTED
    with pytest.raises(SettingError) as caught:
        apply(Settings(), {old: True})
    assert caught.value.name == old
    assert caught.value.allowed.startswith(f"is called {new} now; allowed there: ")


@each_of(SWITCHES, lambda row: row.name)
def test_a_switch_is_true_or_false(row: SettingRow) -> None:
    for value in (True, False):
        assert value_of(apply(Settings(), {row.name: value}), row.name) is value
    for value in (0, 1, 0.0, "true", None):
        with pytest.raises(SettingError, match=f"^{row.name}: .* allowed: true or false$") as caught:
            apply(Settings(), {row.name: value})
        assert caught.value.value is value


def test_a_whole_number_becomes_a_float() -> None:
    value = value_of(apply(Settings(), {"free_drive.period": 5}), "free_drive.period")
    assert isinstance(value, float)
    assert value == 5.0


def test_several_changes_are_made_together_or_not_at_all() -> None:
    changed = apply(Settings(), {"free_drive.allowed_from.run": True, "free_drive.gain": 2.0})
    assert changed.free_drive.allowed_from.run
    assert changed.free_drive.gain == 2.0
    assert changed.free_drive.period == 3.0
    start = Settings()
    with pytest.raises(SettingError):
        apply(start, {"free_drive.gain": 2.0, "hold.silence": 7.0})
    assert start == Settings()


@pytest.mark.parametrize(
    ("name", "instead"),
    [
        ("", "no such section; there are signals, activation, "),
        ("__class__", "no such section; there are signals, activation, "),
        ("Activation.period", "no such section; there are signals, activation, "),
        ("free_drive", "no such setting; there are free_drive.allowed_from.normal, "),
        ("free_drive.speed", "no such setting; there are free_drive.allowed_from.normal, "),
        ("activation.period.x", "no such setting; there are activation.period"),
    ],
)
def test_a_setting_that_does_not_exist_is_named_with_those_that_do(name: str, instead: str) -> None:
    for use in (lambda: apply(Settings(), {name: 1.0}), lambda: find(name), lambda: value_of(Settings(), name)):
        with pytest.raises(SettingError) as caught:
            use()
        assert caught.value.name == name
        assert caught.value.allowed.startswith(instead)


def test_the_error_is_one_line_with_name_value_and_what_is_allowed() -> None:
    with pytest.raises(SettingError) as caught:
        apply(Settings(), {"hold.silence": 2.0})
    assert str(caught.value) == "hold.silence: 2.0 is not allowed; allowed: a number from 0.1 to 1 s"
    assert caught.value.value == 2.0


def test_the_schema_refuses_unknown_fields_and_values_out_of_range() -> None:
    for bad in ({"wall": {}}, {"hold": {"silence": 3.0}}, {"hold": {"silense": 0.2}}):
        with pytest.raises(msgspec.ValidationError):
            msgspec.convert(bad, Settings)


def other(row: SettingRow) -> Value:
    if row.choices:
        return row.choices[-1] if row.default == row.choices[0] else row.choices[0]
    if row.low is None or row.high is None:
        return not row.default
    return row.low if row.high == row.default else row.high


def test_the_safety_checksum_is_of_what_is_locked_and_of_the_periods_of_free_drive() -> None:
    shipped = safety_checksum(Settings())
    sums = {row.name: safety_checksum(apply(Settings(), {row.name: other(row)})) for row in describe()}
    concerned = {row.name for row in describe() if row.locked} | {"free_drive.period", "free_drive.restart_period"}
    assert {name for name, value in sums.items() if value != shipped} == concerned
    assert len(set(sums.values()) - {shipped}) == len(concerned)
    assert len(shipped) == 8
    assert shipped != digest(Settings())


def test_the_digest_tells_settings_apart() -> None:
    digests = {digest(Settings())}
    for row in describe():
        value = other(row)
        digests.add(digest(apply(Settings(), {row.name: value})))
    assert len(digests) == len(describe()) + 1
    assert digest(apply(Settings(), {"free_drive.period": 3})) == digest(Settings())
    assert all(len(text) == 8 and int(text, 16) >= 0 for text in digests)


@pytest.mark.parametrize(
    ("seconds", "count"), [(0.0, 0), (0.002, 1), (0.0029, 1), (0.0031, 2), (0.1, 50), (0.29, 145), (1.0, 500), (30.0, 15000)]
)
def test_periods_in_ticks(seconds: float, count: int) -> None:
    assert ticks(seconds) == count
