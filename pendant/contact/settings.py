"""The settings of contact detection."""

from typing import Annotated

from pendant.settings.schema import Section
from pendant.settings.schema import number as _number
from pendant.settings.schema import switch as _switch


class ContactUse(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Detection of a change in contact."""

    on: Annotated[bool, _switch("CD-1", "a change in contact is detected and logged, in every mode", locked=False)] = False
    tool: Annotated[bool, _switch("CD-2", "from the flange force and the acceleration on its tool side")] = True
    flange: Annotated[bool, _switch("CD-2", "from the flange force and the acceleration on its arm side")] = False
    links: Annotated[bool, _switch("CD-2", "on elbow and forearm, from the joints and the model")] = True
    opposite: Annotated[bool, _switch("CD-0", "every rule but clamping asks for opposite directions")] = True
    instant: Annotated[bool, _switch("CD-3", "rule: force and acceleration of now")] = True
    difference: Annotated[bool, _switch("CD-4", "rule: differences of samples")] = True
    ratio: Annotated[bool, _switch("CD-5", "rule: ratio of force and acceleration differences")] = True
    ratio_of_values: Annotated[bool, _switch("CD-5", "the ratio rule looks at force and acceleration of now, too")] = True
    statistical: Annotated[bool, _switch("CD-6", "rule: differences against the buffer's mean")] = True
    slow: Annotated[bool, _switch("CD-7", "rule: differences of means, clamping")] = True
    all_rules: Annotated[bool, _switch("CD-10", "every rule that is on must see it, instead of any")] = False
    sensitivity: Annotated[
        float, _number(0.25, 4.0, "", "CD-12", text="from clear contacts only to gentle touch", locked=False)
    ] = 1.0
    hard_count: Annotated[float, _number(1.0, 10.0, "", "CD-9", text="confirmations of the first three rules")] = 2.0
    soft_count: Annotated[float, _number(3.0, 10.0, "", "CD-9", text="confirmations of the statistical rule")] = 4.0
    slow_count: Annotated[float, _number(5.0, 50.0, "", "CD-9", text="confirmations of the slow rule")] = 20.0
    misses: Annotated[float, _number(0.0, 10.0, "", "CD-9", text="ticks among the confirming ones that may not; 0: in a row")] = (
        0.0
    )
    look_back: Annotated[bool, _switch("CD-14", "the pose at contact is that of the first suspicious sample")] = True
    retrospective: Annotated[bool, _switch("CD-9", "a clear difference is confirmed on older samples at once")] = True
    clear_limit: Annotated[float, _number(4.0, 20.0, "", "CD-9", text="clear difference: deviations of the contact force")] = 5.0
    clear_acceleration: Annotated[float, _number(0.2, 10.0, "m/s²", "CD-9", text="clear difference: acceleration")] = 0.7
    angle: Annotated[float, _number(0.0, 0.95, "", "CD-0", text="minus the cosine beyond which directions are opposite")] = 0.3
    force_noise: Annotated[float, _number(0.02, 2.0, "N", "CD-0", text="noise of the flange force, each axis")] = 0.15
    acceleration_noise: Annotated[float, _number(0.01, 2.0, "m/s²", "CD-0", text="noise of the acceleration, each axis")] = 0.1
    turn_noise: Annotated[float, _number(0.0, 20.0, "rad/s²", "CD-0", text="noise of the angular acceleration, each axis")] = 1.2
    link_force_noise: Annotated[float, _number(0.1, 50.0, "N", "CD-2", text="noise of the force on a link")] = 3.0
    link_acceleration_noise: Annotated[float, _number(0.02, 5.0, "m/s²", "CD-2", text="noise of a link's acceleration")] = 0.2
    link_force: Annotated[float, _number(1.0, 200.0, "N", "CD-2", text="slow rule: force on a link")] = 60.0
    link_margin: Annotated[float, _number(0.0, 100.0, "kg", "CD-11", text="force on a link that a wrong model may explain")] = (
        20.0
    )
    noise_limit: Annotated[float, _number(1.0, 6.0, "", "CD-0", text="differences within so many deviations are noise")] = 3.0
    hard_limit: Annotated[float, _number(2.0, 20.0, "", "CD-4", text="difference rule: deviations of force, acceleration")] = 4.0
    hard_payload: Annotated[float, _number(0.0, 5.0, "N/kg", "CD-11", text="difference rule: force more for each kg carried")] = (
        0.4
    )
    ratio_share: Annotated[float, _number(0.05, 1.0, "", "CD-5", text="ratio's threshold, a share of the payload")] = 0.5
    ratio_acceleration: Annotated[float, _number(0.2, 10.0, "m/s²", "CD-5", text="ratio rule: least acceleration difference")] = (
        1.0
    )
    value_force: Annotated[float, _number(1.0, 50.0, "N", "CD-3", text="instant rule: force")] = 8.0
    value_acceleration: Annotated[float, _number(0.1, 20.0, "m/s²", "CD-3", text="instant rule: acceleration")] = 3.0
    confidence: Annotated[float, _number(2.0, 10.0, "", "CD-6", text="statistical rule: standard errors of a mean")] = 3.6
    slow_force: Annotated[float, _number(0.2, 20.0, "N", "CD-7", text="slow rule: force")] = 0.7
    slow_payload: Annotated[float, _number(0.0, 5.0, "N/kg", "CD-11", text="slow rule: force more for each kg carried")] = 0.1
    clamping_ratio: Annotated[float, _number(1.0, 50.0, "kg", "CD-7", text="force over acceleration, beyond is clamping")] = 4.0
    payload_error: Annotated[float, _number(0.0, 1.0, "", "CD-11", text="share by which the payload may be wrong")] = 0.25
    speed_share: Annotated[float, _number(0.0, 2.0, "s/m", "CD-11", text="thresholds rise with the speed")] = 0.0
    free_drive_factor: Annotated[float, _number(1.0, 10.0, "", "CD-11", text="thresholds in FREE_DRIVE, times")] = 3.0
