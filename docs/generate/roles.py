"""The table of roles, from the one that access control is made from."""

from docs.generate.markdown import code, table

from actum.keys import Topic
from actum_deployer.roles import ROLES, WITHOUT_IMAGES, Role

HEADS = ("role", "who", "puts", "reads", "asks")


def roles_table() -> str:
    """Write a row for each role."""
    return table(HEADS, (_row(role) for role in ROLES))


def _row(role: Role) -> list[str]:
    asks = ["who is there"] if role.inspects else []
    whose = "its sensor's services" if role.services else "services"
    asks += [f"{whose} to do something"] if role.commands else []
    reads = ", ".join(filter(None, [_named(role.reads), _on_ros(role.ros_reads)]))
    return [code(role.name), role.about, _puts(role), reads, ", ".join(asks)]


def _puts(role: Role) -> str:
    states = [code("status")] if role.services else []
    return ", ".join([*filter(None, [_named(role.puts), _on_ros(role.ros_puts)]), *states])


def _on_ros(topics: tuple[str, ...]) -> str:
    names = ", ".join(code(topic.rpartition("/")[2]) for topic in topics)
    return f"on ROS 2's keys {names}" if names else ""


def _named(topics: tuple[Topic, ...]) -> str:
    if {*WITHOUT_IMAGES} <= {*topics}:
        images = [code(topic.leaf) for topic in topics if topic not in WITHOUT_IMAGES]
        return " and ".join(["all but images", *images])
    return ", ".join(code(topic.leaf.removesuffix("/{}")) for topic in topics)
