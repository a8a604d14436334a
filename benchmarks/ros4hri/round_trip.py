"""What ROS4HRI costs in accuracy: people of MSR Action3D as bodies of ROS 2 and back, answered as before.

A model of other people answers each sequence as it was recorded; and published by the bridge as ROS4HRI's bodies and
read again by another. Whoever changes a way back chooses it by the people with odd numbers, each of whom is answered by
a model of the others; those with even numbers, answered by a model of all the odd ones, are for the test.

What goes over, as bytes, are the frames of the joints on /tf; those alone that human_description has, which lacks the
middle of the trunk; joint_states with the URDF that the bridge publishes beside them; or joint_states alone, of which
only the angles of human_description's joints count, whose bones have lengths of their own and whose shoulders keep
still. All else is the code that runs live.
"""

from collections import defaultdict
from collections.abc import Collection, Iterator, Sequence
from pathlib import Path

from benchmarks.originals import ImportedSets

from actum import keys
from actum.bridge import Foreign
from actum.messages import Message, Skeleton
from actum.node import SECOND_NS
from actum.recording import Recording
from actum_dataset_importer.importing import import_msr_action3d
from actum_model_trainer.answering import answer, encoded
from actum_model_trainer.sample_reading import samples_from
from actum_model_trainer.training import train
from ros2_bridge.bridge import Ros2Bridge
from ros2_bridge.message_types import TF_MESSAGE, from_cdr, made, to_cdr
from ros2_bridge.settings import Settings, TopicName
from som_classifier.model import Model
from som_classifier.presets import DEFAULT

SEED = 0
FRAME = "camera_optical_frame"
LATER_NS = SECOND_NS
"""Recordings start at 0, which in ROS means that there is no stamp (ns)."""
READ = ("/tf", "/humans/bodies/tracked")
"""The topics that go over, beside those of each body."""
ALL, OF_THE_MODEL = "frames on /tf", "of human_description alone"
DESCRIBED, ANGLES = "joint_states and urdf", "joint_states alone"
"""The ways that skeletons take."""
PLAIN = "as recorded"
"""No way at all."""
Split = tuple[Sequence[Recording], Sequence[Recording]]
"""The recordings that a model learns, and those that it answers."""
Answers = dict[str, tuple[str, str]]
"""What was answered and what is right, by the name of the sequence."""


class ThroughRos(Recording):
    """A recording whose skeletons are published as ROS4HRI's bodies, and read again."""

    def __init__(self, path: Path, way: str) -> None:
        super().__init__(path)
        links: set[TopicName] = {"body_links"} if way in (ALL, OF_THE_MODEL) else set()
        self._way, self._leaves = way, ("joint_states", "urdf") if way == DESCRIBED else ("joint_states",)
        self._out = Ros2Bridge(Settings(ros_frame_id=FRAME, ros_topics=frozenset({"tf", "bodies"} | links)))
        self._back = Ros2Bridge(Settings(ros_frame_id=FRAME, ros_bodies=True))
        self._out.foreign_node("out")
        self._back.foreign_node("back")

    def messages(self, topics: Collection[keys.Topic] | None = None) -> Iterator[Message]:
        """Yield what the recording holds, with the skeletons that came back in the places of those that went out."""
        messages = [*super().messages(topics)]
        back = {
            skeleton.stamp_ns - LATER_NS: skeleton
            for message in messages
            if isinstance(message, Skeleton)
            for skeleton in self._sent(message)
        }
        for message in messages:
            if not isinstance(message, Skeleton) or not message.valid:
                yield message
            elif message.stamp_ns in back:
                yield message.model_copy(update={"agents": back[message.stamp_ns].agents})

    def _sent(self, message: Skeleton) -> Iterator[Skeleton]:
        """Yield the skeletons that come back once one was published."""
        for output in self._out.handle(message.model_copy(update={"stamp_ns": message.stamp_ns + LATER_NS})):
            if isinstance(output, Foreign) and (output.topic in READ or output.topic.endswith(self._leaves)):
                put = _without_trunk(output) if self._way == OF_THE_MODEL else output
                for skeleton in self._back.receive(_received(put)):
                    assert isinstance(skeleton, Skeleton)
                    yield skeleton


def _without_trunk(put: Foreign) -> Foreign:
    """Return a payload without the frames that human_description lacks."""
    if put.topic != "/tf":
        return put
    transforms = from_cdr(put.payload, TF_MESSAGE).transforms
    kept = [each for each in transforms if not each.child_frame_id.startswith("spine_")]
    return Foreign(put.topic, to_cdr(made(TF_MESSAGE, transforms=kept)))


def _received(put: Foreign) -> Foreign:
    """Return a payload as it is received, where the topics of all bodies have one name."""
    leaf = put.topic.rpartition("/")[2]
    name = f"/humans/bodies/*/{leaf}" if leaf in ("joint_states", "urdf") else put.topic
    return Foreign(name, put.payload, f"0{put.topic}/type/hash")


def answers(model: Model, recordings: Sequence[Recording]) -> Answers:
    """Answer each labelled sequence once it has ended; one that is lost on the way is missing."""
    samples = samples_from(recordings).usable
    return {each.segment_id: (answer(model, encoded(model, each), 1.0).label, each.label) for each in samples}


def of_round_trip(data: ImportedSets) -> Iterator[str]:
    """Yield a line for each way, with how often it is right and how often it says what is said without it."""
    recordings = data.recordings("msr_action3d", import_msr_action3d)
    odd, even = ([each for each in recordings if int(each.person) % 2 == rest] for rest in (1, 0))
    people = sorted({each.person for each in odd})
    yield "MSR Action3D's odd people, each left out in turn:"
    yield from _compared([_parted(odd, person) for person in people])
    yield "its even people, by a model of the odd ones:"
    yield from _compared([(odd, even)])


def _parted(recordings: Sequence[Recording], person: str) -> Split:
    """Return the recordings of all others, and those of a person."""
    others = [each for each in recordings if each.person != person]
    return others, [each for each in recordings if each.person == person]


def _compared(splits: Sequence[Split]) -> Iterator[str]:
    """Yield a line for each way, from models of each split's first recordings and their answers to the second."""
    found: defaultdict[str, Answers] = defaultdict(dict)
    for learnt, tested in splits:
        model = train(samples_from(learnt).usable, DEFAULT, SEED)
        found[PLAIN] |= answers(model, tested)
        for way in (ALL, OF_THE_MODEL, DESCRIBED, ANGLES):
            found[way] |= answers(model, [ThroughRos(each.path, way) for each in tested])
    plain = found[PLAIN]
    for way, given in found.items():
        right = sum(label == wanted for label, wanted in given.values())
        same = sum(given.get(name, ("",))[0] == label for name, (label, _) in plain.items())
        yield (
            f"  {way:<27}right about {right} of {len(plain)} sequences ({100 * right / len(plain):.1f} %); the same "
            f"answer to {same} ({100 * same / len(plain):.1f} %)"
        )
