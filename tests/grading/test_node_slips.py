"""Slips in the methods of a node that raise no error."""

import pytest

from course_lib.grading.node_slips import find_slip
from tests.grading.test_slips import NODE, method


@pytest.mark.parametrize(
    ("listener", "sentence"),
    [
        ("pass", "self.buffer receives no transforms: create a listener in __init__"),
        ("TransformListener(Buffer(), self)", '"TransformListener(Buffer(), self)" fills another buffer'),
        ("TransformListener(self.buffer, self)", ""),
        ("fill(self)", "self.buffer receives no transforms"),
    ],
)
def test_buffer_without_a_listener_is_reported(listener: str, sentence: str) -> None:
    source = method("return self.buffer.can_transform('map', 'base', Time())")
    assert find_slip(source.replace("self.angle = 0.0", "self.buffer = Buffer(); " + listener)).startswith(
        sentence
    )


@pytest.mark.parametrize(
    ("lines", "sentence"),
    [
        (("for one in parameters:", "    print(one)"), "tick may end without return, and then ROS"),
        (
            ("if parameters:", "    return SetParametersResult(successful=True)"),
            "tick may end without return",
        ),
        (("return SetParametersResult(successful=True)",), ""),
        (("if parameters:", "    return bad()", "else:", "    return good()"), ""),
    ],
)
def test_parameter_callback_that_returns_nothing_is_reported(lines: tuple[str, ...], sentence: str) -> None:
    source = method(*lines).replace("self.angle = 0.0", "self.add_on_set_parameters_callback(self.tick)")
    slip = find_slip(source)
    assert slip.startswith(sentence) if sentence else slip == ""
    coroutine = source.replace("def tick", "async def tick")
    assert find_slip(coroutine).startswith("async makes tick return a coroutine")


CHANGE = "    self.timer = self.create_timer(1 / one.value, self.paint)"
REJECT = "    if one.value < 1.0:", "        return SetParametersResult(successful=False)"
ACCEPT = "return SetParametersResult(successful=True)"


@pytest.mark.parametrize(
    ("lines", "sentence"),
    [
        ((CHANGE, *REJECT), '"self.timer = self.create_timer(1 / one.value, self.paint)" comes before'),
        (
            (*REJECT, CHANGE.replace("one.value", "self.get_parameter('rate').value")),
            "\"self.get_parameter('rate')\" in tick still has the old value",
        ),
        ((*REJECT, CHANGE), ""),
    ],
)
def test_timer_that_a_parameter_callback_changes_wrongly_is_reported(
    lines: tuple[str, ...], sentence: str
) -> None:
    source = method("for one in parameters:", *lines, ACCEPT)
    source = source.replace("self.angle = 0.0", "self.add_on_set_parameters_callback(self.tick)")
    slip = find_slip(source)
    assert slip.startswith(sentence) if sentence else slip.startswith("create_timer is in tick")


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ("'map', message.header.frame_id, Time()", "Time() in lookup_transform requests the newest"),
        ("'map', 'camera', message.header.stamp", "lookup_transform has the fixed frame 'camera'"),
        ("'map', message.header.frame_id, message.header.stamp", ""),
    ],
)
def test_lookup_for_a_message_without_its_frame_or_stamp_is_reported(arguments: str, sentence: str) -> None:
    lookup = f"found = self.buffer.lookup_transform({arguments})"
    source = method(lookup, "self.publisher.publish(do_transform_point(message, found))")
    slip = find_slip(source.replace("tick(self)", "heard(self, message)"))
    assert slip.startswith(sentence) if sentence else slip == ""


def test_static_broadcaster_in_place_of_the_other_one_is_reported() -> None:
    both = "self.one = TransformBroadcaster(self); self.fixed = StaticTransformBroadcaster(self)"
    source = method("self.fixed.sendTransform(hand)").replace("self.angle = 0.0", both)
    assert find_slip(source).startswith("self.fixed is for frames that never move, and self.one is not")
    assert find_slip(source.replace("fixed.send", "one.send")) == ""


