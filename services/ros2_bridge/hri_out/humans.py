"""The part of the bridge's step that speaks ROS4HRI: people as bodies and persons, their gestures and intents."""

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any

from actum.arrays import Array
from actum.bridge import ForeignTopic, Output
from actum.installing import install_command
from actum.messages import Agent, Event, Image, Skeleton
from actum.node import SECOND_NS, Counters
from actum.settings import SettingsError
from ros2_bridge.frames import header
from ros2_bridge.hri import types as hri
from ros2_bridge.hri_out import converting
from ros2_bridge.hri_out.announcing import Announcing
from ros2_bridge.hri_out.body import body_of
from ros2_bridge.hri_out.camera import Camera, UnusableCameraError
from ros2_bridge.hri_out.mapping import load
from ros2_bridge.hri_out.personal_model import urdf
from ros2_bridge.hri_out.posture import posture_of
from ros2_bridge.hri_out.present import Human, Present
from ros2_bridge.message_types import STRING, TF_MESSAGE, made
from ros2_bridge.settings import Settings
from ros2_bridge.topics import BODIES_TRACKED, CANDIDATE_MATCHES, INTENTS, PERSONS_TRACKED, TF

if TYPE_CHECKING:
    from ros2_bridge.hri_out.cropping import Cropper

REPEAT_NS = SECOND_NS
"""How often (ns) what seldom changes is published again, for nodes that came later."""
CURRENTLY_SEEN = 1.0
"""The location confidence of a person who is seen, by REP 155."""


