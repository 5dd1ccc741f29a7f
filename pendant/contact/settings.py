"""The settings of contact detection."""

from typing import Annotated

from pendant.settings.schema import Section
from pendant.settings.schema import choice as _choice
from pendant.settings.schema import count as _count
from pendant.settings.schema import number as _number
from pendant.settings.schema import switch as _switch
from pendant.tick.words import Word


class RulesNeeded(Word):
    """How many of the rules that are on must see a contact (CD-10)."""

    ANY = "any"
    ALL = "all"


class BufferStatistic(Word):
    """What stands for several samples in the slow rule (CD-8)."""

    MEAN = "mean"
    MEDIAN = "median"  # a knock that is shorter than half of the samples does not count


class ContactUse(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Detection of a change in contact."""

    BASIC = ("on", "links", "sensitivity")

    on: Annotated[bool, _switch("CD-1", "a change in contact is detected and logged, in every mode", locked=False)] = False
    audible: Annotated[bool, _switch("CD-15", "a change in contact is heard on a page with sound", locked=False)] = False
    tool: Annotated[bool, _switch("CD-2", "the tool is watched, by flange force and acceleration on the tool's side")] = True
    flange: Annotated[bool, _switch("CD-2", "the tool is watched, by flange force and acceleration on the arm's side")] = False
    links: Annotated[bool, _switch("CD-2", "elbow and forearm are watched, by the joints and the rigid model")] = True
    opposite: Annotated[bool, _switch("CD-0", "each rule but clamping wants force and acceleration to be opposite")] = True
    instant: Annotated[bool, _switch("CD-3", "rule: values of force and acceleration of this tick")] = True
    difference: Annotated[bool, _switch("CD-4", "rule: differences of force and acceleration between samples")] = True
    ratio: Annotated[bool, _switch("CD-5", "rule: ratio of the differences of force and acceleration")] = True
    ratio_of_values: Annotated[bool, _switch("CD-5", "the ratio rule looks at the values of this tick, too")] = True
    statistical: Annotated[bool, _switch("CD-6", "rule: differences from the mean of the buffer")] = True
    slow: Annotated[bool, _switch("CD-7", "rule: differences of means, and clamping")] = True
    rules_needed: Annotated[RulesNeeded, _choice("CD-10", "which of the rules that are on must see the contact")] = (
        RulesNeeded.ANY
    )
    sensitivity: Annotated[
        float, _number(0.25, 4.0, "", "CD-12", text="sensitivity: from clear contacts only to a gentle touch", locked=False)
    ] = 1.0
    hard_count: Annotated[int, _count(1, 10, "CD-9", text="confirmations that the first three rules need")] = 2
    soft_count: Annotated[int, _count(3, 10, "CD-9", text="confirmations that the statistical rule needs")] = 4
    slow_count: Annotated[int, _count(5, 50, "CD-9", text="confirmations that the slow rule needs")] = 20
    misses: Annotated[int, _count(0, 10, "CD-9", text="ticks among the confirmations that need not confirm; 0: all in a row")] = 0
    look_back: Annotated[bool, _switch("CD-14", "the pose at contact is that of the first sample that shows it")] = True
    retrospective: Annotated[bool, _switch("CD-9", "a clear difference is confirmed at once, by older samples")] = True
    clear_limit: Annotated[
        float, _number(4.0, 20.0, "", "CD-9", text="a difference of force is clear beyond so many deviations")
    ] = 5.0
    clear_acceleration: Annotated[
        float, _number(0.2, 10.0, "m/s²", "CD-9", text="a difference of acceleration is clear beyond this")
    ] = 0.7
    angle: Annotated[
        float, _number(0.0, 0.95, "", "CD-0", text="directions are opposite when minus their cosine is beyond this")
    ] = 0.3
    force_noise: Annotated[
        float, _number(0.0, 2.0, "N", "CD-0", text="standard deviation of the flange force, each axis; 0: of the arm's file")
    ] = 0.0
    acceleration_noise: Annotated[
        float,
        _number(0.0, 2.0, "m/s²", "CD-0", text="standard deviation of the acceleration, each axis; 0: of the arm's file"),
    ] = 0.0
    turn_noise: Annotated[
        float, _number(0.0, 20.0, "rad/s²", "CD-0", text="standard deviation of the angular acceleration, each axis")
    ] = 1.2
    link_limit: Annotated[
        float, _number(2.0, 20.0, "", "CD-2", text="links: least change of what a joint feels, in standard deviations")
    ] = 6.0
    noise_limit: Annotated[
        float, _number(1.0, 6.0, "", "CD-0", text="differences within so many standard deviations are noise")
    ] = 3.0
    hard_limit: Annotated[
        float, _number(2.0, 20.0, "", "CD-4", text="difference rule: least difference, in standard deviations")
    ] = 4.0
    hard_payload: Annotated[
        float, _number(0.0, 5.0, "N/kg", "CD-11", text="difference rule: additional force for each kilogram carried")
    ] = 0.4
    ratio_share: Annotated[float, _number(0.05, 1.0, "", "CD-5", text="ratio rule: least ratio, as a share of the payload")] = 0.5
    ratio_acceleration: Annotated[
        float, _number(0.2, 10.0, "m/s²", "CD-5", text="ratio rule: least difference of acceleration")
    ] = 1.0
    value_force: Annotated[float, _number(1.0, 50.0, "N", "CD-3", text="instant rule: least force")] = 8.0
    value_acceleration: Annotated[float, _number(0.1, 20.0, "m/s²", "CD-3", text="instant rule: least acceleration")] = 3.0
    confidence: Annotated[
        float, _number(2.0, 10.0, "", "CD-6", text="statistical rule: least difference, in standard errors of the mean")
    ] = 3.6
    slow_force: Annotated[float, _number(0.2, 20.0, "N", "CD-7", text="slow rule: least difference of force")] = 0.7
    slow_payload: Annotated[
        float, _number(0.0, 5.0, "N/kg", "CD-11", text="slow rule: additional force for each kilogram carried")
    ] = 0.1
    clamping_ratio: Annotated[
        float, _number(1.0, 50.0, "kg", "CD-7", text="slow rule: force over acceleration beyond which it is clamping")
    ] = 4.0
    payload_error: Annotated[float, _number(0.0, 1.0, "", "CD-11", text="share of the payload by which it may be wrong")] = 0.25
    speed_share: Annotated[float, _number(0.0, 2.0, "s/m", "CD-11", text="thresholds rise by this share for each m/s")] = 0.0
    free_drive_factor: Annotated[float, _number(1.0, 10.0, "", "CD-11", text="factor on all thresholds in FREE_DRIVE")] = 3.0
    force_step: Annotated[int, _count(1, 20, "CD-4", text="difference rule: ticks between the samples of force, i")] = 3
    acceleration_step: Annotated[
        int, _count(1, 20, "CD-4", text="difference rule: ticks between the samples of acceleration, j")
    ] = 3
    older_pairs: Annotated[
        int, _count(0, 10, "CD-9", text="older pairs of samples that confirm a difference at once, if all show it")
    ] = 0
    tested: Annotated[int, _count(2, 20, "CD-6", text="statistical rule: newest samples, which are tested")] = 5
    window: Annotated[int, _count(10, 200, "CD-6", text="statistical rule: samples before them, in the buffer")] = 30
    newest: Annotated[int, _count(2, 20, "CD-7", text="slow rule: newest samples, p")] = 10
    oldest: Annotated[int, _count(5, 50, "CD-7", text="slow rule: samples of the stored values, q")] = 20
    statistic: Annotated[BufferStatistic, _choice("CD-8", "slow rule: what stands for its samples")] = BufferStatistic.MEAN
    program_factor: Annotated[float, _number(1.0, 10.0, "", "CD-11", text="factor on all thresholds in RUN")] = 1.0
    commanded_share: Annotated[
        float, _number(0.0, 2.0, "s²/m", "CD-11", text="thresholds rise by this share for each m/s² that a program's line has")
    ] = 0.0
    target_share: Annotated[
        float, _number(0.0, 0.5, "1/N", "CD-11", text="thresholds rise by this share for each newton that a program pushes with")
    ] = 0.0
    torque_share: Annotated[
        float, _number(0.0, 0.5, "1/(N·m)", "CD-11", text="thresholds rise by this share for each N·m of the most loaded joint")
    ] = 0.0
    current_share: Annotated[
        float, _number(0.0, 10.0, "", "CD-11", text="thresholds rise by this share at a motor's largest current")
    ] = 0.0
