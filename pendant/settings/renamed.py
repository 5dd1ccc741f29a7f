"""Settings that were called something else once: who uses an old name is told the new one."""

RENAMED = {
    "walls.leave": "walls.tether_reaction",
    "walls.stop": "walls.tether_reaction",
    "walls.anew": "walls.new_anchors",
    "sequence.protective_stop": "sequence.beyond_limit",
    "sequence.compensate": "sequence.beyond_limit",
    "free_drive.restart_at_manipulation": "free_drive.restart_begins",
    "free_drive.restart_after_force": "free_drive.restart_begins",
    "free_drive.anew": "free_drive.signal_renews",
    "free_drive.maintained": "free_drive.ends_by_period",
    "limits.operation.tcp_speed.stop": "limits.operation.tcp_speed.reaction",
    "limits.operation.elbow_speed.stop": "limits.operation.elbow_speed.reaction",
    "limits.operation.joint_speed.stop": "limits.operation.joint_speed.reaction",
    "limits.operation.flange_acceleration.stop": "limits.operation.flange_acceleration.reaction",
    "limits.operation.joint_torque.stop": "limits.operation.joint_torque.reaction",
    "limits.operation.user_force.stop": "limits.operation.user_force.reaction",
    "limits.operation.flange_displacement.stop": "limits.operation.flange_displacement.reaction",
    "axes.tool": "axes.frame",
    "signals.push.band": "signals.push.direction",
    "signals.push.flange_axes": "signals.push.frame",
    "signals.push.told": "signals.push.reported",
    "contact.all_rules": "contact.rules_needed",
}
"""Old name -> name of now."""
