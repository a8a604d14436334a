"""Makes the README's picture: moments of the simulated scene, and what the processes' nodes say of them.

    python -m docs.picture docs/scene.png

The samples are of the demo's test, which the model has not seen; the first correct one of each action is shown.
"""

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import cv2
import numpy as np
from benchmarks.rig.chain import Chain

from actum.messages import Event, Image, Message, Objects, Skeleton, Truth
from actum.recording import Recording
from actum.standard_body import BONES
from actum_command.scene_marks import mark_of, write_examples
from actum_model_trainer.sample_reading import samples_from
from actum_model_trainer.training import train
from scene_simulator.programme import balanced_programme
from scene_simulator.simulator import Simulator
from som_classifier.model import Model
from som_classifier.presets import DEFAULT

SHOWN = ("push", "lift", "point")
TRAINING_SEED, TEST_SEED, REPETITIONS = 1, 2, 3
GREEN, WHITE, DARK = (96, 200, 60), (255, 255, 255), (40, 34, 30)
CAPTION_PX = 54


def model() -> Model:
    """Train as the demo does."""
    with TemporaryDirectory() as folder:
        examples = Path(folder) / "examples.mcap"
        write_examples(examples, repetitions=12, actor=0, seed=TRAINING_SEED)
        return train(samples_from([Recording(examples)]).usable, DEFAULT)


def panels(recogniser: Model) -> dict[str, np.ndarray]:
    """Draw one panel per shown action."""
    chain, found = Chain(recogniser), {}
    simulator = Simulator(balanced_programme(REPETITIONS, TEST_SEED), 0, TEST_SEED, image_hz=30)
    seen: dict[type[Message], Message] = {}
    truth: Truth | None = None
    for messages in simulator.frames():
        for message in messages:
            truth = message if isinstance(message, Truth) else truth
            outputs = chain.feed(mark_of(message) if isinstance(message, Truth) else message)
            seen.update({type(output): output for output in outputs})
            event = next((output for output in outputs if isinstance(output, Event)), None)
            if event and truth and is_right(event, truth) and truth.action not in found:
                found[truth.action] = panel(seen, event)
        if set(SHOWN) <= set(found):
            break
    return found


def is_right(event: Event, truth: Truth) -> bool:
    """Whether the event names the action and the object."""
    return event.action == truth.action and event.object is not None and event.object.id == truth.object_id


def panel(seen: dict[type[Message], Message], event: Event) -> np.ndarray:
    """Draw the newest image with the joints, the objects' places and the event's sentence."""
    image, skeleton, objects = seen[Image], seen[Skeleton], seen[Objects]
    assert isinstance(image, Image) and isinstance(skeleton, Skeleton) and isinstance(objects, Objects)
    canvas = cv2.imdecode(np.frombuffer(image.data, np.uint8), cv2.IMREAD_COLOR)
    K = np.array(image.K).reshape(3, 3)
    joints = pixels(np.array(skeleton.agents[0].joints), K)
    for parent, child, _ in BONES:
        cv2.line(canvas, joints[parent], joints[child], GREEN, 2, cv2.LINE_AA)
    for joint in joints:
        cv2.circle(canvas, joint, 4, WHITE, -1, cv2.LINE_AA)
    for found in objects.objects:
        [centre] = pixels(np.array([found.position_m]), K)
        chosen = event.object is not None and found.id == event.object.id
        cv2.circle(canvas, centre, 24, GREEN if chosen else WHITE, 3 if chosen else 1, cv2.LINE_AA)
    caption = np.full((CAPTION_PX, canvas.shape[1], 3), DARK, np.uint8)
    cv2.putText(caption, event.sentence, (16, 35), cv2.FONT_HERSHEY_DUPLEX, 0.72, WHITE, 1, cv2.LINE_AA)
    return np.vstack([canvas, caption])


def pixels(points_m: np.ndarray, K: np.ndarray) -> list[tuple[int, int]]:
    """Project points of the camera frame."""
    projected = points_m @ K.T
    return [(round(u), round(v)) for u, v in projected[:, :2] / projected[:, 2:]]


def main() -> None:
    """Write the picture."""
    found = panels(model())
    cv2.imwrite(sys.argv[1], np.hstack([found[action] for action in SHOWN]))


if __name__ == "__main__":
    main()
