"""Zenoh's access control, made from the table of roles: whatever no rule allows is denied.

A router asks it of each message that comes from a client or another router (ingress) and that goes to one (egress).
Advanced publishers and subscribers also use keys with the chunk `@adv`, which `**` does not match.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import chain
from typing import Any, Literal

from actum import keys
from actum.keys import BASE, Topic
from actum_deployer.deployment import Deployment
from actum_deployer.roles import IMAGES, ROS_MARKS, ROS_TOPICS, Role, identity, router_identity

Rule = dict[str, Any]
"""One rule of Zenoh's access control."""

ADVANCED = "@adv/**"
"""What advanced publishers and subscribers append to their keys: caches, heartbeats, and who is there."""
EVERYTHING = (f"{BASE}/**", f"{BASE}/**/{ADVANCED}")
"""All keys of all sensors."""
ROUTER_ITSELF = "@/*/router"
"""The key on which a router describes itself: who hears nothing else knows by it that nothing is hidden."""
TOKENS = ("alive/{0}/*", "candidate/{0}/*/*", "successor/{0}/*/*", "member/{0}/*/*")
"""The liveliness tokens by which instances of a service hold, share or ask for their place."""
WISHES = ("declare_subscriber", "declare_queryable", "query", "liveliness_query", "declare_liveliness_subscriber")
"""What a router tells a client of others, so that it knows for whom to put and answers queries: no content."""
LOOKING = ("liveliness_query", "declare_liveliness_subscriber")
"""Asking who is there, once and from now on."""
ROS_TOKENS = "@ros2_lv/{}/**"
"""The liveliness tokens by which rmw_zenoh's nodes of a domain find each other and their topics."""
TOLD = "everybody is told what others wish"
"""The name of the rule that all roles have."""
LINK = "routers pass on"
"""The beginning of the names of the rules between routers."""


def access_control(deployment: Deployment) -> dict[str, Any]:
    """Return the section `access_control` of the configuration of each router of a deployment.

    A role is known by its certificate and, where there are passwords, by its user name as well, which is the same.
    """
    named, domain = deployment.common_name, deployment.ros_domain
    routers = [named(router_identity(host.name)) for host in deployment.routers]
    own = {named(identity(role, its)): list(rules(role, its, domain)) for role, its in deployment.subjects}
    between = link_rules(deployment.images_cross, domain)
    [told] = _allowed(TOLD, "egress", WISHES, EVERYTHING)
    users = {name: {"usernames": [name]} if deployment.passwords else {} for name in own}
    users |= {name: {} for name in routers}  # who connects learns no user name of whom it connects to
    return {
        "enabled": True,
        "default_permission": "deny",
        "rules": [told, *chain(*own.values()), *between],
        "subjects": [{"id": name, "cert_common_names": [name], **user} for name, user in users.items()],
        "policies": [
            *({"subjects": [name], "rules": [*_ids(its), TOLD]} for name, its in own.items()),
            {"subjects": routers, "rules": _ids(between)},
        ],
    }


def rules(role: Role, sensors: str, ros_domain: int | None) -> Iterator[Rule]:
    """Yield the rules of a role for its sensors, such as `left,right`; of people's roles for all sensors."""
    name, of = identity(role, sensors), sensors.split(",") if role.services else ["*"]
    puts = [*_patterns(role.puts, of), *_ros(role.ros_puts, of, ros_domain)]
    reads = [*_patterns(role.reads, of), *_ros(role.ros_reads, of, ros_domain)]
    own = _of_services(role, of, ("info/{0}", "command/{0}/**"))
    states, tokens = _of_services(role, of, ("status/{0}",)), _of_services(role, of, TOKENS)
    asked = _asked(role, of)
    places = [keys.claims(each, service) for each in of for service in role.services]
    looked = [f"{BASE}/{each}/{token}/**" for each in of for token in ("alive", "member")] if role.inspects else []
    if role.speaks_ros and ros_domain is not None:
        nodes = ROS_TOKENS.format(ros_domain)
        tokens, looked = [*tokens, nodes], [*looked, nodes]
        theirs = [*puts, *reads, *_advanced([*puts, *reads]), nodes]
        yield from _allowed(f"{name} is told", "egress", WISHES, theirs)
    yield from _allowed(f"{name} puts", "ingress", ["put"], [*puts, *_advanced(puts), *states])
    yield from _allowed(f"{name} offers", "ingress", ["declare_queryable", "reply"], [*puts, *_advanced(puts), *own])
    yield from _allowed(f"{name} is there", "ingress", ["liveliness_token"], [*tokens, *_advanced(puts)])
    yield from _allowed(f"{name} wants", "ingress", ["declare_subscriber"], _wanted(role, reads))
    yield from _allowed(f"{name} asks", "ingress", ["query"], [*_advanced(reads), *own, *asked])
    yield from _allowed(f"{name} looks", "ingress", LOOKING, [*_advanced(reads), *places, *looked])
    yield from _allowed(f"{name} gets", "egress", ["put"], [*reads, *_advanced(reads)])
    yield from _allowed(f"{name} is answered", "egress", ["reply"], [*reads, *_advanced(reads), *own, *asked])
    yield from _allowed(f"{name} sees", "egress", ["liveliness_token"], [*tokens, *_advanced(reads), *looked])


