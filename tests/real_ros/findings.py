"""Differences from the real rclpy 7.1.6 found in version 0.3, and the tests or rows that cover them.

A finding is shown by probes (`probe FILE NAME`), by programs (`program NAME`) or by tests (`test NAME`). A
difference that stays has a row of docs/simulated.md (`row SUBJECT`).
"""

SERIOUS = {
    "own attributes and methods named like private helpers": (
        "test test_attributes_and_methods_of_a_student_node_do_not_break_it",
        "test test_classes_have_no_private_name_missing_in_rclpy",
    ),
    "own attributes named like private ones of rclpy": (
        "test test_assigning_a_private_name_of_rclpy_gives_one_notice_with_its_line",
        "test test_overriding_a_private_name_of_rclpy_gives_a_notice",
    ),
    "publishing and shutdown after the end of a run": (
        "program stop_in_finally",
        "program shutdown_in_finally",
        "program after_the_end",
        "row The end of a run",
    ),
    "polling with a time limit of 0": (
        "probe refusals polling_takes_every_second_call",
        "row Polling, `spin_once(timeout_sec=0)`",
    ),
    "awaiting an rclpy future in asyncio": (
        "probe refusals asyncio_awaits_a_future",
        "test test_goals_and_results_can_be_awaited_in_asyncio",
    ),
    "two types on one topic or service": (
        "probe refusals two_types_on_one_topic",
        "probe refusals two_types_in_two_nodes",
        "probe refusals two_types_of_one_service",
        "row Two types on one topic or service",
    ),
}

MEDIUM = {
    "extra bytes at the end of a message": (
        "probe refusals bytes_with_a_tail",
        "row Extra bytes at the end of a message",
    ),
    "parameter callback without a result": (
        "probe refusals parameter_callback_without_a_return",
        "probe refusals parameter_callback_that_returns_true",
    ),
    "remappings in the style of ROS 1": (
        "probe arguments remappings_of_ros_1",
        "probe details printed.old_remap",
        "probe details init.removed_old_style",
    ),
    "compatibility of two ordinary profiles": ("probe qos plain.plain", "probe qos plain.automatic"),
    "calls of a destroyed node": (
        "probe destroyed destroyed.get_name",
        "probe destroyed destroyed.create_publisher",
        "probe destroyed destroyed.get_topic_names_and_types",
        "probe destroyed shut_down.create_publisher",
        "probe destroyed shut_down.create_timer",
    ),
    "cancelled futures and tasks": (
        "probe refusals cancelled_futures",
        "probe futures future.cancelled",
        "probe running request.canceled",
        "probe running task.cancel_itself",
    ),
    "a coroutine object as a task": (
        "probe refusals coroutine_objects_as_tasks",
        "probe futures task.coroutine",
    ),
    "spin_once with the node's own executor": ("probe refusals spin_once_keeps_a_node_in_its_executor",),
    "the policy of an event as a string": ("probe qos policy_of_an_event", "probe graphs event.durability"),
    "endpoints in queries of the graph": (
        "probe graphs endpoint.text",
        "probe graphs endpoint.hash",
        "row Depth in `get_publishers_info_by_topic`",
    ),
    "defaults of bytes and of strings with quotes in own messages": (
        "test test_default_is_a_value_of_its_type",
    ),
    "further names of services, and nav_msgs/Goals": (
        "probe arguments parts_of_services",
        "probe details printed.goals",
    ),
    "formats and colors of log lines": (
        "row `RCUTILS_CONSOLE_OUTPUT_FORMAT`, `RCUTILS_LOGGING_USE_STDOUT`, `RCUTILS_COLORIZED_OUTPUT`",
    ),
    "an empty list in a parameter file": ("probe arguments empty_list_in_a_file_of_parameters",),
    "the status of a goal at its acceptance": (
        "probe details status_of_a_goal_is_published_when_it_is_accepted",
    ),
    "two threads that spin": (
        "probe spinning two.spins",
        "probe spinning two.global_executor",
        "probe spinning two.executors",
    ),
    "two partners before a spin": ("probe graphs event.two_partners",),
    "spinning after the shutdown": (
        "probe destroyed spinning_after_shutdown",
        "probe destroyed shut_down.spin_once",
        "row Executors after `rclpy.shutdown()`, or before `rclpy.init()`",
    ),
}

