from dataclasses import replace

import pytest

from course_lib.ros.graph.topics import Qos
from course_lib.ros.zenoh.link import (
    ZenohEntity,
    decode_attachment,
    decode_qos,
    encode_attachment,
    encode_qos,
    read_token,
)

STRING_HASH = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
SUM_HASH = "RIHS01_e118de6bf5eeb66a2491b5bda11202e7b68f198d6f67922cf30364858239c81a"
ZID = "aac3178e146ba6f1fc6e6a4085e77f21"
# docs/design.md of rmw_zenoh (jazzy)
NODE = f"@ros2_lv/0/{ZID}/0/0/NN/%/%/listener"
SUBSCRIPTION = (
    f"@ros2_lv/0/{ZID}/0/10/MS/%/%/listener/%chatter/std_msgs::msg::dds_::String_/{STRING_HASH}/::,10:,:,:,,"
)
LISTENER = ZenohEntity(kind="node", domain=0, zid=ZID, node_id=0, id=0, namespace="/", node="listener")
CHATTER = replace(
    LISTENER,
    kind="subscription",
    id=10,
    topic="/chatter",
    type_name="std_msgs/msg/String",
    type_hash=STRING_HASH,
)


def test_liveliness_tokens_agree_with_the_rmw_zenoh_design_page() -> None:
    assert LISTENER.token == NODE
    assert CHATTER.token == SUBSCRIPTION


@pytest.mark.parametrize("entity", [LISTENER, CHATTER, replace(CHATTER, namespace="/a/b", topic="/a/b/c")])
def test_token_survives_a_round_trip(entity: ZenohEntity) -> None:
    assert read_token(entity.token) == entity


def test_fourteenth_token_part_of_rolling_is_ignored() -> None:
    assert read_token(f"{SUBSCRIPTION}/more") == CHATTER


@pytest.mark.parametrize(
    "key",
    [
        "",
        "0/chatter/x/y",
        f"@ros2_lv/zero/{ZID}/0/0/NN/%/%/listener",
        f"@ros2_lv/0/{ZID}/0/0/XX/%/%/listener",
        SUBSCRIPTION.rpartition("/")[0],
        f"{SUBSCRIPTION.rpartition('/')[0]}/::ten,:,:,:",
        f"{SUBSCRIPTION.rpartition('/')[0]}/::,-1:,:,:,,",
        f"{SUBSCRIPTION.rpartition('/')[0]}/::,10:-1,0:,:,,",
        f"{SUBSCRIPTION.rpartition('/')[0]}/::,10:{10**30},0:,:,,",
        f"{SUBSCRIPTION.rpartition('/')[0]}/::,{'9' * 5000}:,:,:,,",
        SUBSCRIPTION.replace("std_msgs::msg::dds_::String_", "String"),
        SUBSCRIPTION.replace("std_msgs::msg::dds_::String_", "..::..::x"),
        SUBSCRIPTION.replace("%chatter", "%"),
        SUBSCRIPTION.replace("%chatter", "%chatter%%"),
        NODE.replace("%/%", "%/a b"),
        NODE.replace("listener", "$*"),
    ],
)
def test_invalid_token_is_parsed_as_none(key: str) -> None:
    assert read_token(key) is None


def test_key_expressions_of_topics_and_services_agree_with_the_design_page() -> None:
    assert CHATTER.key_expr == f"0/chatter/std_msgs::msg::dds_::String_/{STRING_HASH}"
    service = replace(
        LISTENER,
        kind="server",
        domain=2,
        id=11,
        topic="/a/add_two_ints",
        type_name="example_interfaces/srv/AddTwoInts",
        type_hash=SUM_HASH,
    )
    assert service.key_expr == f"2/a/add_two_ints/example_interfaces::srv::dds_::AddTwoInts_/{SUM_HASH}"


@pytest.mark.parametrize(
    ("qos", "text"),
    [
        (Qos(), "::,10:,:,:,,"),
        (Qos(depth=42), "::,:,:,:,,"),
        (Qos(depth=5, reliability="best_effort"), "2::,5:,:,:,,"),
        (Qos(depth=1, durability="transient_local"), ":1:,1:,:,:,,"),
        (Qos("keep_all", 10), "::2,10:,:,:,,"),
        (Qos(deadline_ns=1_500_000_000, lease_ns=2 * 10**9), "::,10:1,500000000:,:,2,0"),
        (Qos(liveliness="manual_by_topic"), "::,10:,:,:3,,"),
    ],
)
def test_qos_survives_a_round_trip(qos: Qos, text: str) -> None:
    assert encode_qos(qos) == text
    assert decode_qos(text) == qos


def test_attachment_has_33_bytes() -> None:
    data = encode_attachment(3, bytes(range(16)), 1_700_000_000_000_000_000)
    assert data.hex() == "0300000000000000" + "00002a36fe9c9717" + "10" + bytes(range(16)).hex()
    assert decode_attachment(data) == (3, 1_700_000_000_000_000_000, bytes(range(16)))


def test_older_attachment_format_is_rejected() -> None:
    with pytest.raises(ValueError, match="49 bytes instead of 33"):
        decode_attachment(bytes(49))


def test_gid_is_the_hash_of_the_token_with_the_low_half_first() -> None:
    import xxhash

    high, low = divmod(xxhash.xxh3_128(SUBSCRIPTION.encode()).intdigest(), 2**64)
    assert CHATTER.gid == low.to_bytes(8, "little") + high.to_bytes(8, "little")
