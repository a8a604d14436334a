"""What services count as rejects: what each kind means and what to do about it.

A test collects the kinds from the code, so that a new one without an explanation here fails.
"""

from collections.abc import Mapping, Sequence
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
        "The payload is longer than its key admits: 64 MB for images, 250 kB otherwise. One twice as long does not even"
        " arrive: `drops` tells of it, where it is numbered.",
        "Send less: JPEG instead of `bgr8`, a smaller image.",
    ),
    "wrong_schema": Problem(
        "The encoding names another schema than the key's.", "Put each message on the key of its schema."
    ),
    "higher_version": Problem("The encoding names a later version of the schema.", "Update actum on this machine."),
    "not_msgpack": Problem(
        "The payload is no msgpack, is nested too deeply, or, where it is longer than 250 kB, has over 100,000 values.",
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
    "unwritable_state": Problem(
        "An answer could not be written to the folder `ACTUM_STATE`, or what was written there is gone: after a "
        "restart it may be given otherwise.",
        "Make room on that disk, and the folder writable; the service tries again with each answer.",
    ),
    "refused_command": Problem(
        "A command was not carried out: there is none of that name, its fields are wrong, or it cannot be done now.",
        "The asker was told why; so does the latest error.",
    ),
}

OF_NODES: Mapping[str, Problem] = {
    "stale_stamp": Problem(
        "A message is no newer than the one before it on its stream, so it is left out.",
        "Let `stamp_ns` rise, and a clock that starts anew bring a new `session_id`. Run one source for a sensor.",
    ),
}

OF_THREE: Mapping[str, Problem] = {
    "too_many_people": Problem(
        "More than 64 people came within a minute or so; the one silent for longest is forgotten, with what was kept.",
        "Does the sensor number the same people anew again and again? Who else puts on this key?",
    ),
}