def test_comparison_with_an_undeclared_parameter_is_reported() -> None:
    source = method("return [one for one in parameters if one.name == 'framerate']")
    source = source.replace("self.angle = 0.0", "self.declare_parameter('frame_rate', 1.0)")
    assert find_slip(source).startswith(
        "\"one.name == 'framerate'\" is never true: the parameter is declared"
    )
    assert find_slip(source.replace("'framerate'", "'frame_rate'")) == ""
    assert find_slip(source.replace("'framerate'", "'gain'")) == ""


def test_buffer_created_in_a_callback_is_reported() -> None:
    source = method("self.buffer = Buffer()").replace("self.angle = 0.0", "self.create_timer(1.0, self.tick)")
    assert find_slip(source).startswith('"Buffer()" is in tick: each call creates a new one')
    assert find_slip(source.replace("self.create_timer(1.0, self.tick)", "self.tick()")) == ""


@pytest.mark.parametrize("end", ["self.destroy_node()", "rclpy.shutdown()"])
def test_node_that_ends_in_its_constructor_is_reported(end: str) -> None:
    source = NODE.format(lines="pass").replace("= 0.0", f"= 0.0\n        {end}")
    assert f'"{end}" in __init__ ends' in find_slip(source)


def test_start_that_is_read_in_each_call_is_reported() -> None:
    lines = ("start = self.get_clock().now()", "return self.get_clock().now() - start")
    source = method(*lines).replace("self.angle = 0.0", "self.create_timer(1.0, self.tick)")
    assert "is the time since this call of tick began" in find_slip(source)


def test_parameter_that_no_line_declares_is_reported_with_those_that_are() -> None:
    lines = ("for one in parameters:", "    if one.name == 'rate':", "        return 1", "return 2")
    declared = "self.declare_parameter('frame_id', 'a')\n        "
    declared += "self.add_on_set_parameters_callback(self.tick)"
    source = (
        method(*lines)
        .replace("self.angle = 0.0", declared)
        .replace("(self):\n        for", "(self, parameters):\n        for")
    )
    assert "\"one.name == 'rate'\" is never true: the node declares 'frame_id'" in find_slip(source)


def test_broadcaster_created_and_used_in_a_callback_is_accepted() -> None:
    lines = ("self.broadcaster = TransformBroadcaster(self)", "self.broadcaster.sendTransform(transform)")
    assert find_slip(method(*lines).replace("self.angle = 0.0", "self.create_timer(1.0, self.tick)")) == ""


def test_method_defined_twice_is_reported() -> None:
    source = method("return 1") + "\n    def tick(self):\n        pass\n"
    assert find_slip(source).startswith("Lamp has def tick 2 times, and only the last one counts")
    accepted = source.replace("    def tick", "    @overload\n    def tick")
    assert find_slip(accepted) == ""


def test_method_that_changes_the_node_and_is_never_called_is_reported() -> None:
    source = method("self.angle += 0.1") + "\n    def paint(self):\n        return 1\n"
    source = source.replace("self.angle = 0.0", "self.create_timer(1.0, self.paint)")
    assert find_slip(source).startswith("tick is never called: write self.tick() where its lines should run")
    assert find_slip(source.replace("return 1", "self.tick()")) == ""
    assert find_slip(source.replace("(Node)", "(Lamps)")) == ""


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ("self.create_timer(1.0, self.tick)", "create_timer is in tick: each call creates another timer"),
        ("self.destroy_node()", '"self.destroy_node()" in tick ends the node when the callback runs'),
        ("rclpy.shutdown()", '"rclpy.shutdown()" in tick ends all nodes when'),
        ("self.timer.cancel()", '"self.timer.cancel()" in tick ends the timer when'),
    ],
)
def test_callback_that_adds_or_ends_timers_is_reported(line: str, sentence: str) -> None:
    timer = "self.timer = self.create_timer(1.0, self.tick)"
    source = method("self.paint()", line).replace("self.angle = 0.0", timer)
    assert find_slip(source).startswith(sentence)
    replaced = f"self.destroy_timer(self.timer)\n        {timer}"
    assert find_slip(source.replace(f"        {line}", f"        {replaced}")) == ""


