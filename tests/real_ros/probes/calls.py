# mypy: ignore-errors
"""Services, actions and lifecycle nodes.

Many of the calls are wrong on purpose.
"""

import threading
import time
from collections.abc import Callable
from typing import Any

import rclpy
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState, GetAvailableStates, GetAvailableTransitions, GetState
from probing import Fibonacci, lines, main, outcome, probe
from rclpy.action import ActionClient, ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.lifecycle import LifecycleNode, LifecycleState, Node, Publisher, TransitionCallbackReturn
from rclpy.service_introspection import ServiceIntrospectionState
from std_msgs.msg import String
from std_srvs.srv import Empty, SetBool, Trigger


def _until(ready: Callable[[], Any], *nodes: Any, limit: float = 5.0) -> bool:
    executor = SingleThreadedExecutor()
    for node in nodes:
        executor.add_node(node)
    end = time.monotonic() + limit
    while not ready() and time.monotonic() < end:
        executor.spin_once(timeout_sec=0.02)
    for node in nodes:
        executor.remove_node(node)
    return bool(ready())


def _answer(callback: Any, request: Any = None, kind: Any = SetBool) -> list[Any]:
    """Call a service with this callback; list the response and the error that spinning raised."""
    server, user = rclpy.create_node("server"), rclpy.create_node("user")
    server.create_service(kind, "s", callback)
    client = user.create_client(kind, "s")
    client.wait_for_service(timeout_sec=5.0)
    future = client.call_async(request or kind.Request())
    error = outcome(_until, future.done, server, user, limit=1.0)
    return [future.done() and future.result(), error]


def _set(request: Any, response: Any) -> Any:
    response.success, response.message = request.data, "set"
    return response


async def _async_set(request: Any, response: Any) -> Any:
    return _set(request, response)


lines(
    "answer",
    plain=lambda: _answer(_set, SetBool.Request(data=True)),
    coroutine=lambda: _answer(_async_set, SetBool.Request(data=True)),
    new_response=lambda: _answer(lambda req, res: SetBool.Response(success=True)),
    empty=lambda: _answer(lambda req, res: res, kind=Empty),
    nothing=lambda: _answer(lambda req, res: None),
    request=lambda: _answer(lambda req, res: req),
    a_class=lambda: _answer(lambda req, res: SetBool.Response),
    text=lambda: _answer(lambda req, res: "yes"),
    other_response=lambda: _answer(lambda req, res: Trigger.Response()),
    raises=lambda: _answer(lambda req, res: 1 / 0),
    one_argument=lambda: _answer(lambda req: SetBool.Response()),
    three_arguments=lambda: _answer(lambda req, res, more: res),
    no_callback=lambda: _answer(None),
)


def _service(kind: Any = Trigger, name: Any = "s", callback: Any = print, **more: Any) -> Any:
    return rclpy.create_node("server").create_service(kind, name, callback, **more)


def _client(kind: Any = Trigger, name: Any = "s", **more: Any) -> Any:
    return rclpy.create_node("user").create_client(kind, name, **more)


