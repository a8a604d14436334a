"""The kinds of rejects that services count: meaning and remedy of each.

A test collects the kinds from the code and fails for one that is not explained here.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from docs.generate.markdown import code, table


@dataclass(frozen=True)
class Problem:
    """The meaning of a kind or a reason, and its remedy."""

    meaning: str
    remedy: str


OF_ALL: Mapping[str, Problem] = {
    "unknown_key": Problem(
        "A message or a recording's channel has a key below `actum/` that is not on this page.",
        "Correct the key.",
    ),
    "too_large": Problem(
        "The payload is larger than its key admits: 64 MB for images, 250 kB otherwise. Payloads larger than twice "
        "this limit are lost and counted in `drops`.",
        "Send less: JPEG instead of `bgr8`, or a smaller image.",
    ),
    "wrong_schema": Problem(
        "The encoding of the message names a schema that is not the key's.",
        "Publish each message on the key of its schema.",
    ),
    "higher_version": Problem("The encoding names a later version of the schema.", "Update actum on this machine."),
    "not_msgpack": Problem(
        "The payload is not msgpack, is nested too deeply, or is longer than 250 kB with over 100,000 values.",
        "Pack the message as one msgpack map, in Python with `msgpack.packb(fields)`.",
    ),
    "not_a_map": Problem(
        "The payload is msgpack, but not a map with text keys.", "Send a map of field names to values."
    ),
    "wrong_fields": Problem(
        "A field is missing, has another type, or is out of its bounds; the latest error names it.",
        "Compare the message with its table on this page or with its JSON Schema.",
    ),
    "wrong_key": Problem(
        "The message names another sensor, agent or service than its key, or is a depth image on the colour key, or "
        "the reverse.",
        "Use the key's `sensor`, `agent` and `service`, or leave `sensor` out.",
    ),
    "unwritable_state": Problem(
        "An answer could not be written to the folder `ACTUM_STATE`, or the stored answers were deleted. After a "
        "restart, the segment of this answer may get a different one.",
        "Free disk space and make the folder writable; the service retries with each answer.",
    ),
    "refused_command": Problem(
        "The service refused a command: its name is unknown, its fields are wrong, or it is impossible at this time.",
        "Read the error in the reply, or the latest error.",
    ),
}

OF_NODES: Mapping[str, Problem] = {
    "stale_stamp": Problem(
        "A message is not newer than the previous one on its stream; the service ignores the message.",
        "Publish rising `stamp_ns`, and a new `session_id` when the clock restarts. Run one source per sensor.",
    ),
}

OF_THREE: Mapping[str, Problem] = {
    "too_many_people": Problem(
        "More than 64 people appeared within about a minute; the service forgets the person not seen for longest.",
        "Check whether the sensor renumbers people, and who else publishes on this key.",
    ),
}

OF_THE_LAST_TWO: Mapping[str, Problem] = {
    "too_many_frames": Problem(
        "More frames arrived in the last minute than are kept: 60,000 postures of all people, 4,000 messages of "
        "objects. The oldest are dropped, so long segments lack their first frames.",
        "Find the program that publishes too fast. The limit allows 60 postures a second for each of 16 people.",
    ),
    "late": Problem(
        "A sample or end mark arrived after its segment was answered, more than 2 s after the other streams.",
        "Find what delays the stream: `latency_ms` and `drops` in `status`, the network, a camera's buffering.",
    ),
    "bad_posture": Problem(
        "A valid posture lacks its joints, or has values that are not finite or absurd.",
        "Correct the program that publishes postures.",
    ),
}

OF_IMAGES: Mapping[str, Problem] = {
    "image_size_mismatch": Problem(
        "The image has another size than its calibration file or, in the tracker, than the message or the JPEG states.",
        "Calibrate at the size in use, or request the calibrated size with `ACTUM_CAMERA_SIZE`.",
    ),
}

OF_GATEWAY: Mapping[str, Problem] = {
    "camera_lost": Problem(
        "The camera cannot be opened, was unplugged, or is silent, black or frozen; see `state`.",
        "Check cable, lens and device name. The gateway retries after 0.5, 1, 2 … 8 s.",
    ),
    "damaged_recording": Problem(
        "The recording cannot be read beyond a damaged part, and is played up to that part.",
        "Copy the recording again.",
    ),
    "truncated_recording": Problem(
        "The recording ends abruptly, as after a power cut, and is played up to its end.", "Nothing."
    ),
}

OF_PREPROCESSOR: Mapping[str, Problem] = {
    "invalid_skeleton": Problem("The source marked this frame as not valid.", "See the skeleton's `reason`."),
    "repeated_agent": Problem(
        "Two people in one frame have the same number; the last one counts.", "Give each person a number."
    ),
    "repeated_joints": Problem(
        "All joints equal those of the previous frame: the tracker lost the person and repeats itself.",
        "If it lasts, step into view or restart the tracker.",
    ),
    "missing_joint": Problem(
        "Torso or neck is missing for longer than 0.3 s, or neither both hips nor both shoulders are known.",
        "Let the camera see the trunk.",
    ),
    "not_finite": Problem("A joint is NaN or infinite.", "Publish null for a missing joint."),
    "absurd_joint": Problem(
        "A joint is further from the camera than `ACTUM_REACH_LIMIT_M`, 10 m.", "Publish joints in metres, not in mm."
    ),
    "absurd_bone": Problem(
        "A bone is longer than `ACTUM_BONE_LIMIT_M`, 1.5 m.", "Publish joints in metres, in the order of `joint_names`."
    ),
    "coincident_joints": Problem(
        "Joints coincide or lie on one line, so they define no body frame.",
        "If it lasts, check the program that publishes skeletons.",
    ),
}

OF_MODELS: Mapping[str, Problem] = {
    "bad_model": Problem(
        "The model file cannot be read, or another version made it; the previous model stays in use.",
        "Train it again with `actum train`.",
    ),
}

OF_CLASSIFIER: Mapping[str, Problem] = {
    "rejected_segment": Problem(
        "The classifier answered a segment without recognising an action; its event has `valid: false`.",
        "See the event's `reason`.",
    ),
    "too_many_segments": Problem(
        "A segment started while 32 were open; it was rejected at once.",
        "Publish the end marks, or find the program that starts so many.",
    ),
    "duplicate_mark": Problem(
        "A start or end was published twice; the first one counts.",
        "Publish each mark once, with a new `segment_id` for each action.",
    ),
}

OF_TRACKER: Mapping[str, Problem] = {
    "image_too_large": Problem(
        "An image has more than 4096 × 4096 pixels, or a JPEG more than 64 scans.", "Send smaller, plain images."
    ),
    "undecodable_image": Problem("The bytes are not a JPEG, or a damaged one.", "Send whole JPEG files as `data`."),
    "black_image": Problem("The image is black.", "Uncover the lens, or add light."),
    "bad_calibration": Problem(
        "`K`, `distortion` or `skeleton_from_image` is impossible for a camera; the latest error says which and why.",
        "Calibrate with `actum calibrate intrinsics`, a second camera with `actum calibrate extrinsics`.",
    ),
    "calibration_size_mismatch": Problem(
        "`K` does not fit the image's size.", "Calibrate at this size, or set `ACTUM_CALIBRATED_SIZE_PX`."
    ),
    "unknown_marker": Problem(
        "A visible marker belongs to no object.", "Add the marker to the scene file, or remove it from view."
    ),
    "repeated_marker": Problem(
        "One marker number is visible twice; the one nearest to its last place counts.", "Print each number once."
    ),
    "bad_pose": Problem(
        "No pose in front of the camera fits the marker's corners.", "If it lasts, keep the marker flat."
    ),
    "outlying_pose": Problem(
        "An object seems to have jumped further than possible; a second sighting there confirms it.",
        "If it lasts, use more light, larger markers, or a calibrated camera.",
    ),
    "markers_disagree": Problem(
        "The markers of one object are not placed as in the scene file; the largest one counts.",
        "Measure their places on the object again.",
    ),
}

OF_FUSION: Mapping[str, Problem] = {
    "bad_object": Problem("An object is further away than 100 m; it is ignored.", "Publish positions in metres."),
    "repeated_object": Problem(
        "Two objects in one message have the same number; the last one counts.", "Give each object a number."
    ),
    "too_many_objects": Problem(
        "More than 128 different objects appeared within a minute; new ones are ignored.",
        "Let each object keep its number, or use a smaller marker dictionary.",
    ),
    "too_many_actions": Problem(
        "More than 64 final actions waited for postures and objects; the oldest is answered with the data that "
        "has arrived.",
        "Find the program that publishes so many; the classifier has at most 32 open segments.",
    ),
    "bad_action": Problem(
        "A final action lacks its label or end; its event has `valid: false`.",
        "Correct the program that publishes actions.",
    ),
    "incomplete_segment": Problem(
        "Postures or objects of a segment never arrived, so its object is unknown; its event has `valid: false`.",
        "See the event's `reason`.",
    ),
    "duplicate_segment": Problem(
        "A final action arrived twice; the second is ignored.", "Look for a second classifier with `actum doctor`."
    ),
}

OF_PAGE: Mapping[str, Problem] = {
    "refused_browser": Problem(
        "A browser was refused: its request came from another site or under an unknown host name, or had a wrong "
        "token, mark or command.",
        "See the latest error, and [who gets in](page.md#who-gets-in).",
    ),
}

OF_FUSION_AND_BRIDGE: Mapping[str, Problem] = {
    "bad_joint": Problem(
        "A joint is not finite or beyond 100 m; it counts as missing.",
        "Correct the program that publishes postures (fusion) or skeletons (bridge).",
    ),
}

OF_BRIDGE: Mapping[str, Problem] = {
    "unusable_image": Problem(
        "An image from which people are to be cut out is damaged or too large; the latest error says why.",
        "Send whole JPEG files as `data`, of at most 4096 × 4096 pixels.",
    ),
    "unusable_camera": Problem(
        "An image's focal lengths are not positive, or its `skeleton_from_image` is not rigid. People's places in the "
        "image are those of the camera before.",
        "Calibrate the camera with [`actum calibrate`](cameras.md), or correct the program that publishes images.",
    ),
    "bad_mark": Problem(
        "A message on the ROS 2 topic `mark` is not a mark; the latest error says why.",
        "Publish a `std_msgs/msg/String` with [this JSON](ros2.md#marks).",
    ),
    "stamp_beyond_ros": Problem(
        "A stamp is after January 2038, the last that ROS 2 can represent; the message is not published to ROS 2.",
        "Stamp in nanoseconds since 1970, or since the sensor started.",
    ),
    "bad_body_message": Problem(
        "A message about bodies from ROS 2 is longer than 250 kB or not of its topic's type.",
        "Use the message types of `hri_msgs` 2.3.2 and of the ROS 2 distribution in `--ros-distro`.",
    ),
    "bad_body_id": Problem(
        "`/humans/bodies/tracked` contains an id that no ROS 2 topic can have; this body is left out.",
        "Use letters, digits and underscores, at most 64 of them.",
    ),
    "bad_body_description": Problem(
        "A text on `/humans/bodies/<id>/urdf` does not describe a body; human_description's bones are used instead.",
        "Publish the URDF that `xacro` makes of human_description.",
    ),
    "too_many_bodies": Problem(
        "`/humans/bodies/tracked` contains more than 64 bodies; the first 64 are used.",
        "Check the body detector.",
    ),
    "bad_body_stamp": Problem(
        "A transform, or a message about bodies, has no stamp; it is not used, but for the ids of a list of bodies.",
        "Set `header.stamp` to the time at which the image was captured.",
    ),
    "bad_transform": Problem(
        "A transform has a number that is not finite, a translation of over 1,000 km, a quaternion whose length is "
        "not 1, or a frame's name of more than 256 characters; it is not used.",
        "Correct the node that publishes this frame; the latest error names the frame.",
    ),
}

OF_TRAINER: Mapping[str, Problem] = {
    "lost_take": Problem(
        "The take in progress is lost: it could not be written, its set was deleted, or the sensor's clock "
        "restarted or jumped.",
        "If the disk with `ACTUM_TRAINER_DATA` is full, free disk space. Record the take again.",
    ),
    "refused_mark": Problem(
        "A mark bounds no example of the take: its stamp is outside the take's frames, or its end has no start or "
        "comes more than 60 s later.",
        "Correct the program that publishes it: stamps are those of frames, in nanoseconds. The latest error "
        "names the mark.",
    ),
    "unreadable_file": Problem(
        "A set, take or model in `ACTUM_TRAINER_DATA` cannot be read, or not to its end; all others are listed.",
        "Repair or move the file that the latest error, or `unreadable` in the reply to `list`, names.",
    ),
    "lost_model": Problem(
        "Somebody replaced the model in use, and no copy could be kept for `undo`.",
        "Free disk space for `ACTUM_TRAINER_DATA`.",
    ),
}

OF_HISTORY: Mapping[str, Problem] = {
    "unwritable_history": Problem(
        "Events could not be stored; the latest error says why. Each message triggers a retry.",
        "Free disk space, or make the folder of `actum record --events` writable.",
    ),
    "unreadable_history": Problem(
        "A file left by a killed process is not a recording, or another process still writes it; it is kept unchanged.",
        "See the latest error for its name; nothing else is lost.",
    ),
    "mark_without_stamp": Problem(
        "A mark without a stamp got no answer within 70 s, or before its `segment_id` was reused, so its time is "
        "unknown; it is not stored.",
        "Check with `actum doctor` that the classifier runs.",
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
"""The kinds by the services that count them; every service counts those of the runtime."""

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
