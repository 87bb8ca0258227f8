# mypy: ignore-errors
"""Classes that students write, with nodes, executors and messages as base classes."""

import functools
import re
import time
from typing import Any, ClassVar

import rclpy
from geometry_msgs.msg import Point, Twist
from probing import Fibonacci, lines, main, outcome
from rclpy.action import ActionClient, ActionServer
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.publisher import Publisher
from rclpy.subscription import Subscription
from rclpy.task import Future
from rclpy.timer import Timer
from std_msgs.msg import Int32, String
from std_srvs.srv import Trigger


def turn(node: Any, seconds: Any = 0.3, executor: Any = None) -> None:
    executor = executor or SingleThreadedExecutor()
    executor.add_node(node)
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        executor.spin_once(timeout_sec=0.05)
    executor.remove_node(node)


class Late(Node):
    def __init__(self) -> None:
        self.count = 0
        self.found = outcome(lambda: self.create_publisher(String, "t", 1))
        super().__init__("late")


class Never(Node):
    def __init__(self) -> None:
        pass


class Unnamed(Node):
    def __init__(self) -> None:
        super().__init__()


class Talker(Node):
    """An ordinary node."""

    topic = "t"

    def __init__(self, name: Any = "talker", **options: Any) -> None:
        super().__init__(name, **options)
        self.heard = []
        self.publisher = self.create_publisher(String, self.topic, 10)
        self.subscription = self.create_subscription(String, self.topic, self.on_text, 10)
        self.timer = self.create_timer(0.05, self.on_timer)

    def on_timer(self) -> None:
        self.publisher.publish(String(data=self.get_name()))

    def on_text(self, message: Any) -> None:
        self.heard.append(message.data)


class Child(Talker):
    topic = "u"

    def on_text(self, message: Any) -> None:
        super().on_text(message)
        self.heard.append(type(self).__name__)