lines(
    "service",
    of_a_message=lambda: _service(String),
    of_an_action=lambda: _service(Fibonacci),
    of_a_text=lambda: _service("Trigger"),
    of_an_instance=lambda: _service(Trigger.Request()),
    bad_name=lambda: _service(name="a b"),
    empty_name=lambda: _service(name=""),
    number=lambda: _service(name=3),
    hidden=lambda: _service(name="_s").service_name,
    private=lambda: _service(name="~/s").service_name,
    names=lambda: [_service(name="s").srv_name, _service(name="s").service_name],
    qos_int=lambda: _service(qos_profile=3),
    group=lambda: _service(callback_group="x"),
    type_=lambda: _service().srv_type.__name__,
    attributes=lambda: [_service().qos_profile.depth, _service().callback is print],
    logger=lambda: _service().logger_name,
    send_response_of_another_type=lambda: _service().send_response(String(), None),
    in_with=lambda: _in_with(_service()),
    introspection=lambda: _service().configure_introspection(
        rclpy.clock.Clock(), rclpy.qos.qos_profile_system_default, ServiceIntrospectionState.METADATA
    ),
    introspection_wrong=lambda: _service().configure_introspection(3, 4, 5),
)
lines(
    "client",
    of_a_message=lambda: _client(String),
    bad_name=lambda: _client(name="a b"),
    names=lambda: [_client().srv_name, _client().service_name],
    ready=lambda: _client().service_is_ready(),
    wait=lambda: _client().wait_for_service(timeout_sec=0.1),
    wait_zero=lambda: _client().wait_for_service(timeout_sec=0),
    wait_negative=lambda: _client().wait_for_service(timeout_sec=-0.1) if False else None,
    wait_text=lambda: _client().wait_for_service(timeout_sec="1"),
    call_wrong=lambda: _client().call_async(SetBool.Request()),
    call_text=lambda: _client().call_async("x"),
    call_class=lambda: _client().call_async(Trigger.Request),
    call_nothing=lambda: _client().call_async(None),
    call_without=lambda: _client().call_async(),
    sync_wrong=lambda: _client().call(SetBool.Request()),
    sync_time_limit=lambda: _client().call(Trigger.Request(), timeout_sec=0.1),
    pending=lambda: _pending(),
    remove_foreign=lambda: _client().remove_pending_request(rclpy.Future()),
    logger=lambda: _client().logger_name,
    context=lambda: _client().context is rclpy.get_default_context(),
    in_with=lambda: _in_with(_client()),
    future=lambda: _client().call_async(Trigger.Request()).done(),
)


def _in_with(entity: Any) -> list[Any]:
    with entity as inside:
        found = inside is entity
    return [found, outcome(lambda: entity.service_name)]


def _pending() -> list[Any]:
    client = _client()
    future = client.call_async(Trigger.Request())
    found = [client.get_pending_request(1) is future, outcome(client.get_pending_request, 99)]
    client.remove_pending_request(future)
    return [*found, future.done(), future.cancelled(), outcome(client.get_pending_request, 1)]


@probe
def destroyed_service_and_client() -> list[Any]:
    node = rclpy.create_node("n")
    service, client = node.create_service(Trigger, "s", print), node.create_client(Trigger, "s")
    found = [node.destroy_service(service), node.destroy_client(client)]
    found += [node.destroy_service(service), node.destroy_client(client)]
    calls = [lambda: service.service_name, lambda: client.service_is_ready()]
    calls += [lambda: client.call_async(Trigger.Request()), lambda: client.wait_for_service(0.1)]
    return [*found, *(outcome(call) for call in calls)]


@probe
def calls_in_order() -> list[Any]:
    server, user, order = rclpy.create_node("server"), rclpy.create_node("user"), []
    server.create_service(SetBool, "s", lambda req, res: (order.append(req.data), res)[1])
    client = user.create_client(SetBool, "s")
    client.wait_for_service(timeout_sec=5.0)
    futures = [client.call_async(SetBool.Request(data=data)) for data in (True, False, True)]
    done = _until(lambda: all(future.done() for future in futures), server, user)
    return [done, order]


@probe
def call_from_a_thread() -> Any:
    server, user, found = rclpy.create_node("server"), rclpy.create_node("user"), []
    server.create_service(SetBool, "s", _set)
    client = user.create_client(SetBool, "s")
    client.wait_for_service(timeout_sec=5.0)
    thread = threading.Thread(target=lambda: found.append(client.call(SetBool.Request(data=True))))
    thread.start()
    _until(lambda: found, server, user)
    thread.join(timeout=2.0)
    return found


@probe
def call_in_a_callback_with_many_threads() -> Any:
    node, found = rclpy.create_node("n"), []
    group = ReentrantCallbackGroup()
    node.create_service(SetBool, "s", _set, callback_group=group)
    client = node.create_client(SetBool, "s", callback_group=group)
    client.wait_for_service(timeout_sec=5.0)
    timer = node.create_timer(
        0.05,
        lambda: (timer.cancel(), found.append(client.call(SetBool.Request(data=True)))),
        callback_group=group,
    )
    executor = MultiThreadedExecutor(3)
    executor.add_node(node)
    end = time.monotonic() + 5.0
    while not found and time.monotonic() < end:
        executor.spin_once(timeout_sec=0.02)
    executor.shutdown()
    return found


