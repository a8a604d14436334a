"""The configuration of Eclipse's router with storages, which is not run here, is one that Zenoh reads."""

import json
from pathlib import Path

import zenoh

from actum import keys
from actum.messages import Event, Segment

DEPLOY = Path(__file__).parents[3] / "deploy" / "zenoh"


def test_zenoh_reads_it_and_it_stores_events_and_marks() -> None:
    config = zenoh.Config.from_file(DEPLOY / "router.storage.json5")
    storages = json.loads(config.get_json("plugins/storage_manager/storages"))
    volumes = json.loads(config.get_json("plugins/storage_manager/volumes"))
    stored = {zenoh.KeyExpr(storage["key_expr"]) for storage in storages.values()}
    assert stored == {zenoh.KeyExpr(keys.pattern(topic)) for topic in (keys.EVENT, keys.SEGMENT)}
    assert {Event, Segment} == {topic.message for topic in (keys.EVENT, keys.SEGMENT)}
    assert {storage["volume"]["id"] for storage in storages.values()} == set(volumes)


def test_but_for_the_storages_the_router_is_the_usual_one() -> None:
    usual, storing = (zenoh.Config.from_file(DEPLOY / f"{name}.json5") for name in ("router", "router.storage"))
    for path in ("mode", "listen", "scouting", "transport", "adminspace"):
        assert storing.get_json(path) == usual.get_json(path), path
