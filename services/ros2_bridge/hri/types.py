"""The message types of ROS4HRI: their names and definitions, as hri_msgs 2.3.2 and hri_actions_msgs 2.5.0 have them.

Type hashes follow from the fields alone, so constants stand in the modules that use them. Humble's hri_msgs before
2.2.0 has a `Gesture` without `handedness`; ROS 1's `Skeleton2D` is not of fixed size.
"""

IDS_LIST = "hri_msgs/msg/IdsList"
IDS_MATCH = "hri_msgs/msg/IdsMatch"
REGION = "hri_msgs/msg/NormalizedRegionOfInterest2D"
POINT = "hri_msgs/msg/NormalizedPointOfInterest2D"
SKELETON_2D = "hri_msgs/msg/Skeleton2D"
BODY_POSTURE = "hri_msgs/msg/BodyPosture"
GESTURE = "hri_msgs/msg/Gesture"
INTENT = "hri_actions_msgs/msg/Intent"
JOINT_STATE = "sensor_msgs/msg/JointState"
IMAGE = "sensor_msgs/msg/Image"
BOOL = "std_msgs/msg/Bool"
FLOAT = "std_msgs/msg/Float32"

DEFINITIONS = {
    IDS_LIST: "std_msgs/Header header\nstring[] ids",
    IDS_MATCH: "string id1\nint8 id1_type\nstring id2\nint8 id2_type\nfloat32 confidence",
    REGION: "std_msgs/Header header\nfloat32 xmin\nfloat32 ymin\nfloat32 xmax\nfloat32 ymax\nfloat32 c",
    POINT: "float32 x\nfloat32 y\nfloat32 c",
    SKELETON_2D: "std_msgs/Header header\nNormalizedPointOfInterest2D[18] skeleton",
    BODY_POSTURE: "std_msgs/Header header\nuint8 posture",
    GESTURE: "std_msgs/Header header\nuint8 gesture\nuint8 handedness",
    INTENT: "string intent\nstring data\nstring source\nstring modality\nuint8 priority\nfloat32 confidence",
}
"""What `rosbags` lacks."""
