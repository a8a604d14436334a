"""Commands over Zenoh: asked by our client, and by a program that knows nothing but JSON."""

import json

import pytest
import zenoh

from actum import keys
from actum.commands import Refusal
from actum.messages import Action, Segment, Status, Truth
from actum.runtime import Client, NotAnsweredError
from actum.runtime.session import client_config
from live import System, collect, wait_until

pytestmark = pytest.mark.system


def asked(session: zenoh.Session, key: str, payload: str | None = None) -> tuple[list[dict], list[dict]]:
    """Replies and errors, as a program gets them that has JSON and no library of ours."""
    replies = list(session.get(key, payload=payload, timeout=5.0))
    good = [json.loads(reply.ok.payload.to_string()) for reply in replies if reply.ok is not None]
    return good, [json.loads(reply.err.payload.to_string()) for reply in replies if reply.err is not None]


def first_reply(session: zenoh.Session, key: str) -> dict:
    """Ask until there is a reply: a service may be known to be alive before its commands are."""
    wait_until(lambda: asked(session, key)[0] != [], f"{key} is answered")
    return asked(session, key)[0][0]


def test_a_service_is_asked_in_json_and_says_what_it_can_be_asked(running: System, client: Client) -> None:
    running.start("pose_preprocessor")
    running.wait_for_services(client, "pose_preprocessor")
    base = keys.commands_key("kinect0", "pose_preprocessor")
    with zenoh.open(client_config(running.settings)) as session:
        listed = first_reply(session, base)
        assert [each["name"] for each in listed["commands"]] == ["parameters", "set_parameters"]
        (changed,), _ = asked(session, f"{base}/set_parameters", '{"values": {"reach_limit_m": 4}}')
        assert changed["parameters"][0]["value"] == 4.0
        assert asked(session, f"{base}/parameters")[0] == [changed]
        for key, payload in [
            (f"{base}/set_parameters", '{"values": {"reach_limit_m": -4}}'),
            (f"{base}/set_parameters", '{"values": {"reach_limit_m": 1e999}}'),
            (f"{base}/set_parameters", '{"values": {"\\ud800": 1}}'),
            (f"{base}/set_parameters", "no json"),
            (f"{base}/unheard_of", None),
            (f"{base}/*", None),
        ]:
            good, refused = asked(session, key, payload)
            assert not good and refused[0]["error"], key
    statuses = collect(client.listen(keys.pattern(keys.STATUS)), Status, lambda found: any(s.rejects for s in found))
    assert statuses[-1].rejects == {"refused_command": 6}


def test_our_client_gets_the_reply_or_the_refusal_or_nothing(running: System, client: Client) -> None:
    running.start("action_fusion")
    running.wait_for_services(client, "action_fusion")
    assert client.ask("action_fusion", "set_parameters", values={"reach_m": 0.5})["parameters"][1]["value"] == 0.5
    with pytest.raises(Refusal, match="greater than 0"):
        client.ask("action_fusion", "set_parameters", values={"reach_m": 0})
    with pytest.raises(NotAnsweredError, match="action_fusion2 of sensor kinect0"):
        client.ask("action_fusion2", "parameters", timeout_s=0.2)


def test_the_simulated_person_performs_when_asked(running: System, client: Client) -> None:
    truths = client.listen(keys.pattern(keys.TRUTH))
    running.start("scene_simulator", "--driven", "--image-hz", "0")
    running.wait_for_services(client, "sensor_gateway")
    client.ask("sensor_gateway", "perform", actions=["lift", "point"], object_id=2)
    done = collect(truths, Truth, lambda found: len(found) == 4)
    assert [(t.action, t.kind, t.object_id) for t in done] == [
        ("lift", "start", 2), ("lift", "end", 2), ("point", "start", 2), ("point", "end", 2),
    ]  # fmt: skip
    with pytest.raises(Refusal, match="'dance' is not an action"):
        client.ask("sensor_gateway", "perform", actions=["dance"])


def test_a_running_classifier_takes_new_settings_and_tells_its_maps(
    running: System, client: Client, scene_model
) -> None:
    running.start("som_classifier", "--model", str(scene_model))
    running.wait_for_services(client, "som_classifier")
    wait_until(lambda: client.ask("som_classifier", "maps")["model"] is not None, "the model is loaded")
    maps = client.ask("som_classifier", "maps")
    first, second = maps["posture_map"], maps["action_map"]
    assert len(first["bodies"]) == first["rows"] * first["columns"] and len(first["bodies"][0]) == 15
    assert len(second["labels"]) == second["rows"] * second["columns"] and set(second["labels"]) <= {
        "lift", "push", "pull", "put", "point",
    }  # fmt: skip
    client.ask("som_classifier", "set_parameters", values={"publish_maps": True})
    actions = client.listen(keys.pattern(keys.ACTION))
    running.start("pose_preprocessor")
    running.start("scene_simulator", "--repetitions", "1", "--image-hz", "0")
    running.wait_for_services(client, "pose_preprocessor", "sensor_gateway")
    marks = client.listen(keys.pattern(keys.TRUTH))
    start, end = collect(marks, Truth, lambda found: len(found) >= 2)[:2]
    for truth in (start, end):
        client.put(
            Segment(stamp_ns=truth.stamp_ns, sensor="kinect0", kind=truth.kind, segment_id="one", agent=truth.agent)
        )
    final = collect(actions, Action, lambda found: any(a.final and a.maps for a in found))
    assert final[-1].maps
