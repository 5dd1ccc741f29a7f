"""The description that both parsers read: links, masses and the joints of the chain; whatever else moves is locked."""

import copy
import math
from xml.etree.ElementTree import Element, SubElement, tostring

from app.arm_import.description.link_tree import ArmChain
from app.arm_import.description.robot_xml import Description

IN_BODIES = {"body", "frame", "joint", "inertial", "geom", "site"}
"""Elements below bodies of MJCF that say where they are and what they weigh."""

COMPILER = {"file", "dir", "texturedir", "meshdir", "assetdir", "strippath", "fusestatic", "discardvisual"}
"""Attributes of MJCF's compiler that speak of files and pictures."""

ROOT = "root of all"
"""The body that is put round those of MJCF."""


def plain_text(arm: Description, chain: ArmChain) -> str:
    """The description without pictures, actuators and sensors, as XML; joints that are not of the chain are locked as drawn."""
    root = _urdf(arm.root, chain) if arm.kind == "URDF" else _mjcf(arm.root, chain)
    return tostring(root, encoding="unicode")


def _urdf(root: Element, chain: ArmChain) -> Element:
    moving = {joint.name for joint in chain.joints}
    plain = Element("robot", name="arm")
    compiler = {"fusestatic": "false", "discardvisual": "true", "balanceinertia": "false"}
    SubElement(SubElement(plain, "mujoco"), "compiler", compiler)
    for link in root.findall("link"):
        kept = SubElement(plain, "link", name=link.get("name", ""))
        kept.extend(link.findall("inertial")[:1])
    for joint in root.findall("joint"):
        name = joint.get("name", "")
        kept = SubElement(plain, "joint", name=name, type="revolute" if name in moving else "fixed")
        for part in ("origin", "parent", "child", *(("axis",) if name in moving else ())):
            kept.extend(joint.findall(part)[:1])
        if name in moving:
            low, high = urdf_range(joint) or (-2.0 * math.pi, 2.0 * math.pi)
            SubElement(kept, "limit", lower=repr(low), upper=repr(high), effort="1", velocity="1")
    return plain


def urdf_range(joint: Element) -> tuple[float, float] | None:
    """Smallest and largest angle [rad]; None: the joint has no ends."""
    limit = joint.find("limit")
    if limit is None or joint.get("type") == "continuous":
        return None
    try:
        return float(limit.get("lower", "0")), float(limit.get("upper", "0"))
    except ValueError:
        return None


def _mjcf(root: Element, chain: ArmChain) -> Element:
    moving = {joint.name for joint in chain.joints}
    plain = Element("mujoco", model="arm")
    shapes_weigh = any(each.get("inertiafromgeom") == "true" for each in root.findall("compiler"))
    for section in root:
        if section.tag == "compiler":
            kept = {key: value for key, value in section.attrib.items() if key not in COMPILER}
            SubElement(plain, "compiler", kept)
        elif section.tag == "default":
            plain.append(_without(section, {"material"}))
        elif section.tag == "worldbody":
            world = copy.deepcopy(section)
            _prune(world, moving, shapes_weigh=shapes_weigh)
            for geom in [child for child in world if child.tag == "geom"]:
                world.remove(geom)
            plain.append(_rooted(world))
    return plain


def _rooted(world: Element) -> Element:
    """The world with one body round all others: Pinocchio drops the pose of a body that hangs on the world without a joint."""
    rooted, root = Element("worldbody"), Element("body", name=ROOT)
    root.extend(world)
    rooted.append(root)
    return rooted


def _without(element: Element, tags: set[str]) -> Element:
    kept = copy.deepcopy(element)
    for each in list(kept.iter()):
        for child in [child for child in each if child.tag in tags]:
            each.remove(child)
        each.attrib.pop("material", None)
    return kept


def _prune(body: Element, moving: set[str], *, shapes_weigh: bool) -> None:
    weighs = body.find("inertial") is not None and not shapes_weigh
    for child in list(body):
        locked = child.tag == "joint" and child.get("name") not in moving
        mesh = child.tag == "geom" and (weighs or child.get("type") == "mesh" or child.get("mesh") is not None)
        if child.tag not in IN_BODIES or locked or mesh:
            body.remove(child)
            continue
        child.attrib.pop("material", None)
        _normalise(child)
        if child.tag in ("body", "frame"):
            _prune(child, moving, shapes_weigh=shapes_weigh)


def _normalise(element: Element) -> None:
    """Quaternions of length 1, as MuJoCo takes them."""
    said = element.get("quat")
    if said is not None:
        numbers = [float(word) for word in said.split()]
        length = math.hypot(*numbers)
        if length > 0.0:
            element.set("quat", " ".join(repr(number / length) for number in numbers))