class Mixin:
    def __init__(self, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        self.mixed = True


class Mixed(Mixin, Talker):
    pass


class Slotted(Node):
    __slots__ = ("value",)

    def __init__(self) -> None:
        super().__init__("slotted")
        self.value = 3


class Called(Node):
    """A node whose object can be called: a callback like any other."""

    def __init__(self) -> None:
        super().__init__("called")
        self.calls = 0
        self.create_timer(0.05, self)

    def __call__(self) -> None:
        self.calls += 1


class Static(Node):
    calls: ClassVar[list[str]] = []

    def __init__(self) -> None:
        super().__init__("static")
        self.create_timer(0.05, self.tick)
        self.create_timer(0.05, self.tock)

    @staticmethod
    def tick() -> None:
        Static.calls.append("static")

    @classmethod
    def tock(cls) -> None:
        cls.calls.append(cls.__name__)


class Silent(Node):
    def get_logger(self) -> Any:
        return None


class Renamed(Node):
    def get_name(self) -> Any:
        return "other"


class Closing(Node):
    def __init__(self) -> None:
        super().__init__("closing")
        self.closed = 0

    def destroy_node(self) -> Any:
        self.closed += 1
        return super().destroy_node()


class Equal(Node):
    """A node that compares equal to all of its class, and so cannot be hashed."""

    def __eq__(self, other: Any) -> Any:
        return isinstance(other, Equal)


class Shadowing(Node):
    """A node with attributes that hide methods of the base class."""

    def __init__(self, name: Any) -> None:
        super().__init__("shadowing")
        setattr(self, name, 5)


def shadowed(name: Any, call: Any) -> Any:
    node = Shadowing(name)
    return outcome(call, node)


def never(call: Any) -> Any:
    """Return the error of a node that is not initialized, without the private name in it."""
    return re.sub(r"'_\w+'$", "", outcome(call, Never()))


def kinds() -> Any:
    node = Node("n")
    timer, publisher = node.create_timer(1.0, print), node.create_publisher(String, "t", 1)
    subscription = node.create_subscription(String, "t", print, 1)
    pairs = (timer, Timer), (publisher, Publisher), (subscription, Subscription)
    return [isinstance(one, kind) for one, kind in pairs]


def heard(kind: Any, **options: Any) -> Any:
    node = kind(**options)
    turn(node)
    return sorted(set(node.heard)), len(node.heard) > 3


def static() -> Any:
    Static.calls.clear()
    turn(Static())
    return sorted(set(Static.calls))


def equal() -> Any:
    one, other = Equal("one"), Equal("other")
    executor = SingleThreadedExecutor()
    return outcome(executor.add_node, one), outcome(executor.add_node, other), one == other


def called() -> Any:
    node = Called()
    turn(node)
    return node.calls > 3


def closing() -> Any:
    node = Closing()
    node.destroy_node()
    with_block = None
    with Closing() as other:
        with_block = other.closed
    return node.closed, with_block, other.closed


def partials() -> Any:
    node, seen = Node("n"), []
    node.create_timer(0.05, functools.partial(seen.append, "timer"))
    for topic in ("a", "b"):
        node.create_subscription(
            String, topic, functools.partial(lambda name, m: seen.append(name), topic), 1
        )
        node.create_publisher(String, topic, 1).publish(String())
    turn(node)
    return sorted(set(seen))


def in_a_loop() -> Any:
    node, seen = Node("n"), []
    for topic in ("a", "b"):
        node.create_subscription(String, topic, lambda m: seen.append(topic), 1)  # noqa: B023
        node.create_publisher(String, topic, 1).publish(String())
    turn(node)
    return sorted(set(seen))


def class_of(kind: Any) -> Any:
    names = [base.__name__ for base in kind.__mro__]
    return [name for name in names if name not in ("Generic", "ContextManager")][:3]


class Counting(SingleThreadedExecutor):
    """An executor that counts its rounds."""

    def __init__(self) -> None:
        super().__init__()
        self.rounds = 0

    def spin_once(self, timeout_sec: Any = None) -> None:
        self.rounds += 1
        super().spin_once(timeout_sec)


def counting() -> Any:
    executor, node = Counting(), Node("n")
    executor.add_node(node)
    node.create_timer(0.05, lambda: executor.shutdown() if executor.rounds > 3 else None)
    executor.spin()
    return executor.rounds > 3, executor.get_nodes()


class Named(Future):
    def set_result(self, result: Any) -> None:
        super().set_result(f"<{result}>")


def named() -> Any:
    future, node = Named(), Node("n")
    node.create_timer(0.05, lambda: future.done() or future.set_result(1))
    rclpy.spin_until_future_complete(node, future, timeout_sec=2.0)
    return future.result()


class Managed(LifecycleNode):
    def __init__(self) -> None:
        super().__init__("managed")
        self.calls = []

    def on_configure(self, state: Any) -> Any:
        self.calls.append(("configure", state.label))
        return super().on_configure(state)

    def on_activate(self, state: Any) -> Any:
        self.calls.append(("activate", state.label))
        return super().on_activate(state)

    def on_deactivate(self, state: Any) -> None:
        raise ValueError("deactivate")

    def on_error(self, state: Any) -> Any:
        self.calls.append(("error", state.label))
        return TransitionCallbackReturn.SUCCESS


def managed() -> Any:
    node = Managed()
    steps = ("configure", "activate", "deactivate")
    found = [outcome(getattr(node, f"trigger_{step}")) for step in steps]
    found.append(outcome(node.trigger_configure))
    return found, node.calls


class Stamped(String):
    """A message with an attribute of its own."""

    note = "x"


def published(message: Any, kind: Any = String) -> Any:
    node, seen = Node("n"), []
    node.create_subscription(String, "t", seen.append, 1)
    publisher = node.create_publisher(kind, "t", 1)
    found = outcome(publisher.publish, message)
    turn(node, 0.2)
    return found, seen


def reused() -> Any:
    """Publish one message again and again while it changes."""
    node, seen, message = Node("n"), [], Int32()
    node.create_subscription(Int32, "t", lambda m: seen.append((m.data, m is message)), 10)
    publisher = node.create_publisher(Int32, "t", 10)
    for number in range(3):
        message.data = number
        publisher.publish(message)
    turn(node, 0.2)
    return seen


def kept() -> Any:
    """Keep a message of a callback, and change it there."""
    node, seen = Node("n"), []

    def on_text(message: Any) -> None:
        seen.append(message.data)
        message.data = "changed"

    node.create_subscription(String, "t", on_text, 10)
    node.create_subscription(String, "t", on_text, 10)
    node.create_publisher(String, "t", 10).publish(String(data="a"))
    turn(node, 0.2)
    return seen


lines(
    "class",
    late=lambda: (lambda node: (node.found, node.get_name()))(Late()),
    never=lambda: never(lambda node: node.get_name()),
    never_publisher=lambda: never(lambda node: node.create_publisher(String, "t", 1)),
    never_timer=lambda: never(lambda node: node.create_timer(1.0, print)),
    never_logger=lambda: never(lambda node: node.get_logger()),
    never_parameter=lambda: never(lambda node: node.declare_parameter("a", 1)),
    never_subscription=lambda: never(lambda node: node.create_subscription(String, "t", print, 1)),
    never_destroyed=lambda: never(lambda node: node.destroy_node()),
    unnamed=Unnamed,
    talker=lambda: heard(Talker),
    child=lambda: heard(Child),
    mixed=lambda: (heard(Mixed), Mixed("m").mixed),
    options=lambda: heard(Talker, name="x", namespace="/ns"),
    slotted=lambda: Slotted().value,
    called=called,
    static=static,
    silent=lambda: Silent("n").create_publisher(String, "t", 1).topic_name,
    renamed=lambda: (lambda n: (n.get_fully_qualified_name(), n.get_node_names()))(Renamed("n")),
    closing=closing,
    equal=equal,
    partials=partials,
    in_a_loop=in_a_loop,
    hidden_publishers=lambda: shadowed("timers", lambda n: n.create_timer(1.0, print).is_ready()),
    hidden_name=lambda: shadowed("name", lambda n: n.get_name()),
    hidden_publisher=lambda: shadowed("create_publisher", lambda n: n.create_publisher()),
    hidden_logger=lambda: shadowed("get_logger", lambda n: n.get_logger()),
    hidden_clock=lambda: shadowed("get_clock", lambda n: n.create_timer(1.0, print).is_canceled()),
    hidden_handle=lambda: shadowed("handle", lambda n: n.get_name()),
    hidden_context=lambda: shadowed("context", lambda n: n.context),
    hidden_executor=lambda: shadowed("executor", lambda n: n.executor),
    bases_of_node=lambda: class_of(Node),
    bases_of_lifecycle=lambda: class_of(LifecycleNode),
    bases_of_threads=lambda: class_of(MultiThreadedExecutor)[:2],
    kinds=lambda: kinds(),
    documented=lambda: bool(Node.__doc__ and Node.create_publisher.__doc__),
    counting=counting,
    named=named,
    managed=managed,
    stamped=lambda: published(Stamped(data="a")),
    stamped_type=lambda: published(String(data="a"), Stamped),
    stamped_both=lambda: published(Stamped(data="a"), Stamped),
    stamped_note=lambda: outcome(setattr, Stamped(), "other", 1),
    other_message=lambda: published(Int32(data=1)),
    reused=reused,
    kept=kept,
)


def late_entities() -> Any:
    """Create a subscription and a timer in callbacks."""
    node, seen = Node("n"), []

    def on_timer() -> None:
        timer.cancel()
        node.create_subscription(String, "t", lambda m: seen.append(m.data), 1)
        node.create_timer(0.05, lambda: publisher.publish(String(data="late")))

    publisher = node.create_publisher(String, "t", 1)
    timer = node.create_timer(0.05, on_timer)
    turn(node, 0.6)
    return seen[:2]


def destroyed_in_callback(what: Any) -> Any:
    """Destroy something in its own callback."""
    node, seen = Node("n"), []

    def on_text(message: Any) -> None:
        seen.append(message.data)
        if what == "subscription":
            node.destroy_subscription(subscription)
        elif what == "publisher":
            node.destroy_publisher(publisher)
        else:
            node.destroy_node()

    subscription = node.create_subscription(String, "t", on_text, 10)
    publisher = node.create_publisher(String, "t", 10)
    for number in range(3):
        publisher.publish(String(data=str(number)))
    found = outcome(turn, node, 0.3)
    return found, seen


def service_destroyed_in_callback() -> Any:
    node, seen = Node("n"), []

    def answer(request: Any, response: Any) -> Any:
        seen.append("asked")
        node.destroy_service(service)
        return response

    service = node.create_service(Trigger, "s", answer)
    client = node.create_client(Trigger, "s")
    client.wait_for_service(2.0)
    futures = [client.call_async(Trigger.Request()) for _ in range(2)]
    found = outcome(turn, node, 0.4)
    return found, seen, [future.done() for future in futures]


def client_destroyed(when: Any) -> Any:
    """Destroy a client before the response, or in the callback of its future."""
    node, seen = Node("n"), []
    node.create_service(Trigger, "s", lambda request, response: response)
    client = node.create_client(Trigger, "s")
    client.wait_for_service(2.0)
    future = client.call_async(Trigger.Request())
    if when == "before":
        node.destroy_client(client)
    else:
        future.add_done_callback(lambda done: seen.append(node.destroy_client(client)))
    found = outcome(turn, node, 0.4)
    return found, future.done(), seen


def action_destroyed_in_callback() -> Any:
    node, seen = Node("n"), []

    def execute(handle: Any) -> Any:
        seen.append("executes")
        server.destroy()
        return Fibonacci.Result()

    server = ActionServer(node, Fibonacci, "fib", execute)
    client = ActionClient(node, Fibonacci, "fib")
    client.wait_for_server(2.0)
    sent = client.send_goal_async(Fibonacci.Goal())
    found = outcome(turn, node, 0.5)
    return found, seen, sent.done()


def undeclared_in_callback() -> Any:
    node = Node("n")
    node.declare_parameter("a", 1)
    node.add_post_set_parameters_callback(lambda ps: node.undeclare_parameter("a"))
    return outcome(node.set_parameters, [Parameter("a", value=2)]), node.has_parameter("a")


def removed_from_executor() -> Any:
    """Remove a node from its executor in its callback, and add it again in another node's."""
    first, second, seen = Node("first"), Node("second"), []
    executor = SingleThreadedExecutor()

    def leave() -> None:
        seen.append("leave")
        executor.remove_node(first)

    def back() -> None:
        if seen and len(seen) == seen.count("leave"):
            executor.add_node(first)

    first.create_timer(0.05, leave)
    second.create_timer(0.12, back)
    executor.add_node(first)
    turn(second, 0.6, executor)
    return len(seen) >= 2


lines(
    "during",
    late_entities=late_entities,
    subscription=lambda: destroyed_in_callback("subscription"),
    publisher=lambda: destroyed_in_callback("publisher"),
    node=lambda: destroyed_in_callback("node"),
    service=service_destroyed_in_callback,
    client_before=lambda: client_destroyed("before"),
    client_after=lambda: client_destroyed("after"),
    action=action_destroyed_in_callback,
    undeclared=undeclared_in_callback,
    removed=removed_from_executor,
)


lines(
    "message",
    nested_keyword=lambda: Twist(linear=Point(x=1.0), check_fields=True),
    positional=lambda: Point(1.0, 2.0, 3.0),
    unpacked=lambda: Point(x=1.0),
    attribute=lambda: setattr(Point(), "w", 1.0),
    attribute_of_nested=lambda: setattr(Twist().linear, "w", 1.0),
    read_unknown=lambda: Twist().linear.w,
    deleted=lambda: delattr(Point(), "x"),
    called=lambda: Point()(),
    iterated=lambda: list(Point()),
    indexed=lambda: Point()[0],
    length=lambda: len(Point()),
    added=lambda: Point() + Point(),
    ordered=lambda: Point() < Point(),
    truth=lambda: bool(Point()),
    dictionary=lambda: vars(Point()),
    shared_default=lambda: Twist().linear is Twist().linear,
    shared_nested=lambda: (lambda v: Twist(linear=v, angular=v))(Twist().linear).linear.x,
    is_class=lambda: isinstance(Point, type),
    module=lambda: (Point.__module__, Point.__name__, Point.__qualname__),
    request=lambda: (Trigger.Request.__name__, Trigger.Response.__name__, type(Trigger).__name__),
    instance_of_service=lambda: Trigger(),
    instance_of_action=lambda: Fibonacci(),
)


if __name__ == "__main__":
    main()