def link_rules(images_cross: bool, ros_domain: int | None) -> list[Rule]:
    """Return the rules between routers: what any role may put, but images only where these may cross."""
    crossing = [topic for topic in keys.TOPICS if images_cross or topic not in IMAGES]
    ros = _ros((*ROS_TOPICS, *ROS_MARKS), ["*"], ros_domain)
    nodes = [] if ros_domain is None else [ROS_TOKENS.format(ros_domain)]
    content = [*_patterns(crossing, ["*"]), f"{BASE}/*/command/**", *ros]
    tokens = [*(f"{BASE}/*/{token.format('*')}" for token in TOKENS), *nodes]
    both: tuple[Literal["ingress", "egress"], ...] = ("ingress", "egress")
    return [
        *_allowed(f"{LINK} content", both, ["put", "reply"], [*content, *_advanced(content)]),
        *_allowed(f"{LINK} who is there", both, ["liveliness_token"], [*tokens, *_advanced(content)]),
        *_allowed(f"{LINK} wishes", both, WISHES, [*EVERYTHING, *ros, *_advanced(ros), *nodes]),
    ]


def _allowed(
    name: str, flows: str | Sequence[str], messages: Iterable[str], key_exprs: Iterable[str]
) -> Iterator[Rule]:
    """Yield a rule, or none where it would allow nothing."""
    exprs = list(dict.fromkeys(key_exprs))
    if exprs:
        flows = [flows] if isinstance(flows, str) else [*flows]
        yield {"id": name, "permission": "allow", "flows": flows, "messages": [*messages], "key_exprs": exprs}


def _patterns(topics: Iterable[Topic], of: Sequence[str]) -> list[str]:
    return [keys.pattern(topic, sensor) for topic in topics for sensor in of]


def _of_services(role: Role, of: Sequence[str], leaves: Sequence[str]) -> list[str]:
    """Return keys below each sensor that hold the name of a service, in the place of `{0}` in a leaf."""
    return [f"{BASE}/{each}/{leaf.format(service)}" for each in of for service in role.services for leaf in leaves]


def _ros(topics: Sequence[str], of: Sequence[str], domain: int | None) -> list[str]:
    """Return the keys of ROS 2's topics, each with its type below it; none where there is no bridge."""
    return [] if domain is None else [f"{domain}/{topic.format(sensor)}/**" for sensor in of for topic in topics]


def _advanced(patterns: Iterable[str]) -> list[str]:
    return [f"{pattern}/{ADVANCED}" for pattern in patterns]


def _wanted(role: Role, reads: Sequence[str]) -> list[str]:
    """Return what a role subscribes to: people may name all keys at once, and get what they may read."""
    return [*reads, *_advanced(reads), *(() if role.services or not role.inspects else EVERYTHING)]


def _asked(role: Role, of: Sequence[str]) -> list[str]:
    """Return what a role asks of its sensors' services, people's of every sensor's, and of its router."""
    infos = [*_patterns([keys.INFO], of), ROUTER_ITSELF] if role.inspects else []
    return [*infos, *(f"{BASE}/{each}/command/**" for each in of)] if role.commands else infos


def _ids(own: Iterable[Mapping[str, Any]]) -> list[str]:
    return [rule["id"] for rule in own]
