import pytest
from hypothesis import given
from hypothesis import strategies as st

from actum import keys

CHUNKS = st.from_regex(keys.CHUNK, fullmatch=True)


@given(st.sampled_from(keys.TOPICS), CHUNKS, CHUNKS)
def test_a_built_key_parses_to_what_it_was_built_from(topic: keys.Topic, sensor: str, chunk: str) -> None:
    name = chunk if "{}" in topic.leaf else None
    assert keys.parse(keys.key(topic, sensor, name)) == keys.Address(topic, sensor, name)


def test_the_documented_keys() -> None:
    assert keys.key(keys.SKELETON, "kinect0") == "actum/kinect0/skeleton"
    assert keys.key(keys.COLOR, "kinect0") == "actum/kinect0/image/color"
    assert keys.key(keys.POSTURE, "kinect0", 1) == "actum/kinect0/posture/1"
    assert keys.key(keys.EVENT, "kinect0", 0) == "actum/kinect0/event/0"
    assert keys.key(keys.STATUS, "kinect0", "action_fusion") == "actum/kinect0/status/action_fusion"
    assert keys.alive("kinect0", "action_fusion", "host-1") == "actum/kinect0/alive/action_fusion/host-1"
    assert keys.pattern(keys.POSTURE) == "actum/*/posture/*"


@pytest.mark.parametrize("sensor", ["", "Kinect", "a/b", "a*", "kinect 0", "ä"])
def test_a_sensor_outside_the_charset_is_refused(sensor: str) -> None:
    with pytest.raises(keys.InvalidKeyError):
        keys.key(keys.SKELETON, sensor)


@pytest.mark.parametrize(
    "text",
    ["", "actum", "actum/kinect0", "actum/kinect0/posture", "actum/kinect0/skeleton/1", "other/kinect0/skeleton"],
)
def test_what_is_no_key_of_ours_is_refused(text: str) -> None:
    with pytest.raises(keys.InvalidKeyError):
        keys.parse(text)


def test_a_claim_to_a_service_is_read_back_from_its_token_and_other_tokens_are_none() -> None:
    for claim in (keys.Claim("candidate", "host-1", "ab12"), keys.Claim("successor", "host-1", "ab12")):
        assert keys.claim_of(keys.claim_key(claim, "kinect0", "action_fusion")) == claim
    assert keys.claim_of(keys.alive("kinect0", "action_fusion", "host-1")) == keys.Claim("alive", "host-1")
    assert keys.claim_of("actum/kinect0/candidate/action_fusion/host-1") is None
    assert keys.claim_of("actum/kinect0/alive/action_fusion/host-1/more") is None
    assert keys.claim_of("somebody/else/a/b/c") is None
