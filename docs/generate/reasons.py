"""The reasons that messages give which are not valid, and why an event names no object: what each means, what to do.

A test collects them from the code, so that a new one without an explanation here fails. `…` stands for what differs.
"""

from collections.abc import Iterable, Mapping

from docs.generate.markdown import code, table
from docs.generate.rejects import Problem

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
    "too many open segments: … at the most": Problem(
        "32 segments were open when this one started.", "Put the ends of those; see the reject `too_many_segments`."
    ),
    "marks are not used: the classifier's setting segments is auto": Problem(
        "The classifier answers only what it finds by itself.", "Set `--segments both` to use marks as well."
    ),
    "segment_id reused": Problem("The name belongs to a segment that was answered.", "Give each action a new name."),
    "frames lost: none came for … s of the segment": Problem(
        "For so long within the segment frames were captured that never came: a service before the classifier was"
        " started anew, or the network lost them.",
        "Mark the action again; see `drops` in `status`, and which service was restarted.",
    ),
    "frames lost: none came for the last … s of the segment": Problem(
        "The frames stopped coming before the segment's end, and for ten seconds none came.",
        "Has the recording ended, is the camera or the network lost?",
    ),
    "the classifier was not there: its first frame is … s after the start": Problem(
        "The classifier was started after the segment had begun, and the frames before are kept no more.",
        "Mark the action again.",
    ),
    "the classifier was not there: no frame has come since": Problem(
        "The classifier was started after the segment, and no frame has come to it yet.", "Does the gateway run?"
    ),
    "the classifier had only just started: it cannot tell when a mark without a stamp was put": Problem(
        "Such a mark means *now*, and it may have been put while the classifier was away.",
        "Mark the action again, or stamp marks on the sensor's clock.",
    ),
    "the fusion was not there: its first posture is … s after the start": Problem(
        "The fusion was started after the segment had begun, and the postures before are kept no more.",
        "Mark the action again.",
    ),
    "the fusion was not there: no posture has come since": Problem(
        "The fusion was started after the segment, and no posture has come to it yet.", "Does the gateway run?"
    ),
    "the fusion was not there: no objects have come since": Problem(
        "The fusion was started after the segment, and of the objects that there were none has come to it yet.",
        "Does the tracker run?",
    ),
    "… lost: none came for … s of the segment": Problem(
        "`objects` or `postures`: for so long none came to the fusion, which cannot tell what became of the objects.",
        "Were tracker or preprocessor restarted, is the network lost? Mark the action again.",
    ),
    "objects lost: the first came … s after the start": Problem(
        "The tracker began to put objects only then.", "Mark the action again."
    ),
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
    "it cannot be opened: …": Problem(
        "No such device, or another program has it; the cameras of this machine follow.",
        "Name one of them in `--camera` (`ACTUM_CAMERA`).",
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
