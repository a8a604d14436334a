"""The reasons of messages that are not valid, and of events without an object: meaning and remedy of each.

A test collects them from the code and fails for one that is not explained here. `…` stands for text that varies.
"""

from collections.abc import Iterable, Mapping

from docs.generate.markdown import code, table
from docs.generate.rejects import Problem

OF_SEGMENTS: Mapping[str, Problem] = {
    "no model": Problem("The classifier has no model.", "Set `--model` or `ACTUM_MODEL`, or train a model."),
    "too few frames: …, at least … are needed": Problem(
        "The segment has too few usable postures.",
        "Mark longer: from before the action begins until it is over.",
    ),
    "no person": Problem(
        "No posture of any person lies within the segment.", "Check that somebody is in view and the gateway runs."
    ),
    "no person with a usable frame": Problem(
        "None of the postures within the segment is usable; the cause follows in brackets.",
        "See the table of rejects.",
    ),
    "no usable frame": Problem(
        "None of the postures of the marked agent is usable; the cause follows in brackets.",
        "See the table of rejects.",
    ),
    "… (…)": Problem(
        "A reason from this table with its cause in brackets, such as `no usable frame (missing_joint: no torso)`.",
        "See that reason.",
    ),
    "end without start": Problem(
        "An end mark arrived without a start mark before it.",
        "Publish the start mark first, with the same `segment_id`. Publish marks with `CongestionControl.BLOCK`, so "
        "none is dropped.",
    ),
    "end before start": Problem(
        "The end mark has an earlier stamp than the start mark.",
        "Give both marks stamps on the sensor's clock, or none.",
    ),
    "start without end: no end within 60 s": Problem(
        "The end mark is missing, or the segment is longer than 60 s.",
        "Publish a start mark and an end mark for each action.",
    ),
    "start without end: no frame came after the start": Problem(
        "No posture arrived after the start mark, and no end mark within 62 s.",
        "Check that the gateway runs, and that the mark's stamp is not in the future.",
    ),
    "start without end: the frames ended … s after the start": Problem(
        "Postures stopped arriving, and no end mark arrived within 62 s.",
        "Check whether the recording ended or the camera is lost.",
    ),
    "too many open segments: … at the most": Problem(
        "The segment started while 32 others were open.",
        "Publish the end marks of those segments; see the reject `too_many_segments`.",
    ),
    "marks are not used: the classifier's setting segments is auto": Problem(
        "The classifier answers only segments that it finds itself.", "Use `--segments both`."
    ),
    "segment_id reused": Problem(
        "A segment of this name was already answered.", "Use a new `segment_id` for each action."
    ),
    "frames lost: none came for … s of the segment": Problem(
        "Frames within the segment were captured but never arrived: a service before the classifier was "
        "restarted, or the network lost them.",
        "Mark the action again; see `drops` in `status`.",
    ),
    "frames lost: none came for the last … s of the segment": Problem(
        "Frames stopped arriving before the segment's end, and none arrived for ten seconds, or the marks' stamps are "
        "of another clock.",
        "Check the recording, the camera, the network and the marks' stamps.",
    ),
    "the classifier started late: its first frame is … s after the segment's start": Problem(
        "The classifier was started after the segment had begun, and earlier frames are no longer kept.",
        "Mark the action again.",
    ),
    "the classifier started late: it has received no frame since its start": Problem(
        "The classifier was started after the segment's end, and no frame has arrived yet.",
        "Check that the gateway runs.",
    ),
    "the classifier had only just started, so it could not date a mark without a stamp": Problem(
        "A mark without a stamp means *now*, but this mark may have been published before the classifier was started.",
        "Mark the action again, or give marks stamps on the sensor's clock.",
    ),
    "the fusion started late: its first posture is … s after the segment's start": Problem(
        "The fusion was started after the segment had begun, and earlier postures are no longer kept.",
        "Mark the action again.",
    ),
    "the fusion started late: it has received no posture since its start": Problem(
        "The fusion was started after the segment's end, and no posture has arrived yet.",
        "Check that the gateway runs.",
    ),
    "the fusion started late: it has received no objects since its start": Problem(
        "The fusion was started after the segment's end, and no objects have arrived yet, although there were some.",
        "Check that the tracker runs.",
    ),
    "objects lost: none came for … s of the segment": Problem(
        "No message with objects arrived for so long that the action's object is unknown.",
        "Check the network, and whether the marker tracker was restarted. Mark the action again.",
    ),
    "postures lost: none came for … s of the segment": Problem(
        "No posture arrived for so long that the action's object is unknown.",
        "Check the network, and whether the pose preprocessor was restarted. Mark the action again.",
    ),
    "objects lost: the first came … s after the start": Problem(
        "The tracker published its first objects only after the segment had started.", "Mark the action again."
    ),
    "the source started anew": Problem(
        "The sensor was restarted while the segment was open, so its stamps do not continue.", "Mark the action again."
    ),
    "final action without a label or an end": Problem(
        "A final action lacks its label or end.", "Correct the program that publishes actions."
    ),
    "rejected without a reason": Problem(
        "A classifier that is not part of actum published `valid: false` without a reason.",
        "Publish a reason.",
    ),
}