OF_THE_LAST_TWO: Mapping[str, Problem] = {
    "too_many_frames": Problem(
        "More frames came in the last minute than are kept: 60,000 postures of all people, 4,000 messages of objects."
        " The oldest are forgotten, so a long segment lacks its first ones.",
        "Who puts so many? 60 a second of each of 16 people are kept.",
    ),
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

OF_MODELS: Mapping[str, Problem] = {
    "bad_model": Problem(
        "The model file cannot be read, or was made by another version; the model before stays in use.",
        "Train it anew: `actum train`.",
    ),
}

OF_CLASSIFIER: Mapping[str, Problem] = {
    "rejected_segment": Problem(
        "A segment was answered without a recognition; the event has `valid: false`.",
        "See the event's `reason`, below.",
    ),
    "too_many_segments": Problem(
        "A start came while 32 segments were open; it was answered at once, as rejected.",
        "Put the ends. Who puts so many starts?",
    ),
    "duplicate_mark": Problem(
        "A start or an end of a segment came a second time; the first one counts.",
        "Give each action a `segment_id` of its own, and each mark once.",
    ),
}

OF_TRACKER: Mapping[str, Problem] = {
    "image_too_large": Problem(
        "An image has more than 4096 × 4096 pixels, or a JPEG has more than 64 scans.", "Send smaller, plain images."
    ),
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
    "bad_object": Problem("An object is further away than 100 m; it is left out.", "Are positions in metres?"),
    "too_many_objects": Problem(
        "More than 128 different objects came within a minute; the new ones are left out.",
        "Number objects once; use a smaller dictionary of markers.",
    ),
    "too_many_actions": Problem(
        "More than 64 final actions waited for postures and objects; the oldest is answered with what has come.",
        "Who puts so many actions? The classifier has at most 32 segments open.",
    ),
    "bad_action": Problem(
        "A final action has no label, or no end; it is answered with an event that is not valid.",
        "Correct the program that puts actions; those of `som_classifier` have both.",
    ),
    "incomplete_segment": Problem(
        "Postures or objects of a segment never came, so that no object can be told; the event has `valid: false`.",
        "See the event's `reason`, below.",
    ),
    "duplicate_segment": Problem(
        "The same final action came twice; the second is left out.",
        "Is there a second classifier? `actum doctor` tells.",
    ),
}

OF_PAGE: Mapping[str, Problem] = {
    "refused_browser": Problem(
        "A browser was refused: another site's page, an unknown name, a wrong token, a mark or command that is wrong or"
        " cannot be passed on.",
        "The latest error says which; see [what the page lets in](page.md#who-gets-in).",
    ),
}

OF_FUSION_AND_BRIDGE: Mapping[str, Problem] = {
    "bad_joint": Problem(
        "A joint is not finite or beyond 100 m; it counts as missing.",
        "Correct the program that puts it; the bridge reads skeletons, the fusion postures.",
    ),
}

OF_BRIDGE: Mapping[str, Problem] = {
    "bad_mark": Problem(
        "What came on the ROS 2 topic `mark` is no mark; the latest error says why.",
        "Publish a `std_msgs/msg/String` with the JSON that [ROS 2](ros2.md#marks) shows.",
    ),
    "stamp_beyond_ros": Problem(
        "A stamp lies after January 2038, for which ROS 2 has no number; the message is not published there.",
        "Stamp in nanoseconds since 1970, or since the sensor started.",
    ),
}

OF_TRAINER: Mapping[str, Problem] = {
    "lost_take": Problem(
        "The take that was being recorded is lost: it could not be written, its set is gone, or the sensor's clock has"
        " begun anew or leaps.",
        "Record it again; where the disk of `ACTUM_TRAINER_DATA` is full, make room.",
    ),
    "refused_mark": Problem(
        "A mark bounds no example of the take that is recorded: its stamp lies outside of the take's frames, or an end"
        " has no start or lies more than 60 s after it.",
        "Correct the program that puts it: stamps are the frames', in nanoseconds. The latest error names the mark.",
    ),
    "unreadable_file": Problem(
        "A set, take or model in `ACTUM_TRAINER_DATA` cannot be read; everything else is listed.",
        "The latest error, and `unreadable` in the reply to `list`, name the file and why; mend it or move it away.",
    ),
    "lost_model": Problem(
        "Somebody has replaced the model in use, and no copy of it could be kept to return to.",
        "Make room on the disk of `ACTUM_TRAINER_DATA`.",
    ),
}

OF_HISTORY: Mapping[str, Problem] = {
    "unwritable_history": Problem(
        "What happened could not be stored; the latest error says why. It is tried again with each message.",
        "Make room on the disk, or let its user write the folder that `actum record --events` was given.",
    ),
    "unreadable_history": Problem(
        "A file that a killed process has left is no recording, or another process is still writing it; it stays as it "
        "is.",
        "The latest error says which. Copy a damaged one away if it matters; nothing else is lost.",
    ),
    "mark_without_stamp": Problem(
        "A mark without a stamp had no answer within 70 s, or before its segment's name was used again, so nobody "
        "knows when it was; it is not stored.",
        "Does the classifier run? `actum doctor` tells.",
    ),
}

GATEWAY, PREPROCESSOR, CLASSIFIER = "sensor_gateway", "pose_preprocessor", "som_classifier"
TRACKER, FUSION, BRIDGE, TRAINER = "marker_tracker", "action_fusion", "ros2_bridge", "model_trainer"
PAGE, HISTORY = "web_dashboard", "event_recorder"
COUNTED_BY: Sequence[tuple[tuple[str, ...], Mapping[str, Problem]]] = (
    ((), OF_ALL),
    ((PREPROCESSOR, CLASSIFIER, TRACKER, FUSION), OF_NODES),
    ((PREPROCESSOR, CLASSIFIER, FUSION), OF_THREE),
    ((CLASSIFIER, FUSION), OF_THE_LAST_TWO),
    ((GATEWAY, TRACKER), OF_IMAGES),
    ((GATEWAY,), OF_GATEWAY),
    ((PREPROCESSOR,), OF_PREPROCESSOR),
    ((CLASSIFIER, TRAINER), OF_MODELS),
    ((CLASSIFIER,), OF_CLASSIFIER),
    ((TRACKER,), OF_TRACKER),
    ((FUSION,), OF_FUSION),
    ((TRAINER,), OF_TRAINER),
    ((PAGE,), OF_PAGE),
    ((FUSION, BRIDGE), OF_FUSION_AND_BRIDGE),
    ((BRIDGE,), OF_BRIDGE),
    ((HISTORY,), OF_HISTORY),
)
"""Which services count which kinds; all of them count what the runtime does."""

REJECTS: Mapping[str, tuple[str, ...]] = {kind: services for services, kinds in COUNTED_BY for kind in kinds}
"""The services that count each kind."""


def rejects_table() -> str:
    """Write the kinds of rejects, each once, with the services that count it."""
    rows = (
        [code(kind), ", ".join(map(code, services)) or "every service", problem.meaning, problem.remedy]
        for services, kinds in COUNTED_BY
        for kind, problem in kinds.items()
    )
    return table(["kind", "counted by", "meaning", "what to do"], rows)
