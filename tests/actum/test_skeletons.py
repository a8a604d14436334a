from actum.skeletons import JOINTS, PARTS, SKELETON_MAPS, to_actum

KINECT_V1 = """
HipCenter Spine ShoulderCenter Head
ShoulderLeft ElbowLeft WristLeft HandLeft
ShoulderRight ElbowRight WristRight HandRight
HipLeft KneeLeft AnkleLeft FootLeft
HipRight KneeRight AnkleRight FootRight
"""
NITE = """
Head ShoulderCenter Spine
ShoulderLeft ElbowLeft HandLeft
ShoulderRight ElbowRight HandRight
HipLeft KneeLeft FootLeft
HipRight KneeRight FootRight
"""


def test_kinect_v1_joints_by_name() -> None:
    assert to_actum(KINECT_V1.split(), "kinect-v1-20") == NITE.split()


def test_every_map_names_each_of_the_fifteen_once() -> None:
    for name, indices in SKELETON_MAPS.items():
        assert len(indices) == len(set(indices)) == len(JOINTS), name


def test_the_parts_share_out_the_joints() -> None:
    assert sorted(i for part in PARTS.values() for i in part) == list(range(15))
    assert [JOINTS[i] for i in PARTS["right_arm"]] == ["right_shoulder", "right_elbow", "right_hand"]