@probe
def awaited_call_in_a_callback() -> Any:
    node, found = rclpy.create_node("n"), []
    group = ReentrantCallbackGroup()
    node.create_service(SetBool, "s", _set, callback_group=group)
    client = node.create_client(SetBool, "s", callback_group=group)
    client.wait_for_service(timeout_sec=5.0)

    async def ask() -> None:
        timer.cancel()
        found.append(await client.call_async(SetBool.Request(data=True)))

    timer = node.create_timer(0.05, ask, callback_group=group)
    _until(lambda: found, node)
    return found


def _goal(execute: Any, order: int = 3, cancel: bool = False, **more: Any) -> list[Any]:
    """Send a goal; list acceptance, feedback, status, result and the error that spinning raised."""
    server, user = rclpy.create_node("server"), rclpy.create_node("user")
    ActionServer(server, Fibonacci, "f", execute, callback_group=ReentrantCallbackGroup(), **more)
    client, feedback, errors = ActionClient(user, Fibonacci, "f"), [], []
    client.wait_for_server(timeout_sec=5.0)

    def wait(future: Any) -> Any:
        errors.append(outcome(_until, future.done, server, user, limit=2.0))
        return future.result()

    handle = wait(
        client.send_goal_async(
            Fibonacci.Goal(order=order),
            feedback_callback=lambda message: feedback.append(list(message.feedback.sequence)),
        )
    )
    if handle is None or not handle.accepted:
        return [handle and handle.accepted, errors]
    canceled = wait(handle.cancel_goal_async()) if cancel else None
    result = wait(handle.get_result_async())
    _until(lambda: False, server, user, limit=0.3)
    return [
        feedback,
        result and (result.status, list(result.result.sequence)),
        canceled and (canceled.return_code, len(canceled.goals_canceling)),
        errors,
    ]


def _succeed(handle: Any) -> Any:
    handle.succeed()
    return Fibonacci.Result(sequence=list(range(handle.request.order)))


def _with_feedback(handle: Any) -> Any:
    for at in range(handle.request.order):
        handle.publish_feedback(Fibonacci.Feedback(sequence=[at]))
    return _succeed(handle)


def _much_feedback(handle: Any) -> Any:
    for at in range(14):
        handle.publish_feedback(Fibonacci.Feedback(sequence=[at]))
    return _succeed(handle)


def _abort(handle: Any) -> Any:
    handle.abort()
    return Fibonacci.Result(sequence=[1])


def _says_nothing(handle: Any) -> Any:
    return Fibonacci.Result(sequence=[1])


def _cancels(handle: Any) -> Any:
    handle.canceled()
    return Fibonacci.Result()


async def _waits(handle: Any) -> Any:
    node_future = rclpy.Future()
    while not handle.is_cancel_requested:
        node_future.cancel()
        await _Tick()
    handle.canceled()
    return Fibonacci.Result(sequence=[7])


class _Tick:
    def __await__(self) -> Any:
        yield


async def _async_succeed(handle: Any) -> Any:
    return _succeed(handle)


lines(
    "goal",
    succeeds=lambda: _goal(_succeed),
    coroutine=lambda: _goal(_async_succeed),
    feedback=lambda: _goal(_with_feedback),
    much_feedback=lambda: _goal(_much_feedback),
    aborts=lambda: _goal(_abort),
    sets_no_state=lambda: _goal(_says_nothing),
    canceled_without_request=lambda: _goal(_cancels),
    returns_nothing=lambda: _goal(lambda handle: handle.succeed()),
    returns_text=lambda: _goal(lambda handle: "x"),
    raises=lambda: _goal(lambda handle: 1 / 0),
    raises_after_success=lambda: _goal(lambda handle: (handle.succeed(), 1 / 0)),
    succeeds_twice=lambda: _goal(lambda handle: (handle.succeed(), handle.succeed())),
    rejected=lambda: _goal(_succeed, goal_callback=lambda goal: GoalResponse.REJECT),
    goal_callback_nothing=lambda: _goal(_succeed, goal_callback=lambda goal: None),
    goal_callback_true=lambda: _goal(_succeed, goal_callback=lambda goal: True),
    goal_callback_raises=lambda: _goal(_succeed, goal_callback=lambda goal: 1 / 0),
    accepted_later=lambda: _goal(_succeed, handle_accepted_callback=lambda handle: handle.execute()),
    accepted_raises=lambda: _goal(_succeed, handle_accepted_callback=lambda handle: 1 / 0),
    canceled=lambda: _goal(_waits, cancel=True, cancel_callback=lambda handle: CancelResponse.ACCEPT),
    wrong_feedback=lambda: _goal(lambda handle: handle.publish_feedback(Fibonacci.Result())),
    feedback_nothing=lambda: _goal(lambda handle: handle.publish_feedback(None)),
    handle=lambda: _goal(lambda handle: (_seen.append(_of_handle(handle)), _succeed(handle))[1]) and _seen,
)
_seen: list[Any] = []


