"""Links and joints of a description as a tree, and the way through it from base to flange."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NamedTuple
from xml.etree.ElementTree import Element

import mujoco

from app.arm_import.description.robot_xml import Description
from app.files.bad_input import ABSENT, BadInput

FEWEST, MOST = 2, 8
"""Joints between base and flange."""

FLANGES = ("flange", "tool0", "tool_flange", "ee_link", "attachment_site")
"""Names that mean the flange in public collections (ROS-Industrial's tool0, the menagerie's attachment_site), best first."""

WORLD = "world"
"""What MJCF calls the root."""


class TreeJoint(NamedTuple):
    """What moves a link against its parent."""

    name: str
    kind: str  # "hinge", or what else: prismatic, floating, ...
    element: Element
    mimics: bool = False  # it follows another joint


@dataclass
class LinkTree:
    """Links by name. `parents` has for each but the root its parent, `joints` for each that moves what moves it."""

    root: str
    parents: dict[str, str] = field(default_factory=dict)
    joints: dict[str, list[TreeJoint]] = field(default_factory=dict)
    sites: dict[str, str] = field(default_factory=dict)  # frames that are no links, with their links
    loops: list[tuple[str, str]] = field(default_factory=list)  # links that something else holds together, besides

    def way(self, link: str) -> list[str]:
        """Links from below the root down to `link`."""
        found: list[str] = []
        while link != self.root:
            found.append(link)
            link = self.parents[link]
        return found[::-1]

    def below(self, link: str) -> Iterator[str]:
        """`link` and all that hangs on it."""
        yield link
        for child in [child for child, parent in self.parents.items() if parent == link]:
            yield from self.below(child)

    def carrier(self, link: str) -> str:
        """The link that moves, or the root, on which `link` is fixed; itself, if it moves."""
        while link != self.root and not self.joints.get(link):
            link = self.parents[link]
        return link


class ArmChain(NamedTuple):
    """The way from base to flange."""

    tree: LinkTree
    flange: str  # a link or a site
    links: list[str]  # that move, base to flange
    joints: list[TreeJoint]  # what moves each
    locked: list[str]  # names of joints that do not move any more
    beyond: set[str]  # links beyond the flange
    aside: set[str]  # links that hang on the base by joints of their own: not of this arm


def tree_of(arm: Description) -> LinkTree:
    """Links and joints of a description. Raises BadInput: they are no tree with one root."""
    return _urdf(arm) if arm.kind == "URDF" else _mjcf(arm)


def _urdf(arm: Description) -> LinkTree:
    where = arm.files.file.name
    links = [link.get("name", "") for link in arm.root.findall("link")]
    for name, count in Counter(links).items():
        if count > 1 or not name:
            raise BadInput(where, "link.name", name, "expected a name that no other link has")
    tree = LinkTree("")
    for joint in arm.root.findall("joint"):
        name = joint.get("name", "")
        ends = [(end.get("link", "") if (end := joint.find(role)) is not None else "") for role in ("parent", "child")]
        for role, link in zip(("parent", "child"), ends, strict=True):
            if link not in links:
                raise BadInput(where, f"joint {name}.{role}", link, "expected the name of a link")
        parent, child = ends
        if child in tree.parents:
            raise BadInput(where, f"joint {name}.child", child, f"hangs on {tree.parents[child]} already: a closed loop")
        tree.parents[child] = parent
        kind = joint.get("type", "")
        if kind != "fixed":
            plain = "hinge" if kind in ("revolute", "continuous") else kind
            tree.joints[child] = [TreeJoint(name, plain, joint, joint.find("mimic") is not None)]
    roots = [link for link in links if link not in tree.parents]
    if not roots:
        raise BadInput(where, "joint", ABSENT, "expected a link that hangs on none: these joints go round")
    if len(roots) > 1:
        raise BadInput(where, "link", ", ".join(roots), "expected one root: these hang on no joint")
    tree.root = roots[0]
    if len(set(tree.below(tree.root))) < len(links):
        raise BadInput(where, "joint", ABSENT, "expected joints without a circle")
    return tree


def _mjcf(arm: Description) -> LinkTree:
    where = arm.files.file.name
    spec = parsed_spec(arm)
    kinds = {joint.name: str(joint.type).rpartition("mjJNT_")[2].lower() for joint in spec.joints}
    tree = LinkTree(WORLD)

    def go_down(element: Element, parent: str) -> None:
        for child in element:
            if child.tag == "frame":
                go_down(child, parent)
            elif child.tag == "site":
                tree.sites[child.get("name", "")] = parent
            elif child.tag == "body":
                name = child.get("name", "")
                tree.parents[name] = parent
                moving = [joint for joint in _with_frames(child) if joint.tag in ("joint", "freejoint")]
                if moving:
                    tree.joints[name] = [_joint(joint, kinds) for joint in moving]
                go_down(child, name)

    for world in arm.root.findall("worldbody"):
        go_down(world, WORLD)
    if not tree.parents:
        raise BadInput(where, "worldbody", ABSENT, "expected bodies")
    owners = {joint.name: link for link, joints in tree.joints.items() for joint in joints}
    for held in [each for section in arm.root.findall("equality") for each in section]:
        ends = [held.get(key) for key in ("body1", "body2", "joint1", "joint2", "site1", "site2")]
        known = [tree.sites.get(owners.get(end, end), owners.get(end, end)) for end in ends if end is not None]
        if known:
            tree.loops.append((known[0], known[-1] if len(known) > 1 else WORLD))
    return tree


def _with_frames(body: Element) -> Iterator[Element]:
    for child in body:
        if child.tag == "frame":
            yield from _with_frames(child)
        else:
            yield child


def _joint(element: Element, kinds: dict[str, str]) -> TreeJoint:
    name = element.get("name", "")
    return TreeJoint(name, "free" if element.tag == "freejoint" else kinds.get(name, "hinge"), element)


def parsed_spec(arm: Description) -> mujoco.MjSpec:
    """MJCF as MuJoCo parses it, not compiled. Raises BadInput: it does not."""
    from xml.etree.ElementTree import tostring

    try:
        return mujoco.MjSpec.from_string(tostring(arm.root, encoding="unicode"))
    except ValueError as error:
        raise BadInput(arm.files.file.name, "", ABSENT, f"expected MJCF ({error})") from None


def chain_to(arm: Description, tree: LinkTree, flange: str | None) -> ArmChain:
    """The way from the root to the flange.

    Args:
        arm: the description.
        tree: its links.
        flange: the link or site at which tools are mounted; None: one whose name means that, else the end of a chain without
            branches.

    Raises:
        BadInput: there is no such link, or what lies before it is no chain of 2 to 8 revolute joints.
    """
    where = arm.files.file.name
    name = _usual_flange(tree) if flange is None else flange
    if name is None or name not in {*tree.parents, *tree.sites}:
        ends = [link for link in tree.parents if link not in tree.parents.values()]
        allowed = f"expected the link that tools are mounted on, such as {', '.join([*ends, *filter(None, tree.sites)][:12])}"
        raise BadInput("--flange", "", ABSENT if name is None else name, allowed)
    link = tree.sites.get(name, name) if name not in tree.parents else name
    way = tree.way(link)
    joints = [joint for each in way for joint in tree.joints.get(each, [])]
    moving = [each for each in way if tree.joints.get(each)]
    _check(where, tree, way, joints)
    chain = {joint.name for joint in joints}
    locked = [joint.name for each in tree.joints.values() for joint in each if joint.name not in chain]
    last = moving[-1]
    hanging = [each for each in tree.below(last) if tree.joints.get(each) and each != last]
    hanging += [child for child, parent in tree.parents.items() if parent == link]
    beyond = {each for top in hanging for each in tree.below(top)}
    others = [each for each in tree.joints if tree.carrier(tree.parents[each]) == tree.root and each != moving[0]]
    aside = {each for top in others for each in tree.below(top)}
    return ArmChain(tree, name, moving, joints, locked, beyond, aside)


def _usual_flange(tree: LinkTree) -> str | None:
    for name in FLANGES:
        if name in tree.parents or name in tree.sites:
            return name
    ends = [link for link in tree.joints if not any(tree.joints.get(each) for each in tree.below(link) if each != link)]
    if len(ends) != 1 or any(joint.kind != "hinge" for joint in tree.joints[ends[0]]):
        return None
    fixed = [each for each in tree.below(ends[0]) if each not in tree.parents.values()]
    return fixed[0] if len(fixed) == 1 else ends[0]


def _check(where: str, tree: LinkTree, way: list[str], joints: list[TreeJoint]) -> None:
    for joint in joints:
        if joint.kind in ("free", "floating"):
            raise BadInput(where, f"joint {joint.name}", joint.kind, "expected a base that is fixed")
        if joint.kind != "hinge":
            raise BadInput(where, f"joint {joint.name}", joint.kind, "expected revolute joints between base and flange")
        if joint.mimics:
            raise BadInput(
                where, f"joint {joint.name}", "mimic", "expected joints that move by themselves between base and flange"
            )
    for link in way:
        if len(tree.joints.get(link, [])) > 1:
            raise BadInput(where, f"body {link}", ABSENT, "has several joints: expected one a body")
    moving = [link for link in way if tree.joints.get(link)]
    for one, other in tree.loops:
        ends = {tree.carrier(each) for each in (one, other) if each in tree.parents or each == tree.root}
        inside = ends & {tree.root, *moving}
        if len(ends) > 1 and (len(inside) > 1 or inside & set(moving[:-1])):
            raise BadInput(where, "equality", f"{one}, {other}", "closes a loop in the chain from base to flange")
    if not FEWEST <= len(joints) <= MOST:
        raise BadInput(where, "joints", len(joints), f"expected {FEWEST} to {MOST} between base and flange")
