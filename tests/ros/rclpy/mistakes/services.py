"""Services and actions."""

# (program, last line of the error, hint below it)
SERVICES = [
    (
        "client = node.create_client(AddTwoInts, 'add')\nclient.call_async(AddTwoInts.Request()).sum",
        "AttributeError: 'Future' object has no attribute 'sum'",
        "the result is not available yet: `await future`, or `future.add_done_callback(f)`.",
    ),
    (
        "client = node.create_client(AddTwoInts, 'add')\nclient.call_async(AddTwoInts)",
        "TypeError",
        "pass a request, with (): `AddTwoInts.Request(a=1, b=1)`.",
    ),
    (
        "node.create_client(AddTwoInts.Request, 'add')",
        "RuntimeError: The service type provided is not valid (<class "
        "'example_interfaces.srv._add_two_ints.AddTwoInts_Request'>), this might be a message or "
        "action",
        "import types from .msg, .srv or .action.",
    ),
    (
        "node.create_service(AddTwoInts, 'add', lambda request, response: None)\n"
        "client = node.create_client(AddTwoInts, 'add')\n"
        "client.call_async(AddTwoInts.Request())\n"
        "rclpy.spin(node)",
        "TypeError",
        "end the service's callback with `return response`.",
    ),
    (
        "node.create_service(AddTwoInts, 'add', lambda request, response: request.a + request.b)\n"
        "client = node.create_client(AddTwoInts, 'add')\n"
        "client.call_async(AddTwoInts.Request())\n"
        "rclpy.spin(node)",
        "TypeError",
        "end the service's callback with `return response`.",
    ),
    (
        "node.create_service(AddTwoInts, 'add', lambda request: None)\n"
        "client = node.create_client(AddTwoInts, 'add')\n"
        "client.call_async(AddTwoInts.Request())\n"
        "rclpy.spin(node)",
        "TypeError: <lambda>() takes 1 positional argument but 2 were given",
        "write `def answer(self, request, response)`.",
    ),
    (
        "node.create_service(AddTwoInts, 'add', lambda request, response: response)\n"
        "client = node.create_client(AddTwoInts, 'add')\n"
        "node.create_timer(0.1, lambda: client.call(AddTwoInts.Request()))\n"
        "rclpy.spin(node)",
        "course_lib.ros.time.time_lock.DeadlockError: call() on /add waits for a response that is "
        "taken only after this callback has ended. Use call_async() with add_done_callback() or "
        "await; or a MultiThreadedExecutor, with the client in another callback group.",
        "",
    ),
    (
        "AddTwoInts()",
        "NotImplementedError: Service classes can not be instantiated",
        "create its request: `AddTwoInts.Request(a=1)`.",
    ),
    (
        "ActionServer(node, Fibonacci, 'count', lambda goal: goal.succeed())\n"
        "ActionClient(node, Fibonacci, 'count').send_goal_async(Fibonacci.Goal())\n"
        "rclpy.spin(node)",
        "AssertionError: The 'result' field must be a sub message of type 'Fibonacci_Result'",
        "end the callback with return Fibonacci.Result().",
    ),
    (
        "ActionClient(node, Fibonacci, 'count').publish(5)",
        "AttributeError: 'ActionClient' object has no attribute 'publish'",
        "an action client sends goals, send_goal_async(goal). For a topic, write self.create_publisher(…).",
    ),
    (
        "ActionClient(node, Fibonacci, 'count').send_goal_async(5)",
        "TypeError",
        "pass a goal, with (): `Fibonacci.Goal(order=5)`.",
    ),
    (
        "ActionServer(node, AddTwoInts, 'count', print)",
        "RuntimeError: The action type provided is not valid (<class "
        "'example_interfaces.srv._add_two_ints.AddTwoInts'>), this might be a message or service",
        "import types from .msg, .srv or .action.",
    ),
    (
        "from std_srvs.srv import SetBool\nnode.create_client(SetBool, 'light').call_async(True)",
        "TypeError",
        "pass a request, with (): `SetBool.Request(data=True)`.",
    ),
    (
        "node.create_client('add', AddTwoInts)",
        "AttributeError: type object 'str' has no attribute '_TYPE_SUPPORT' This might be a ROS "
        "1 message type but it should be a ROS 2 message type. Make sure to source your ROS 2 "
        "workspace after your ROS 1 workspace.",
        "pass the type first, then the name in quotes: `self.create_client(AddTwoInts, '/a_service')`.",
    ),
    (
        "node.create_service('add', AddTwoInts, print)",
        "AttributeError: type object 'str' has no attribute '_TYPE_SUPPORT' This might be a ROS "
        "1 message type but it should be a ROS 2 message type. Make sure to source your ROS 2 "
        "workspace after your ROS 1 workspace.",
        "pass the type first, then the name in quotes: `self.create_service(AddTwoInts, "
        "'/a_service', self.answer)`.",
    ),
    (
        "node.create_service(AddTwoInts, print, 'add')",
        "TypeError: __init__(): incompatible constructor arguments.",
        "pass the type first, then the name in quotes: `self.create_service(AddTwoInts, "
        "'/a_service', self.answer)`.",
    ),
    (
        "class Other(Node):\n"
        "    def done(self): ...\n"
        "node.create_service(AddTwoInts, 'add', lambda request, response: response)\n"
        "client = node.create_client(AddTwoInts, 'add')\n"
        "client.call_async(AddTwoInts.Request()).add_done_callback(Other('other').done)\n"
        "rclpy.spin(node)",
        "TypeError: Other.done() takes 1 positional argument but 2 were given",
        "the callback of a future gets the future: write `def done(self, future)`. The response "
        "is future.result().",
    ),
    (
        "node.create_service(AddTwoInts, 'add', lambda request, response: response)\n"
        "client = node.create_client(AddTwoInts, 'add')\n"
        "future = client.call_async(AddTwoInts.Request())\n"
        "rclpy.spin_until_future_complete(node, future)\n"
        "future.sum",
        "AttributeError: 'Future' object has no attribute 'sum'",
        "this future is done: the field is in its result, future.result().sum.",
    ),
    (
        "def done(future):\n"
        "    print(future.result().sum)\n"
        "client = node.create_client(AddTwoInts, 'add')\n"
        "future = client.call_async(AddTwoInts.Request())\n"
        "future.add_done_callback(done(future))",
        "AttributeError: 'NoneType' object has no attribute 'sum'",
        "add_done_callback gets the function itself, without ( ): add_done_callback(done).",
    ),
    (
        "ActionServer(node, 'count', Fibonacci, print)",
        "AttributeError: type object 'str' has no attribute '_TYPE_SUPPORT' This might be a ROS 1 "
        "message type but it should be a ROS 2 message type. Make sure to source your ROS 2 "
        "workspace after your ROS 1 workspace.",
        "after the node, the type comes first, then the name in quotes: `ActionServer(self, "
        "Fibonacci, '/an_action', self.execute)`.",
    ),
    (
        "ActionClient(node, 'count', Fibonacci)",
        "AttributeError: type object 'str' has no attribute '_TYPE_SUPPORT' This might be a ROS 1 "
        "message type but it should be a ROS 2 message type. Make sure to source your ROS 2 "
        "workspace after your ROS 1 workspace.",
        "after the node, the type comes first, then the name in quotes: `ActionClient(self, "
        "Fibonacci, '/an_action')`.",
    ),
    (
        "ActionServer(Fibonacci, 'count', print)",
        "TypeError: ActionServer.__init__() missing 1 required positional argument: 'execute_callback'",
        "the node comes first: `ActionServer(self, Fibonacci, '/an_action', self.execute)`.",
    ),
    (
        "def execute():\n"
        "    return Fibonacci.Result()\n"
        "ActionServer(node, Fibonacci, 'count', execute)\n"
        "ActionClient(node, Fibonacci, 'count').send_goal_async(Fibonacci.Goal())\n"
        "rclpy.spin_once(node, timeout_sec=0.1)\n"
        "rclpy.spin_once(node, timeout_sec=0.1)\n"
        "rclpy.spin_once(node, timeout_sec=0.1)",
        "TypeError: execute() takes 0 positional arguments but 1 was given",
        "the callback of an action server gets the goal handle: write `def execute(goal_handle)`. "
        "The goal is goal_handle.request.",
    ),
    (
        "def execute(goal):\n"
        "    goal.succeed()\n"
        "    goal.succeed()\n"
        "ActionServer(node, Fibonacci, 'count', execute)\n"
        "ActionClient(node, Fibonacci, 'count').send_goal_async(Fibonacci.Goal())\n"
        "rclpy.spin_once(node, timeout_sec=0.1)\n"
        "rclpy.spin_once(node, timeout_sec=0.1)\n"
        "rclpy.spin_once(node, timeout_sec=0.1)",
        "rclpy._rclpy_pybind11.RCLError: Failed to update goal state: goal_handle attempted invalid "
        "transition from state SUCCEEDED with event SUCCEED",
        "a goal ends once: call only one of succeed(), abort() and canceled() for it.",
    ),
    (
        "def execute(goal):\n"
        "    goal.succeed()\n"
        "    return Fibonacci.Result\n"
        "ActionServer(node, Fibonacci, 'count', execute)\n"
        "ActionClient(node, Fibonacci, 'count').send_goal_async(Fibonacci.Goal())\n"
        "rclpy.spin(node)",
        "AssertionError: The 'result' field must be a sub message of type 'Fibonacci_Result'",
        "this is the class Fibonacci.Result: create an object, with `Fibonacci.Result()`.",
    ),
    (
        "Fibonacci()",
        "NotImplementedError: Action classes can not be instantiated",
        "create its goal: `Fibonacci.Goal(order=5)`.",
    ),
]