def _of_handle(handle: Any) -> list[Any]:
    return [
        handle.is_active,
        handle.is_cancel_requested,
        handle.status,
        type(handle.goal_id).__name__,
        handle.request,
    ]


def _server(kind: Any = Fibonacci, name: Any = "f", execute: Any = _succeed, **more: Any) -> Any:
    return ActionServer(rclpy.create_node("server"), kind, name, execute, **more)


def _action_client(kind: Any = Fibonacci, name: Any = "f") -> Any:
    return ActionClient(rclpy.create_node("user"), kind, name)


lines(
    "action",
    bad_name=lambda: _server(name="a b"),
    client_bad_name=lambda: _action_client(name="a b"),
    empty_name=lambda: _action_client(name=""),
    no_execute=lambda: _server(execute=None),
    wrong_execute=lambda: _server(execute=3),
    wrong_goal_callback=lambda: _server(goal_callback=3),
    wrong_cancel_callback=lambda: _server(cancel_callback=3),
    wrong_accepted_callback=lambda: _server(handle_accepted_callback=3),
    type_=lambda: _server().action_type.__name__,
    register_goal=lambda: _server().register_goal_callback(print),
    register_goal_wrong=lambda: _server().register_goal_callback(3),
    register_cancel_wrong=lambda: _server().register_cancel_callback(3),
    register_accepted_wrong=lambda: _server().register_handle_accepted_callback(3),
    register_execute_wrong=lambda: _server().register_execute_callback(3),
    destroy=lambda: _server().destroy(),
    destroy_client=lambda: _action_client().destroy(),
    ready=lambda: _action_client().server_is_ready(),
    wait=lambda: _action_client(name="nobody").wait_for_server(timeout_sec=0.3),
    wait_zero=lambda: _action_client(name="nobody").wait_for_server(timeout_sec=0.0),
    goal_wrong=lambda: _action_client().send_goal_async(Fibonacci.Result()),
    goal_text=lambda: _action_client().send_goal_async("x"),
    goal_class=lambda: _action_client().send_goal_async(Fibonacci.Goal),
    goal_whole=lambda: _action_client().send_goal_async(Fibonacci),
    goal_sync_wrong=lambda: _action_client().send_goal(3),
    goal_uuid_wrong=lambda: _action_client().send_goal_async(Fibonacci.Goal(), goal_uuid=3),
    responses=lambda: [str(one) for one in (*GoalResponse, *CancelResponse)],
    future=lambda: _action_client().send_goal_async(Fibonacci.Goal()).done(),
)


@probe
def sync_goal_in_a_thread() -> Any:
    server, user, found = rclpy.create_node("server"), rclpy.create_node("user"), []
    ActionServer(server, Fibonacci, "f", _succeed)
    client = ActionClient(user, Fibonacci, "f")
    client.wait_for_server(timeout_sec=5.0)
    thread = threading.Thread(target=lambda: found.append(client.send_goal(Fibonacci.Goal(order=2))))
    thread.start()
    _until(lambda: found, server, user)
    thread.join(timeout=2.0)
    return [(one.status, list(one.result.sequence)) for one in found]


class Managed(LifecycleNode):
    """A lifecycle node whose callbacks return configurable values."""

    def __init__(self, returns: Any = TransitionCallbackReturn.SUCCESS, **more: Any) -> None:
        super().__init__("managed", **more)
        self.returns, self.calls = returns, []

    def on_configure(self, state: LifecycleState) -> Any:
        self.calls.append(("configure", state.label, state.state_id))
        super().on_configure(state)
        if isinstance(self.returns, Exception):
            raise self.returns
        return self.returns

    def on_error(self, state: LifecycleState) -> Any:
        self.calls.append(("error", state.label, state.state_id))
        return TransitionCallbackReturn.SUCCESS