def test_callback_that_ends_its_timer_at_a_certain_moment_is_accepted() -> None:
    lines = ("self.count += 1", "if self.count > 3:", "    self.timer.cancel()")
    timer = "self.timer = self.create_timer(1.0, self.tick)"
    assert find_slip(method(*lines).replace("self.angle = 0.0", timer)) == ""


def test_callback_of_two_timers_is_reported() -> None:
    source = method("self.paint()").replace("self.angle = 0.0", "self.create_timer(1.0, self.tick)")
    assert find_slip(source) == ""
    again = source.replace(
        "self.create_timer(1.0, self.tick)",
        "self.create_timer(1.0, self.tick); self.create_timer(2.0, self.tick)",
    )
    assert find_slip(again).startswith("2 timers call self.tick, so that it runs 2 times")


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ("return True", "change returns True, and ROS expects a SetParametersResult"),
        ("rate = parameters[0].value", "parameters[0] is only the first parameter of a call"),
    ],
)
def test_parameter_callback_with_a_wrong_result_or_one_parameter_is_reported(
    line: str, sentence: str
) -> None:
    source = method("self.add_on_set_parameters_callback(self.change)")
    result = "return SetParametersResult(successful=True)"
    source += f"\n    def change(self, parameters):\n        {line}\n        {result}\n"
    assert find_slip(source).startswith(sentence)


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        (
            "self.timer.timer_period = 1 / rate",
            "the period is timer_period_ns, in nanoseconds. Or destroy the timer and create a new one",
        ),
        (
            "self.timer.frequency = rate",
            "the period is timer_period_ns, in nanoseconds. Or destroy the timer and create a new one",
        ),
        ("self.publisher.topic = '/lamp'", "topic, type and QoS are arguments of create_publisher"),
        ("self.timer.callback = self.other", ""),
        ("self.timer.count = 1\n        print(self.timer.count)", ""),
    ],
)
def test_attribute_that_rclpy_does_not_read_is_reported(line: str, sentence: str) -> None:
    source = method(line).replace(
        "self.angle = 0.0",
        "self.timer = self.create_timer(1.0, self.tick)\n"
        "        self.publisher = self.create_publisher(Marker, '/a', 10)",
    )
    assert bool(find_slip(source)) == bool(sentence)
    assert find_slip(source).endswith(
        f"sets an attribute that ROS does not read: {sentence}." if sentence else ""
    )


def test_value_of_a_callback_that_nothing_reads_is_reported() -> None:
    source = method("self.rate = parameter.value").replace(
        "self.angle = 0.0", "self.add_post_set_parameters_callback(self.tick)"
    )
    assert find_slip(source).startswith('"self.rate = parameter.value" keeps a value that no line reads')


def test_replaced_stamp_of_a_received_message_is_reported() -> None:
    source = method("message.header.stamp = self.get_clock().now().to_msg()", "self.p.publish(message)")
    source = source.replace("tick(self)", "tick(self, message)").replace(
        "self.angle = 0.0", "self.create_subscription(Marker, '/a', self.tick, 10)"
    )
    assert "replaces the time at which message was made" in find_slip(source)


def test_loop_of_a_function_that_never_spins_its_node_is_reported() -> None:
    loop = "def main():\n    node = Node('lamp')\n    while rclpy.ok():\n        publisher.publish(marker)"
    assert find_slip(loop).startswith('"while rclpy.ok()" in main never ends')
    assert find_slip(f"{loop}\n        rclpy.spin_once(node, timeout_sec=1.0)") == ""