SMALL = {
    "a tilde without a slash": ("probe details name.tilde_without_a_slash",),
    "invalid names in queries and of actions": (
        "probe graphs resolve.7",
        "probe details name.info_of_a_bad_name",
        "probe details name.expanded_with_a_space",
        "probe calls action.bad_name",
        "probe calls action.client_bad_name",
    ),
    "invalid arguments of rclpy.init": ("probe details init.bad_rule", "probe details init.bad_rule_printed"),
    "the base class of InvalidHandle": ("probe destroyed invalid_handle_is_a_runtime_error",),
    "names of parameters on the command line": ("probe corners given.dash", "probe corners given.digit"),
    "remappings of only topics or services": (
        "probe corners remap.rostopic",
        "probe corners remap.rosservice",
    ),
    "empty parameter files, and two documents": (
        "probe corners file.empty",
        "probe corners file.comment",
        "probe corners file.two_documents",
    ),
    "numbers of threads": ("probe refusals numbers_of_threads",),
    "a done callback that is None": (
        "probe refusals done_callbacks",
        "probe futures future.callback_none_when_done",
    ),
    "an exception that nobody retrieves": (
        "probe details printed.exception_that_nobody_retrieved",
        "probe details printed.exception_that_was_retrieved",
    ),
    "callbacks that cannot be called": (
        "probe corners corner.on_shutdown_number",
        "probe corners corner.on_set_none",
    ),
    "a negative depth of list_parameters": ("probe corners corner.list_depth_negative",),
    "numbers of messages": ("row Numbers in `MessageInfo`",),
    "the publishers of a node": ("probe graphs query.own_publishers",),
    "the order of a node's services": ("probe graphs query.own_services",),
    "an instance as the type of a topic": (
        "probe graphs publisher.of_an_instance",
        "probe kinds instance.received",
    ),
    "assigning a constant": (
        "probe corners corner.constant",
        "probe corners corner.constant_of_the_class",
    ),
    "copying a profile": ("probe graphs profile.deeply_copied", "probe objects qos.equal_to_copy"),
    "policies that are unknown": (
        "probe corners corner.unknown_reliability",
        "probe corners corner.unknown_durability",
    ),
    "durability by default": (
        "probe corners corner.default_durability",
        "probe corners corner.default_durability_asked",
    ),
    "a zero character in a string": ("row A null character in a string",),
    "a matrix as a covariance": ("row Arrays of numbers", "probe corners corner.flat_matrix"),
    "logging None and bytes": (
        "probe logs message.none",
        "probe logs message.bytes",
        "probe logs rosout.none",
    ),
    "numbers that YAML and rcl read differently": (
        "probe parameters yaml_value.v15",
        "probe parameters yaml_value.v18",
    ),
    "wait_for_service after the shutdown": ("probe corners corner.wait_when_shut_down",),
    "logging after Ctrl+C": ("row Logging between Ctrl+C and `rclpy.shutdown()`",),
    "ok() behind a sleep": ("row `rclpy.ok()` in `except KeyboardInterrupt`",),
    "Ctrl+C without handlers": (
        "program no_handlers",
        "row Ctrl+C with `SignalHandlerOptions.NO`",
    ),
    "time limits that change while a coroutine waits": (
        "row A timeout of `spin_once` that changes while a coroutine waits",
        "probe spinning one_time_limit_while_a_coroutine_waits",
    ),
    "bytes that are no message": ("row Bytes that are not a message",),
    "padding of raw messages": (
        "probe entities takes.raw_text",
        "test test_raw_subscription_and_bytes_between_processes",
    ),
    "printed arrays of int64": (
        "probe corners corner.prints_int64",
        "test test_array_of_int64_is_printed_without_its_dtype_as_in_ros",
    ),
    "missing names": ("test test_public_names_missing_in_the_kit_are_listed_as_missing",),
    "registering the callbacks of an action server": (
        "probe calls action.register_goal",
        "probe calls action.register_cancel_wrong",
    ),
    "names of endpoints, events, groups and types": (
        "probe calls service.logger",
        "probe calls client.context",
        "probe entities group.has",
        "probe corners corner.slot_types",
        "probe futures future.remove",
        "probe details can_execute.timer",
    ),
    "the state of a lifecycle node": ("probe calls lifecycle.machine", "probe running life.configure"),
}

# Statements of docs/simulated.md about ROS 2, and whether they were correct.
STATEMENTS = {
    "the end of a run": ("row The end of a run",),
    "the order of callbacks": ("row Order of callbacks", "probe timers order_of_timers_with_one_period"),
    "a field of the wrong type": ("row A field of the wrong type", "probe objects message.unknown_field"),
    "arguments of logging": ("row `--ros-args`",),
    "a second node of one name": ("probe details printed.second_node_of_a_name",),
    "rclpy.init in a with statement": ("row `with rclpy.init():`",),
    "liveliness": ("row Liveliness",),
    "lifespan": ("row Lifespan",),
    "domains": ("row Domains",),
    "discovery": ("row Discovery",),
    "waiting for ever": ("row Waiting forever",),
}

FINDINGS = SERIOUS | MEDIUM | SMALL | STATEMENTS