def _state(node: Any) -> Any:
    return list(node._state_machine.current_state)


def _configured(returns: Any) -> list[Any]:
    node = Managed(returns)
    return [outcome(node.trigger_configure), node.calls, _state(node)]


lines(
    "lifecycle",
    success=lambda: _configured(TransitionCallbackReturn.SUCCESS),
    failure=lambda: _configured(TransitionCallbackReturn.FAILURE),
    error=lambda: _configured(TransitionCallbackReturn.ERROR),
    nothing=lambda: _configured(None),
    true=lambda: _configured(True),
    raises=lambda: _configured(ValueError("x")),
    state=lambda: _state(Managed()),
    machine=lambda: Managed()._state_machine.initialized,
    available_states=lambda: Managed()._state_machine.available_states,
    available_transitions=lambda: Managed()._state_machine.available_transitions,
    activate_too_early=lambda: Managed().trigger_activate(),
    cleanup_too_early=lambda: Managed().trigger_cleanup(),
    shutdown=lambda: _walk("shutdown"),
    shutdown_twice=lambda: _walk("shutdown", "shutdown"),
    whole_life=lambda: _walk("configure", "activate", "deactivate", "cleanup", "configure", "shutdown"),
    activate_twice=lambda: _walk("configure", "activate", "activate"),
    entity_wrong=lambda: Managed().add_managed_entity(3),
    returns=lambda: [(one.name, one.value) for one in TransitionCallbackReturn.__members__.values()],
    to_label=lambda: [one.to_label() for one in TransitionCallbackReturn.__members__.values()],
    state_repr=lambda: LifecycleState("x", 3),
    names=lambda: [Node is LifecycleNode, Publisher.__name__],
    without_services=lambda: sorted(
        service.srv_name for service in Managed(enable_communication_interface=False).services
    ),
    with_services=lambda: sorted(service.srv_name for service in Managed().services),
    publishers=lambda: [publisher.topic_name for publisher in Managed().publishers],
    class_of_publisher=lambda: type(Managed().create_lifecycle_publisher(String, "t", 1)).__name__,
    publisher_class=lambda: Managed().create_lifecycle_publisher(String, "t", 1, publisher_class=Publisher),
    ordinary_publisher=lambda: type(Managed().create_publisher(String, "t", 1)).__name__,
    inactive_publish=lambda: Managed().create_lifecycle_publisher(String, "t", 1).publish(String()),
    activated=lambda: Managed().create_lifecycle_publisher(String, "t", 1).is_activated,
)


def _walk(*transitions: str) -> list[Any]:
    node = Managed()
    found: list[Any] = []
    for transition in transitions:
        found.append([outcome(getattr(node, f"trigger_{transition}")), _state(node)])
    return found


@probe
def inactive_publishers_are_silent() -> list[Any]:
    node, heard = Managed(), []
    publisher = node.create_lifecycle_publisher(String, "t", 10)
    node.create_subscription(String, "t", lambda message: heard.append(message.data), 10)
    _until(lambda: publisher.get_subscription_count(), node)
    found = []
    for transition in ("configure", "activate", "deactivate"):
        getattr(node, f"trigger_{transition}")()
        found.append(publisher.is_activated)
        publisher.publish(String(data=transition))
        _until(lambda: False, node, limit=0.2)
    return [found, heard]


def _ask(kind: Any, name: str, request: Any = None) -> Any:
    node, user = Managed(), rclpy.create_node("user")
    client = user.create_client(kind, f"/managed/{name}")
    client.wait_for_service(timeout_sec=5.0)
    future = client.call_async(request or kind.Request())
    _until(future.done, node, user)
    return [future.result(), _state(node)]


lines(
    "lifecycle_service",
    state=lambda: _ask(GetState, "get_state"),
    states=lambda: _ask(GetAvailableStates, "get_available_states"),
    transitions=lambda: _ask(GetAvailableTransitions, "get_available_transitions"),
    configure=lambda: _ask(
        ChangeState,
        "change_state",
        ChangeState.Request(transition=Transition(id=Transition.TRANSITION_CONFIGURE)),
    ),
    by_label=lambda: _ask(
        ChangeState, "change_state", ChangeState.Request(transition=Transition(label="configure"))
    ),
)


if __name__ == "__main__":
    main()
