"""What services count as rejects and what messages give as reasons: what each means and what to do about it.

A test collects both from the code, so that a new one without an explanation here fails. `…` stands for what differs.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from docs.generate.markdown import code, table


@dataclass(frozen=True)
class Problem:
    """What a kind or a reason means, and what to do."""

    meaning: str
    remedy: str


OF_ALL: Mapping[str, Problem] = {
    "unknown_key": Problem(
        "A payload came on a key below `actum/` that is none of the table's, or a recording has such a channel.",
        "Correct the key; the keys are those of this page.",
    ),
    "too_large": Problem(
        "The payload is longer than its key admits: 64 MB for images, 4 MB for actions, 1 MB otherwise.",
        "Send less: JPEG instead of `bgr8`, a smaller image.",
    ),
    "wrong_schema": Problem(
        "The encoding names another schema than the key's.", "Put each message on the key of its schema."
    ),
    "higher_version": Problem("The encoding names a later version of the schema.", "Update actum on this machine."),
    "not_msgpack": Problem(
        "The payload is no msgpack, is nested too deeply, or holds more than 100,000 values.",
        "Pack the message as one msgpack map; `msgpack.packb(fields)` does in Python.",
    ),
    "not_a_map": Problem("The payload is msgpack, but no map with text keys.", "Send a map of field names to values."),
    "wrong_fields": Problem(
        "A field is missing, of another type, or out of its bounds; the latest error names it.",
        "Compare the message with its table on this page or with its JSON Schema.",
    ),
    "wrong_key": Problem(
        "The message names another sensor, agent or service than the key it came on, or is an image of the other kind.",
        "Let `sensor`, `agent` and `service` be those of the key, or leave `sensor` out.",
    ),
}

OF_NODES: Mapping[str, Problem] = {
    "stale_stamp": Problem(
        "A message is no newer than the one before it on its stream, so it is left out.",
        "Let `stamp_ns` rise, and a clock that starts anew bring a new `session_id`. Run one source for a sensor.",
    ),
}

OF_THE_LAST_TWO: Mapping[str, Problem] = {
    "late": Problem(
        "A sample or an end mark came after its segment was answered, more than 2 s behind the other streams.",
        "Find what delays that stream: `latency_ms` and `drops` in `status`, the network, a camera's buffering.",
    ),
    "bad_posture": Problem(
        "A posture says that it is valid but lacks its joints, or holds values that are not finite or absurd.",
        "Correct the program that puts postures; those of `pose_preprocessor` have none.",
    ),
}

OF_IMAGES: Mapping[str, Problem] = {
    "image_size_mismatch": Problem(
        "Images are of another size than the calibration file's; in the tracker, than the message or the JPEG says.",
        "Calibrate at the size in use, or ask the camera for the calibrated one with `ACTUM_CAMERA_SIZE`.",
    ),
}

OF_GATEWAY: Mapping[str, Problem] = {
    "camera_lost": Problem(
        "The camera cannot be opened, was unplugged, is silent, black or frozen; `state` says which.",
        "Look at cable, lens and device name. It is opened again by itself after 0.5, 1, 2 … 8 s.",
    ),
    "damaged_recording": Problem("A recording cannot be read further.", "It is played up to there; copy it again."),
    "truncated_recording": Problem(
        "A recording breaks off, as after a power cut.", "What lies before the break is played; nothing to do."
    ),
}

OF_PREPROCESSOR: Mapping[str, Problem] = {
    "invalid_skeleton": Problem("The source says that this frame cannot be used.", "See the skeleton's own `reason`."),
    "repeated_agent": Problem("One frame has two agents of one number; the last counts.", "Number people apart."),
    "repeated_joints": Problem(
        "All joints are exactly those of the frame before: the tracker has lost the person and repeats itself.",
        "Nothing, if it passes. Otherwise step into view or restart the tracker.",
    ),
    "missing_joint": Problem(
        "Torso or neck is missing for longer than 0.3 s, or neither both hips nor both shoulders are known.",
        "Let the camera see the trunk; nothing else stands in for it.",
    ),
    "not_finite": Problem("A joint is NaN or infinite.", "A source puts null for a joint it lacks."),
    "absurd_joint": Problem(
        "A joint is further from the camera than `ACTUM_REACH_LIMIT_M`, 10 m.", "Are the joints in metres, not in mm?"
    ),
    "absurd_bone": Problem(
        "A bone is longer than `ACTUM_BONE_LIMIT_M`, 1.5 m.", "Are joints in metres and in the order of `joint_names`?"
    ),
    "coincident_joints": Problem(
        "Joints lie on each other or in one line, so that no body frame follows.", "Nothing, if it passes."
    ),
}

OF_CLASSIFIER: Mapping[str, Problem] = {
    "bad_model": Problem(
        "The model file cannot be read, or was made by another version; the model before stays in use.",
        "Train it anew: `actum train`.",
    ),
    "rejected_segment": Problem(
        "A segment was answered without a recognition; the event has `valid: false`.",
        "See the event's `reason`, below.",
    ),
    "duplicate_mark": Problem(
        "A start or an end of a segment came a second time; the first one counts.",
        "Give each action a `segment_id` of its own, and each mark once.",
    ),
}

OF_TRACKER: Mapping[str, Problem] = {
    "image_too_large": Problem("An image has more than 4096 × 4096 pixels.", "Send smaller images."),
    "undecodable_image": Problem("The bytes are no JPEG, or a damaged one.", "Send whole JPEG files as `data`."),
    "black_image": Problem("Nothing can be seen in the image.", "Is the lens covered? Is it dark?"),
    "bad_calibration": Problem(
        "`K`, `distortion` or `skeleton_from_image` is none of a camera's; the latest error says which and why.",
        "Make one with `actum calibrate intrinsics`, or `extrinsics` for a camera beside.",
    ),
    "calibration_size_mismatch": Problem(
        "`K` does not fit the image's size.", "Calibrate at this size, or set `ACTUM_CALIBRATED_SIZE_PX`."
    ),
    "unknown_marker": Problem(
        "A marker is seen that no object carries.", "List it in the scene file, or take it out of view."
    ),
    "repeated_marker": Problem(
        "One marker is seen twice in an image; the one nearest to where it was counts.", "Print each number once."
    ),
    "bad_pose": Problem("No pose in front of the camera fits the marker's corners.", "Nothing, if it passes."),
    "outlying_pose": Problem(
        "An object seems to have jumped further than it can move; a second sighting there is believed.",
        "If it stays: more light, larger markers, a calibrated camera.",
    ),
    "markers_disagree": Problem(
        "The markers of one object do not lie as the scene file says; the largest one counts.",
        "Measure their places on the object again.",
    ),
}

OF_FUSION: Mapping[str, Problem] = {
    "bad_joint": Problem("A posture's joint is not finite or beyond 100 m; it counts as missing.", "As `bad_posture`."),
    "bad_object": Problem("An object is further away than 100 m; it is left out.", "Are positions in metres?"),
    "bad_action": Problem(
        "A final action has no label, or no end; it is answered with an event that is not valid.",
        "Correct the program that puts actions; those of `som_classifier` have both.",
    ),
    "duplicate_segment": Problem(
        "The same final action came twice; the second is left out.",
        "Is there a second classifier? `actum doctor` tells.",
    ),
}

GATEWAY, PREPROCESSOR, CLASSIFIER = "sensor_gateway", "pose_preprocessor", "som_classifier"
TRACKER, FUSION = "marker_tracker", "action_fusion"
COUNTED_BY: Sequence[tuple[tuple[str, ...], Mapping[str, Problem]]] = (
    ((), OF_ALL),
    ((PREPROCESSOR, CLASSIFIER, TRACKER, FUSION), OF_NODES),
    ((CLASSIFIER, FUSION), OF_THE_LAST_TWO),
    ((GATEWAY, TRACKER), OF_IMAGES),
    ((GATEWAY,), OF_GATEWAY),
    ((PREPROCESSOR,), OF_PREPROCESSOR),
    ((CLASSIFIER,), OF_CLASSIFIER),
    ((TRACKER,), OF_TRACKER),
    ((FUSION,), OF_FUSION),
)
"""Which services count which kinds; all of them count what the runtime does."""

REJECTS: Mapping[str, tuple[str, ...]] = {kind: services for services, kinds in COUNTED_BY for kind in kinds}
"""The services that count each kind."""


OF_SEGMENTS: Mapping[str, Problem] = {
    "no model": Problem("The classifier has no model.", "Name one in `--model` or `ACTUM_MODEL`."),
    "too few frames: …, at least … are needed": Problem(
        "The segment has too few usable postures.", "Mark longer: from before the action begins until it is over."
    ),
    "no person": Problem(
        "No posture of anybody lies within the segment.", "Is somebody in view? Does the gateway run?"
    ),
    "no person with a usable frame": Problem(
        "People were there, but none of their postures can be used; in brackets, why.", "See the rejects above."
    ),
    "no usable frame": Problem(
        "The agent that the mark names has only unusable postures; in brackets, why.", "See the rejects above."
    ),
    "… (…)": Problem("One of these with its cause behind it: `no usable frame (missing_joint: no torso)`.", "As said."),
    "end without start": Problem(
        "An end came whose start never did.",
        "Put the start first, with the same `segment_id`; let marks block, not drop.",
    ),
    "end before start": Problem(
        "The end's stamp is before the start's.", "Stamp both on the sensor's clock, or neither."
    ),
    "start without end: no end within 60 s": Problem(
        "The end is missing, or the segment is longer than 60 s.", "Mark one action at a time, both ends."
    ),
    "start without end: no frame came after the start": Problem(
        "No posture came after the start, and no end within 62 s.", "Does the gateway run? Is the stamp in the future?"
    ),
    "start without end: the frames ended … s after the start": Problem(
        "Postures stopped coming, and no end came within 62 s.", "Has the recording ended, is the camera lost?"
    ),
    "segment_id reused": Problem("The name belongs to a segment that was answered.", "Give each action a new name."),
    "the source started anew": Problem(
        "The sensor began anew while the segment was open, so its stamps do not go on.", "Mark the action again."
    ),
    "final action without a label or an end": Problem("As the reject `bad_action`.", "As there."),
    "rejected without a reason": Problem(
        "A foreign classifier said `valid: false` without a reason.", "Have it say why."
    ),
}

OF_FRAMES: Mapping[str, Problem] = {
    "…: …": Problem("A kind of reject and its detail: `missing_joint: no torso`.", "As said of the kind, above."),
    "invalid skeleton": Problem("The source put a skeleton that is not valid, and no reason.", "Have it say why."),
    "the source says so": Problem("The source put an image that is not valid, and no reason.", "Have it say why."),
    "image_size_mismatch: …x…, calibrated for …": Problem("As the reject.", "As there."),
    "image_size_mismatch: …x…, calibrated for …x…": Problem("As the reject.", "As there."),
    "camera lost: …": Problem(
        "The camera gives nothing; what follows is one of the next lines.", "It is opened again."
    ),
    "it cannot be opened": Problem(
        "No such device, stream or file, or another program has it.", "Check `ACTUM_CAMERA`."
    ),
    "it gives no more pictures": Problem("A device or stream has stopped.", "Look at cable and network."),
    "it was closed": Problem("The gateway is stopping.", "Nothing."),
    "no picture for … s": Problem("The device opened and is silent.", "Unplug it and plug it in again."),
    "OpenCV says: …": Problem("OpenCV failed on the device or stream.", "As it says."),
    "no RealSense camera is connected": Problem("librealsense finds none.", "Check USB 3 cable and udev rules."),
    "the RealSense … was unplugged": Problem("It has gone.", "Plug it in."),
    "librealsense says: …": Problem("librealsense failed.", "As it says."),
    "colour comes as …, not as one of bgr8, …": Problem(
        "The RealSense gives another format.", "Set it to one of them."
    ),
    "no camera is connected that OpenNI 2 has a driver for": Problem(
        "OpenNI 2 finds none.", "Install the camera's driver; see [cameras](cameras.md)."
    ),
    "… was unplugged": Problem("The OpenNI device has gone.", "Plug it in."),
    "another driver took it": Problem(
        "A driver that is no player of files claims the recording.", "Remove that driver from OpenNI's folder."
    ),
    "the device has no colour and depth": Problem("It lacks one of the two streams.", "Use another camera."),
    "colour comes as …, not as RGB888": Problem("The OpenNI driver gives another format.", "Use another driver."),
    "OpenNI says: …": Problem("OpenNI failed.", "As it says."),
    "black: nothing can be seen; is the lens covered?": Problem(
        "Half a second of black images.", "Uncover it; make light."
    ),
    "frozen: the picture has not changed for … s": Problem("The same picture, bit for bit.", "Restart the camera."),
    "NiTE says: …": Problem("NiTE failed.", "As it says."),
    "NiTE cannot track people with this camera (…)": Problem("NiTE refuses the device.", "Unset `NITE2_REDIST64`."),
}

ABSENCES: Mapping[str, Problem] = {
    "no object in sight": Problem("No object was seen during the segment.", "Is a marker in view, in its scene file?"),
    "the hand is not known": Problem(
        "The acting hand was never known together with an object.",
        "Let the camera see the hand and the objects at once.",
    ),
    "no object within reach": Problem(
        "The hand came to no object nearer than `ACTUM_REACH_M`, 0.25 m.",
        "Check marker sizes and calibration: `actum watch objects posture` shows both.",
    ),
    "no object within reach was acted on": Problem(
        "Objects were near, but none moved with the hand or was worked at.",
        "Nothing, for a pantomime. `held` may say more.",
    ),
    "no object along the arm": Problem(
        "Every object is further than `ACTUM_POINTING_LIMIT_DEG`, 30°, off the line that is pointed along.",
        "Nothing, if it was pointed elsewhere.",
    ),
    "…; another moved …": Problem("One of these, and the objects that somebody else moved.", "Nothing."),
}

REASONS: Mapping[str, Problem] = {**OF_SEGMENTS, **OF_FRAMES, **ABSENCES}


def rejects_table() -> str:
    """Write the kinds of rejects, each once, with the services that count it."""
    rows = (
        [code(kind), ", ".join(map(code, services)) or "every service", problem.meaning, problem.remedy]
        for services, kinds in COUNTED_BY
        for kind, problem in kinds.items()
    )
    return table(["kind", "counted by", "meaning", "what to do"], rows)


def reasons_table() -> str:
    """Write the reasons that messages which are not valid give."""
    return "\n".join(
        [
            "Of actions and events:\n",
            _reasons(OF_SEGMENTS.items()),
            "Of skeletons, images, postures and objects:\n",
            _reasons(OF_FRAMES.items()),
        ]
    )


def absences_table() -> str:
    """Write why an event names no object."""
    return _reasons(ABSENCES.items())


def _reasons(problems: Iterable[tuple[str, Problem]]) -> str:
    rows = ([code(text), problem.meaning, problem.remedy] for text, problem in problems)
    return table(["text", "meaning", "what to do"], rows)
