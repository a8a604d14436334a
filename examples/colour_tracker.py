"""Tracks coloured things with plain OpenCV instead of markers; whatever puts `objects` will do.

pip install eclipse-zenoh msgpack opencv-python-headless
ACTUM_CONNECT=tcp/127.0.0.1:7447 ACTUM_SENSOR=kinect0 python colour_tracker.py

It reads `actum/<sensor>/image/color` and puts `actum/<sensor>/objects`: msgpack maps, metres, camera frame (x right,
y down, z forward). How far a thing is follows from how wide it looks; a depth image would tell better.
"""

import os

import cv2
import msgpack
import numpy as np
import zenoh

# id: name, hue from and to (OpenCV's, 0 to 179, red is at both ends), least saturation (0 to 255), width in metres
THINGS = {
    1: ("cup", 174, 8, 140, 0.148),
    2: ("box", 55, 75, 115, 0.135),
    3: ("book", 100, 113, 170, 0.120),
}
LEAST_BRIGHTNESS, LEAST_AREA_PX = 40, 600
GAP_PX = 41  # what covers the middle of a thing, like a label, is no wider
STEADINESS = 0.7  # how much of a distance stays from image to image


def blob(hsv, hue_from, hue_to, saturation):
    """Find the largest patch of a colour: left, top, width, height in pixels, or None."""
    hue = (hsv[..., 0].astype(int) - hue_from) % 180
    mask = (hue <= (hue_to - hue_from) % 180) & (hsv[..., 1] >= saturation) & (hsv[..., 2] >= LEAST_BRIGHTNESS)
    mask = cv2.medianBlur(mask.astype(np.uint8), 3)  # single pixels go
    mask = cv2.morphologyEx(mask, cv2.MORPH_CLOSE, np.ones((GAP_PX, GAP_PX), np.uint8))
    patches, _ = cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    largest = max(patches, key=cv2.contourArea, default=None)
    return None if largest is None or cv2.contourArea(largest) < LEAST_AREA_PX else cv2.boundingRect(largest)


def position(patch, width_m, focal_px, centre_px, last_m):
    """Where a thing is in the camera's frame; its distance is smoothed."""
    left, top, width, height = patch
    z = focal_px[0] * width_m / width
    z = z if last_m is None else STEADINESS * last_m[2] + (1 - STEADINESS) * z
    x, y = (left + (width - 1) / 2 - centre_px[0]) / focal_px[0], (top + (height - 1) / 2 - centre_px[1]) / focal_px[1]
    return [x * z, y * z, z]


def objects(image, last_m):
    """Find the things in one image; `last_m` keeps where they were."""
    if image["format"] != "jpeg" or not image["data"]:
        return []
    pixels = cv2.imdecode(np.frombuffer(image["data"], np.uint8), cv2.IMREAD_COLOR)
    if pixels is None:
        return []
    hsv = cv2.cvtColor(pixels, cv2.COLOR_BGR2HSV)
    fx, _, cx, _, fy, cy, *_ = image["K"]
    skeleton_from_image = np.array(image["skeleton_from_image"]).reshape(4, 4)
    found = []
    for number, (name, hue_from, hue_to, saturation, width_m) in THINGS.items():
        patch = blob(hsv, hue_from, hue_to, saturation)
        if patch is not None:
            last_m[number] = position(patch, width_m, (fx, fy), (cx, cy), last_m.get(number))
            place = skeleton_from_image @ [*last_m[number], 1.0]
            found.append({"id": number, "name": name, "position_m": place[:3].tolist(),
                          "quaternion_xyzw": [0.0, 0.0, 0.0, 1.0], "confidence": 0.5, "seen": True})  # fmt: skip
    return found


def main():
    base = f"actum/{os.environ.get('ACTUM_SENSOR', 'kinect0')}"
    config = zenoh.Config()
    config.insert_json5("mode", '"client"')
    config.insert_json5("connect/endpoints", f'["{os.environ.get("ACTUM_CONNECT", "tcp/127.0.0.1:7447")}"]')
    last_m = {}
    with zenoh.open(config) as session:
        put = session.declare_publisher(f"{base}/objects", encoding="application/msgpack;actum.objects/1")
        newest = zenoh.handlers.RingChannel(1)
        with session.declare_subscriber(f"{base}/image/color", newest) as images:
            while True:
                image = msgpack.unpackb(images.recv().payload.to_bytes())
                answer = {"stamp_ns": image["stamp_ns"], "session_id": image.get("session_id", "")}
                put.put(msgpack.packb({**answer, "objects": objects(image, last_m)}))


if __name__ == "__main__":
    main()