OF_FRAMES: Mapping[str, Problem] = {
    "…: …": Problem(
        "A kind of reject and its detail, such as `missing_joint: no torso`.",
        "See the table of rejects.",
    ),
    "invalid skeleton": Problem(
        "The source published a skeleton with `valid: false` and no reason.", "Publish a reason."
    ),
    "the source gave no reason": Problem(
        "The source published an image with `valid: false` and no reason.", "Publish a reason."
    ),
    "image_size_mismatch: …x…, calibrated for …": Problem(
        "The image has another size than its calibration.", "See the reject `image_size_mismatch`."
    ),
    "image_size_mismatch: …x…, calibrated for …x…": Problem(
        "The image has another size than its calibration.", "See the reject `image_size_mismatch`."
    ),
    "camera lost: …": Problem(
        "The camera gives no pictures; the cause follows, as in the next rows.",
        "See the cause. The gateway reopens the camera by itself.",
    ),
    "it cannot be opened": Problem(
        "The device, stream or file does not exist, or another program uses it.", "Check `ACTUM_CAMERA`."
    ),
    "it cannot be opened: …": Problem(
        "The device does not exist, or another program uses it; the cameras of this machine follow.",
        "Name one of them in `--camera` (`ACTUM_CAMERA`).",
    ),
    "it gives no more pictures": Problem("A device or stream has stopped.", "Check cable and network."),
    "it was closed": Problem("The gateway is stopping.", "Nothing."),
    "the camera sent no picture for … s: if this repeats, unplug the camera and plug it in again": Problem(
        "The device opened, but is silent.", "Unplug it and plug it in again."
    ),
    "OpenCV says: …": Problem("OpenCV failed on the device or stream.", "Read the message."),
    "no RealSense camera is connected: plug one in": Problem(
        "librealsense finds no camera.", "Check USB 3 cable and udev rules."
    ),
    "the RealSense camera with serial number … was unplugged: plug it in again": Problem(
        "The camera was unplugged.", "Plug it in."
    ),
    "librealsense says: …": Problem("librealsense failed.", "Read the message."),
    "the camera sends colour images in the format …, which actum cannot read: use one of the formats bgr8, …": Problem(
        "The RealSense camera sends a colour format that actum cannot read.", "Set a supported format."
    ),
    "no camera that OpenNI 2 supports is connected: plug one in": Problem(
        "OpenNI 2 finds no camera.", "Install the camera's driver; see [cameras](cameras.md#depth-cameras)."
    ),
    "… was unplugged": Problem("The OpenNI device was unplugged.", "Plug it in."),
    "OpenNI cannot play the file, because another driver in OpenNI's driver folder treats the file as a camera: "
    "remove that driver from the folder": Problem(
        "A driver that does not play files claims the recording.", "Remove that driver from OpenNI's folder."
    ),
    "the camera does not send both colour and depth images: use a camera that sends both": Problem(
        "One of the two streams is missing.", "Use another camera."
    ),
    "the camera sends colour images in the format …, but actum reads only RGB888: use another driver": Problem(
        "The OpenNI driver sends a colour format that actum cannot read.", "Use another driver."
    ),
    "OpenNI says: …": Problem("OpenNI failed.", "Read the message."),
    "black: nothing can be seen; is the lens covered?": Problem(
        "Images have been black for half a second.", "Uncover the lens, or add light."
    ),
    "frozen: the picture has not changed for … s": Problem("The picture repeats bit for bit.", "Restart the camera."),
    "NiTE says: …": Problem("NiTE failed.", "Read the message."),
    "NiTE, which finds people in depth images, cannot use this camera (…): unset NITE2_REDIST64 and NITE2_REDIST, and "
    "restart the gateway. The gateway then finds people with the pose model": Problem(
        "NiTE refuses the device.", "Unset both environment variables."
    ),
}

ABSENCES: Mapping[str, Problem] = {
    "no object in sight": Problem("No object was seen during the segment.", "Show a marker that is in the scene file."),
    "the hand is not known": Problem(
        "At no time were the places of both the acting hand and an object known.",
        "Let the camera see hand and objects at once.",
    ),
    "no object within reach": Problem(
        "The hand came no nearer than `ACTUM_REACH_M`, 0.25 m, to any object.",
        "Check marker sizes and calibration with `actum watch objects posture`.",
    ),
    "no object within reach was acted on": Problem(
        "Objects were near, but none of them moved with the hand or was worked at.",
        "Nothing, if the person mimed the action. The event's `held` may name a tool in the hand.",
    ),
    "no object along the arm": Problem(
        "Every object is further than `ACTUM_POINTING_LIMIT_DEG`, 30°, from the line of pointing.",
        "Nothing, if the person pointed elsewhere.",
    ),
    "…; another moved …": Problem("A reason from this table, and the objects that another person moved.", "Nothing."),
}

REASONS: Mapping[str, Problem] = {**OF_SEGMENTS, **OF_FRAMES, **ABSENCES}


def reasons_table() -> str:
    """Write the reasons of messages that are not valid."""
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
