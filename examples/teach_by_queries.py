"""Teach three actions by Zenoh queries alone, and have them recognised without marks: nothing of actum is imported.

    pip install eclipse-zenoh
    python teach_by_queries.py tcp/127.0.0.1:7447 kinect0

It asks a person to do each action five times. Where the simulated person takes requests, as beside
`actum up --driven --segments auto`, that one is asked.
"""

import json
import queue
import sys
import time

import zenoh

ENDPOINT, SENSOR = (
    ([*sys.argv[1:], "tcp/127.0.0.1:7447", "kinect0"])[:2] if len(sys.argv) != 2 else (sys.argv[1], "kinect0")
)
ACTIONS = ("lift", "push", "put")
TIMES = 5
LOOK_S = 0.5  # interval at which the trainer is asked how far it is


def ask(session, service, command, **fields):
    """Ask a service and return its reply; end where it refuses or does not answer."""
    key, text = f"actum/{SENSOR}/command/{service}/{command}", json.dumps(fields)
    for reply in session.get(key, payload=text, encoding="application/json", timeout=60):
        if reply.ok is None:
            sys.exit(f"{service} {command}: {json.loads(reply.err.payload.to_bytes())['error']}")
        return json.loads(reply.ok.payload.to_bytes())
    sys.exit(f"{service} does not answer: is it running?")


def takes_requests(session):
    """Tell whether it is the simulated person who acts, and takes requests."""
    replies = session.get(f"actum/{SENSOR}/command/sensor_gateway", timeout=5)
    return any(reply.ok is not None and b"perform" in reply.ok.payload.to_bytes() for reply in replies)


def request(session, simulated, actions):
    if simulated:
        ask(session, "sensor_gateway", "perform", actions=actions, object_id=1)
    else:
        print(f"please do {', '.join(actions)}, and stand still for two seconds before each and at the end")


def wait_for_take(session):
    """Print the count until the take has ended by itself."""
    counted = 0
    while True:
        take = ask(session, "model_trainer", "state")["recording"]
        if take["counted"] > counted:
            counted = take["counted"]
            print(f"  {counted} of {take['asked']}")
        if take["phase"] == "done":
            print(*(f"  {doubt}" for doubt in take["doubts"]), sep="\n", end="\n" if take["doubts"] else "")
            return
        time.sleep(LOOK_S)


def wait_for_job(session, job):
    """Print the stages of a job until it has ended; return its result."""
    stage = ""
    while job["state"] == "running":
        job = ask(session, "model_trainer", "job", job=job["id"])
        if job["stage"] != stage:
            stage = job["stage"]
            print(f"  {stage}")
        time.sleep(LOOK_S)
    if job["state"] != "done":
        sys.exit(f"{job['kind']} {job['state']}: {job['message']}")
    return job["result"]


def action_of(event):
    """Return the action of an event: of its MessagePack map only one short text is needed, a length and its letters."""
    value = event.payload.to_bytes().split(b"\xa6action", 1)[1]
    return value[1 : 1 + (value[0] & 31)].decode() if 0xA0 < value[0] < 0xC0 else "nothing that it knows"


def main():
    config = zenoh.Config.from_json5(json.dumps({"mode": "client", "connect": {"endpoints": [ENDPOINT]}}))
    name = time.strftime("taught %Y-%m-%d %H.%M.%S")
    with zenoh.open(config) as session:
        simulated = takes_requests(session)
        ask(session, "model_trainer", "create_set", set=name)
        for action in ACTIONS:
            print(f"{action}:")
            ask(session, "model_trainer", "record", set=name, label=action, person="me", count=TIMES)
            request(session, simulated, [action] * TIMES)
            wait_for_take(session)
        print("training:")
        result = wait_for_job(session, ask(session, "model_trainer", "train", set=name))
        print(*result["advice"], sep="\n")
        ask(session, "model_trainer", "activate", model=result["model"])
        print(f"model {result['model']} is in use")
        events = queue.Queue()
        session.declare_subscriber(f"actum/{SENSOR}/event/*", events.put)
        time.sleep(2)  # the classifier has looked for its new model by then
        request(session, simulated, list(ACTIONS))
        for _ in ACTIONS:
            print(f"recognised: {action_of(events.get(timeout=60))}")


main()