class Humans:
    """Turns skeletons and events into the topics of bodies and persons, which come and go with the people.

    Raises:
        MappingError: the mapping file cannot be used.
    """

    def __init__(self, settings: Settings, counters: Counters) -> None:
        self._settings, self._counters = settings, counters
        self._mapping = load(settings.ros_hri_mapping)
        self._present = Present()
        self._topics = Announcing(settings)
        self._camera: Camera | None = None
        self._cropper = _cropper(settings, counters)
        self._postures: dict[Human, int] = {}
        self._now_ns = self._repeated_ns = self._stamp_ns = 0
        self._is_wanted = bool({"bodies", "body_links", "cropped", "persons", "intents"} & settings.chosen_topics)

    def begin(self, session_id: str, lasting: Iterable[ForeignTopic]) -> None:
        """Begin anew in a Zenoh session in which the lasting topics are published: nobody is there."""
        self._present.begin(session_id)
        self._postures.clear()
        self._topics.begin(session_id, lasting)

    def tick(self, now_ns: int) -> Iterator[Output]:
        """Say who is there, for nodes that came later; who has been unseen for too long is gone."""
        self._now_ns = now_ns
        yield from self._leave(self._present.run)
        yield from self._tracked()
        if now_ns - self._repeated_ns >= REPEAT_NS:
            self._repeated_ns = now_ns
            for human in self._present.humans:
                yield from self._known(human)

    def look(self, image: Image) -> Iterator[Output]:
        """Take the camera of an image."""
        try:
            camera = Camera.of(image)
        except UnusableCameraError as error:
            self._counters.reject("unusable_camera", str(error))
            return
        if self._camera is None:
            for human in self._present.humans:
                yield from self._topics.announce(human.topics_of_image())
        self._camera = camera
        if self._cropper is not None:
            self._cropper.take(image)

    def see(self, message: Skeleton, joints: Iterable[Array]) -> Iterator[Output]:
        """Publish everybody of a skeleton message; `joints` are each agent's, (15, 3), NaN where unknown."""
        if not self._is_wanted:
            return
        self._stamp_ns = message.stamp_ns
        gone = [*self._leave(message.session_id)]
        new = self._present.see((agent.agent for agent in message.agents), self._now_ns)
        yield from gone
        for human in new:
            yield from self._arrive(human)
        if gone or new:
            yield from self._tracked()
        of = header(message.stamp_ns, self._settings.frame_id)
        placed: list[Any] = []
        for agent, points in zip(message.agents, joints, strict=True):
            yield from self._seen(of, agent, points, message, placed)
        if placed:
            yield from self._topics.on(TF.name, made(TF_MESSAGE, transforms=placed))

    def hear(self, event: Event) -> Iterator[Output]:
        """Publish an event as the person's action, and as the gesture and the intent that the mapping calls it."""
        if not event.valid or event.action is None or not self._is_wanted:
            return
        human = self._present.of(event.agent, event.session_id)
        if human is None:
            self._counters.counts["of nobody who is there, left out of /humans"] += 1
            return
        frame_id = self._settings.frame_id
        yield from self._topics.on(human.person_topic("action"), converting.person_action(event, frame_id))
        if event.unknown:  # neither a gesture nor an intent can say so, and robots act on them
            self._counters.counts["unknown, no gesture or intent"] += 1
            return
        gesture = self._mapping.gestures.get(event.action)
        if gesture is not None:
            yield from self._topics.on(human.body_topic("gesture"), converting.gesture(event, gesture, frame_id))
        intent = self._mapping.intents.get(event.action)
        if intent is not None:
            message = converting.intent(event, intent, human.person)
            if message is None:
                self._counters.counts["intent without an object, left out"] += 1
            yield from self._topics.on(INTENTS.name, message)

    def _arrive(self, human: Human) -> Iterator[Output]:
        yield from self._topics.announce(human.topics(self._camera is not None, bool(self._mapping.gestures)))
        yield from self._topics.on(human.body_topic("urdf"), made(STRING, data=urdf(human.body)))
        yield from self._topics.on(human.person_topic("body_id"), made(STRING, data=human.body))
        yield from self._topics.on(human.person_topic("anonymous"), made(hri.BOOL, data=True))
        yield from self._known(human)

    def _known(self, human: Human) -> Iterator[Output]:
        """Say what seldom changes of somebody."""
        yield from self._topics.on(CANDIDATE_MATCHES.name, converting.match(human, 1.0))
        yield from self._topics.on(human.person_topic("location_confidence"), made(hri.FLOAT, data=CURRENTLY_SEEN))
        yield from self._posture(human)

    def _posture(self, human: Human) -> Iterator[Output]:
        if human in self._postures:
            of = header(self._stamp_ns, self._settings.frame_id)
            message = made(hri.BODY_POSTURE, header=of, posture=self._postures[human])
            yield from self._topics.on(human.body_topic("posture"), message)

    def _leave(self, run: str) -> Iterator[Output]:
        for human in self._present.leave(run, self._now_ns):
            yield from self._topics.on(CANDIDATE_MATCHES.name, converting.match(human, 0.0))
            yield from self._topics.withdraw(human.topics(of_image=True, gestures=True))
            self._postures.pop(human, None)

    def _tracked(self) -> Iterator[Output]:
        of, humans = header(self._stamp_ns, self._settings.frame_id), self._present.humans
        yield from self._topics.on(BODIES_TRACKED.name, converting.ids_list(of, [human.body for human in humans]))
        yield from self._topics.on(PERSONS_TRACKED.name, converting.ids_list(of, [human.person for human in humans]))

    def _seen(self, of: Any, agent: Agent, joints: Array, message: Skeleton, placed: list[Any]) -> Iterator[Output]:
        """Publish one person; the transforms are added to `placed`."""
        human = self._present.of(agent.agent, message.session_id)
        if human is None:
            self._counters.counts["one person too many, left out of /humans"] += 1
            return
        chosen, on = self._settings.chosen_topics, self._topics.on
        body = body_of(joints)
        if body is not None:
            placed += converting.frames(of, human, body, "body_links" in chosen, "persons" in chosen)
            yield from on(human.body_topic("joint_states"), converting.joint_states(of, human, body))
        posture = posture_of(joints, message.up_in_camera)
        if posture != self._postures.get(human):
            self._postures[human] = posture
            yield from self._posture(human)
        if self._camera is not None:
            seen = self._camera.seen(joints, agent.confidence)
            yield from on(human.body_topic("skeleton2d"), seen.skeleton_2d(of))
            region = seen.region(of)
            yield from on(human.body_topic("roi"), region)
            if self._cropper is not None:
                yield from on(human.body_topic("cropped"), self._cropper.cut(of, message.stamp_ns, region))


def _cropper(settings: Settings, counters: Counters) -> "Cropper | None":
    """Return what cuts people out of images, if that is chosen.

    Raises:
        SettingsError: OpenCV or imagesize is not installed.
    """
    if "cropped" not in settings.chosen_topics:
        return None
    try:
        from ros2_bridge.hri_out.cropping import Cropper  # an installation for ROS 2 lacks OpenCV
    except ModuleNotFoundError as error:
        raise SettingsError(
            f"ros_topics: the topic 'cropped' needs {error.name}, which is not installed: run "
            f"{install_command('marker-tracker')}"
        ) from None
    return Cropper(counters)
