"""Moves a gripper to the place that a hand is about to reach, before the hand arrives; here it prints the place.

pip install eclipse-zenoh msgpack
ACTUM_CONNECT=tcp/127.0.0.1:7447 ACTUM_SENSOR=kinect0 python handover.py

Places are in metres in the camera frame: x right, y down, z forward.
"""

import os

import msgpack
import zenoh

LEAST_PROBABILITY, LEAST_AHEAD_S = 0.8, 0.3  # sure enough to move, and early enough to arrive
LOST_NS = 500_000_000  # a person of whom nothing comes for so long was lost from view: the reach is over


def target(intent, reaches):
    """Return the contact to move for, once per reach; `reaches` keeps each person's last stamp and contact."""
    agent, stamp_ns, likeliest = intent["agent"], intent["stamp_ns"], next(iter(intent["intended"]), None)
    last_ns, chosen = reaches.pop(agent, (stamp_ns, None))
    if likeliest is None:
        return None
    chosen = chosen if 0 <= stamp_ns - last_ns < LOST_NS else None
    is_sure = likeliest["soon_probability"] >= LEAST_PROBABILITY and likeliest["contact_s"] >= LEAST_AHEAD_S
    is_new = is_sure and not chosen
    reaches[agent] = stamp_ns, likeliest if is_new else chosen
    return likeliest if is_new else None


def main():
    config, reaches = zenoh.Config(), {}
    config.insert_json5("mode", '"client"')
    config.insert_json5("connect/endpoints", f'["{os.environ.get("ACTUM_CONNECT", "tcp/127.0.0.1:7447")}"]')
    key = f"actum/{os.environ.get('ACTUM_SENSOR', 'kinect0')}/intent/*"
    with zenoh.open(config) as session, session.declare_subscriber(key) as intents:
        for sample in intents:
            contact = target(msgpack.unpackb(sample.payload.to_bytes()), reaches)
            if contact is not None:
                x, y, z = contact["place_m"]
                print(f"gripper to {x:.2f} {y:.2f} {z:.2f} for {contact['object_name']}", flush=True)


if __name__ == "__main__":
    main()
