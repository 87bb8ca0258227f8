"""Nodes, timers, logging, and the run around them."""

# (program, last line of the error, hint below it)
NODES = [
    (
        "from rclpy.lifecycle import LifecycleNode\n"
        "class Robot(LifecycleNode):\n    def on_configure(self):\n        pass\n"
        "Robot('a').on_configure(None)",
        "TypeError: Robot.on_configure() takes 1 positional argument but 2 were given",
        "the callback gets the state before the transition: write `def on_configure(self, state)`.",
    ),
    (
        "import random\nclass Robot(random):\n    pass",
        "TypeError: module() takes at most 2 arguments (3 given)",
        "random is a module: write a class of it in ( ), as in class Robot(Node): ….",
    ),
    (
        "import sys\nspeed = float(sys.argv[20])",
        "IndexError: list index out of range",
        "the program needs arguments: course run FILE -- VALUES, or in a launch file, for its Node, "
        "`arguments=['1.0', '2.0']`.",
    ),
    (
        "from rclpy.action import ActionClient\nActionClient(String, '/an_action')",
        "TypeError: ActionClient.__init__() missing 1 required positional argument: 'action_name'",
        "the node comes first: `ActionClient(self, Fibonacci, '/an_action')`.",
    ),
    (
        "class Robot(Node):\n    def __init__(self):\n        super().__init__('a')\n"
        "        self.create_timer(0.1, self.executor)\n    def executor(self):\n"
        "        pass\nrclpy.spin_once(Robot())",
        "AttributeError: 'function' object has no attribute 'wake'",
        "rclpy itself reads executor of a node: choose another name for your method executor.",
    ),
    (
        "class Robot(Node):\n    def __init__(self):\n        super().__init__('a')\n"
        "        self.create_timer(0.1, self.context)\n    def context(self):\n"
        "        pass\nrclpy.spin_once(Robot())",
        "AttributeError: 'function' object has no attribute 'handle'",
        "rclpy itself reads context of a node: choose another name for your method context.",
    ),
    (
        "class Robot(Node):\n    def __init__(self):\n        super().__init__('a')\n"
        "        self.create_timer(0.1, self.handle)\n    def handle(self):\n"
        "        pass\nrclpy.spin_once(Robot())",
        "TypeError: 'method' object does not support the context manager protocol",
        "rclpy itself reads handle of a node: choose another name for your method handle.",
    ),
    (
        "class Robot(Node):\n    def __init__(self):\n        super().__init__('a')\n"
        "        self.create_timer(0.1, self.timers)\n    def timers(self):\n"
        "        pass\nrclpy.spin_once(Robot())",
        "TypeError: 'method' object is not iterable",
        "rclpy itself reads timers of a node: choose another name for your method timers.",
    ),
    (
        "class Robot(Node):\n"
        "    def __init__(self):\n"
        "        self.publisher = self.create_publisher(String, 'chatter', 10)\n"
        "Robot()",
        "AttributeError: 'Robot' object has no attribute '_default_callback_group'",
        "call `super().__init__('a_name')` first in Robot.__init__().",
    ),
    (
        "class Robot(Node):\n    def __init__(self):\n        super().__init__()\nRobot()",
        "TypeError: Node.__init__() missing 1 required positional argument: 'node_name'",
        "give the node a name: `super().__init__('a_name')`, in def __init__ with two underscores "
        "on each side.",
    ),
    (
        "node.create_timer(0.1, lambda event: None)\nrclpy.spin(node)",
        "TypeError: <lambda>() missing 1 required positional argument: 'event'",
        "a timer passes no argument: write `lambda: self.tick()`, without a name before the colon.",
    ),
    (
        "node.create_timer(0.1, lambda timer, event: None)\nrclpy.spin(node)",
        "TypeError: <lambda>() missing 2 required positional arguments: 'timer' and 'event'",
        "a timer passes no argument: write `lambda: self.tick()`, without a name before the colon.",
    ),
    (
        "class Robot(Node):\n"
        "    def __init__(self):\n"
        "        super().__init__('a')\n"
        "        self.create_timer(0.1, self.tick)\n"
        "    def tick(): ...\n"
        "rclpy.spin(Robot())",
        "TypeError: Robot.tick() takes 0 positional arguments but 1 was given",
        "write self first: `def tick(self)`.",
    ),
    (
        "class Robot(Node):\n"
        "    def __init__(self):\n"
        "        super().__init__('a')\n"
        "        self.create_timer(0.1, self.tick)\n"
        "    def tick(robot):\n"
        "        self.get_logger().info('tick')\n"
        "rclpy.spin(Robot())",
        "NameError: name 'self' is not defined",
        "write self as the method's first parameter: `def tick(self)`.",
    ),
    (
        "class Robot(Node):\n    def __init__(): ...\nRobot()",
        "TypeError: Robot.__init__() takes 0 positional arguments but 1 was given",
        "write self first: `def __init__(self)`.",
    ),
    (
        "class Robot(Node):\n    def go(speed): ...\nRobot('a').go(1.0)",
        "TypeError: Robot.go() takes 1 positional argument but 2 were given",
        "is self first in def go(self, …)?",
    ),
    (
        "Publisher",
        "NameError: name 'Publisher' is not defined",
        "define or import Publisher first, or put it in quotes if it is a string; in a notebook "
        "run the cells above, beginning with the first one. Another notebook's names do not exist here.",
    ),
    (
        "MarkerArray()",
        "NameError: name 'MarkerArray' is not defined",
        "import it: `from visualization_msgs.msg import MarkerArray`; "
        "in a notebook run the first cells again.",
    ),
    (
        "def f():\n    g()\ndef g():\n    f()\nglobals().update(f=f, g=g)\nf()",
        "RecursionError: maximum recursion depth exceeded",
        "f calls g, which calls f again, endlessly: leave one of these calls out.",
    ),
    (
        "node.create_timer(0.1, print('tick'))\nrclpy.spin(node)",
        "TypeError: 'NoneType' object is not callable",
        "pass the function itself, without (): `self.tick`, not self.tick(). A method with "
        "@property is "
        "called, too.",
    ),
    (
        "node.create_timer(-0.1, lambda: None)",
        "rclpy._rclpy_pybind11.RCLError: failed to create timer: timer period must be non-negative",
        "pass the period in seconds, like 0.1 for 10 Hz.",
    ),
    (
        "node.create_timer(print, 0.1)",
        "TypeError: float() argument must be a string or a real number, not 'builtin_function_or_method'",
        "pass the period in seconds first, then the function: `self.create_timer(1.0, self.tick)`.",
    ),
    (
        "class Robot(Node):\n    def __init__(self):\n        super.__init__('a')\nRobot()",
        "TypeError: descriptor '__init__' requires a 'super' object but received a 'str'",
        "write `super().__init__('a_name')`, with () after super.",
    ),
    (
        "class Robot(Node):\n"
        "    def __init__(self):\n"
        "        super().__init__('a')\n"
        "        self.pub = self.create_publisher(String, 'chatter', 10)\n"
        "Robot().publisher",
        "AttributeError: 'Robot' object has no attribute 'publisher'",
        "set `self.publisher` in Robot.__init__, spelled the same.",
    ),
    (
        "node.create_timer('0.1 s', lambda: None)",
        "ValueError: could not convert string to float: '0.1 s'",
        "pass the period in seconds, as a number.",
    ),
    (
        "rclpy.shutdown()\nNode('late')",
        "rclpy.exceptions.NotInitializedException: rclpy.init() has not been called. msg:cannot create node",
        "rclpy.shutdown() was called before, maybe in another cell: call `rclpy.init()` again.",
    ),
    (
        "rclpy.init()",
        "RuntimeError: Context.init() must only be called once",
        "call rclpy.init() once per program; `rclpy.ok()` returns True after it.",
    ),
    (
        "rclpy.shutdown()\nrclpy.shutdown()",
        "RuntimeError: Context must be initialized before it can be shutdown",
        "`rclpy.try_shutdown()` never raises an error.",
    ),
    (
        "Node('my robot')",
        "rclpy.exceptions.InvalidNodeNameException: Invalid node name: node name must not contain "
        "characters other than alphanumerics or '_':",
        "use letters, digits and underscores, like front_camera; the rest belongs in namespace=.",
    ),
    (
        "Node('2nd')",
        "rclpy.exceptions.InvalidNodeNameException: Invalid node name: node name must not start "
        "with a number:",
        "use letters, digits and underscores, like front_camera; the rest belongs in namespace=.",
    ),
    (
        "Node('/robot')",
        "rclpy.exceptions.InvalidNodeNameException: Invalid node name: node name must not contain "
        "characters other than alphanumerics or '_':",
        "use letters, digits and underscores, like front_camera; the rest belongs in namespace=.",
    ),
    (
        "Node('robot', namespace='my ns')",
        "rclpy.exceptions.InvalidNamespaceException: Invalid namespace: namespace must not contain "
        "characters other than alphanumerics, '_', or '/':",
        "use letters, digits and underscores, and begin with a letter, like /robot_1.",
    ),
    (
        "rate = node.create_rate(1)\nnode.create_timer(0.1, rate.sleep)\nrclpy.spin(node)",
        "course_lib.ros.time.time_lock.DeadlockError: Rate.sleep() waits for a tick that comes "
        "only after this callback has ended. Use a timer, or a MultiThreadedExecutor.",
        "",
    ),
    (
        "node.create_timer(0.1, lambda: rclpy.spin(node))\nrclpy.spin(node)",
        "ValueError: generator already executing",
        "a callback must not spin: use await, or add_done_callback.",
    ),
    (
        "rclpy.spin()",
        "TypeError: spin() missing 1 required positional argument: 'node'",
        "pass the node: rclpy.spin(node).",
    ),
    (
        "node.get_logger().info(5)",
        "TypeError: rclpy_logging_rcutils_log(): incompatible function arguments: the message must "
        "be a str, not int; write str(...) or an f-string",
        "write one f-string: `self.get_logger().info(f'speed: {speed}')`.",
    ),
    (
        "node.get_logger().info('speed:', 5)",
        "TypeError: RcutilsLogger.info() takes 2 positional arguments but 3 were given",
        "write one f-string: `self.get_logger().info(f'speed: {speed}')`.",
    ),
    (
        "for say in ('info', 'error'):\n    getattr(node.get_logger(), say)('hello')",
        "ValueError: Logger severity cannot be changed between calls.",
        "write one line for each severity.",
    ),
    (
        "from rclpy.lifecycle import LifecycleNode\n"
        "class Camera(LifecycleNode):\n    def on_configure(self, state):\n        pass\n"
        "Camera('camera').trigger_configure()",
        "AttributeError: 'NoneType' object has no attribute 'to_label'",
        "end the callback with `return TransitionCallbackReturn.SUCCESS`.",
    ),
    (
        "from rclpy.lifecycle import LifecycleNode\n"
        "class Camera(LifecycleNode):\n    def on_configure(self, state):\n        return True\n"
        "Camera('camera').trigger_configure()",
        "AttributeError: 'bool' object has no attribute 'to_label'",
        "end the callback with `return TransitionCallbackReturn.SUCCESS`.",
    ),
    (
        "class Robot(Node):\n    publisher = self.create_publisher(String, 'chatter', 10)",
        "NameError: name 'self' is not defined",
        "only methods have self: move this line into `def __init__(self)` of the class.",
    ),
    (
        "node.get_logger().info('speed', 3)",
        "TypeError: RcutilsLogger.info() takes 2 positional arguments but 3 were given",
        "write one f-string: `self.get_logger().info(f'speed: {speed}')`.",
    ),
    (
        "rclpy.spin('talker')",
        "AttributeError: 'str' object has no attribute 'executor'",
        "spin takes the node, an object of your class, and this is of type str.",
    ),
    (
        "rclpy.spin(node.create_publisher(String, 'chatter', 10))",
        "AttributeError: 'Publisher' object has no attribute 'subscriptions'",
        "spin takes the node, an object of your class, and this is of type Publisher.",
    ),
    (
        "class Robot:\n    pass\nrclpy.spin(Robot())",
        "AttributeError: 'Robot' object has no attribute 'subscriptions'",
        "to be spun, Robot must be a node: write class Robot(Node), "
        "and call `super().__init__('a_name')` first in Robot.__init__().",
    ),
    (
        "class Robot(Node):\n    def drive(self):\n        pass\nRobot.drive()",
        "TypeError: Robot.drive() missing 1 required positional argument: 'self'",
        "drive is a method of an object. Create one, like robot = Robot(), and write robot.drive().",
    ),
    (
        "from rclpy.executors import MultiThreadedExecutor\nMultiThreadedExecutor(node)",
        "TypeError: '<=' not supported between instances of 'Node' and 'int'",
        "the argument is the number of threads. Add the node: `executor.add_node(node)`.",
    ),
    (
        "Node(package='demo_nodes_py', executable='talker')",
        "TypeError: Node.__init__() got an unexpected keyword argument 'package'",
        "this is rclpy's Node. In a launch file, write `from launch_ros.actions import Node`.",
    ),
    (
        "node.create_timer(0.1, 'tick')\nrclpy.spin(node)",
        "TypeError: 'str' object is not callable",
        "the callback is a function and not its name: write self.tick, without quotes.",
    ),
    (
        "class Counter(Node):\n"
        "    def __init__(self):\n"
        "        super().__init__('counter')\n"
        "        self.tick = 0\n"
        "        self.create_timer(0.1, self.tick)\n"
        "    def tick(self):\n"
        "        self.tick += 1\n"
        "rclpy.spin(Counter())",
        "TypeError: 'int' object is not callable",
        "the callback is 0, of type int: is it an attribute with the name of a method, or is the "
        "callback another argument of the call?",
    ),
    (
        "class Counter(Node):\n"
        "    def __init__(self):\n"
        "        super().__init__('counter')\n"
        "        self.steps = 0\n"
        "        self.steps()\n"
        "    def steps(self):\n"
        "        pass\n"
        "Counter()",
        "TypeError: 'int' object is not callable",
        "self.steps = … hides the method steps: choose another name for the attribute.",
    ),
    (
        "import asyncio\n"
        "async def tick():\n"
        "    await asyncio.sleep(0.1)\n"
        "node.create_timer(0.1, tick)\n"
        "rclpy.spin(node)",
        "RuntimeError: no running event loop",
        "rclpy runs callbacks without asyncio: leave out asyncio, and let a timer of the node "
        "repeat or delay work.",
    ),
    (
        "class Robot(Node):\n    def __init__(self):\n        super().__init__(self, 'a')\nRobot()",
        "TypeError: Node.__init__() takes 2 positional arguments but 3 were given",
        "super() passes self itself: write `super().__init__('a_name')`.",
    ),
    (
        "class Box(Node):\n"
        "    def __init__(self):\n"
        "        super().__init__('a')\n"
        "class Robot(Box):\n"
        "    def __init__(self):\n"
        "        super().__init__('b')\n"
        "Robot()",
        "TypeError: Box.__init__() takes 1 positional argument but 2 were given",
        "this class is derived from Box, whose __init__ takes no value: write (Node) after the "
        "name of the class, or super().__init__().",
    ),
    (
        "class Robot(Node):\n"
        "    def __init__(self):\n"
        "        super().__init__('a')\n"
        "        publisher = 1\n"
        "    def publish_all(self):\n"
        "        self.publisher.publish(1)\n"
        "Robot().publish_all()",
        "AttributeError: 'Robot' object has no attribute 'publisher'",
        "publisher = … in __init__ is a variable that ends with it: write self.publisher = … there.",
    ),
    (
        "node.destroy()",
        "AttributeError: 'Node' object has no attribute 'destroy'",
        "`node.destroy_node()` ends a node, `rclpy.shutdown()` all of them.",
    ),
    (
        "node.create_timer(1.0)",
        "TypeError: Node.create_timer() missing 1 required positional argument: 'callback'",
        "the call passes no value for callback: put it in ( ).",
    ),
    (
        "class Robot(Node):\n"
        "    def tick(self): ...\n"
        "node.create_timer(0.0, Robot.tick)\n"
        "rclpy.spin_once(node)",
        "TypeError: Robot.tick() missing 1 required positional argument: 'self'",
        "pass the method of the object, self.tick. A @staticmethod has no self.",
    ),
    (
        "class Robot(Node):\n"
        "    def heard(self, message): ...\n"
        "node.create_timer(0.0, Robot('a').heard)\n"
        "rclpy.spin_once(node)",
        "TypeError: Robot.heard() missing 1 required positional argument: 'message'",
        "a timer passes no message. Messages arrive by `self.create_subscription(Marker, "
        "'/a_topic', self.heard, 10)`; a timer calls `def heard(self)`.",
    ),
    (
        "class Robot(Node):\n"
        "    def __init__(self):\n"
        "        super().__init__('robot')\n"
        "    def get_name(self):\n"
        "        print('robot')\n"
        "Robot()",
        'TypeError: can only concatenate str (not "NoneType") to str',
        "rclpy itself calls get_name() and get_namespace() of a node, which return strings: choose "
        "another name for your method.",
    ),
    (
        "node.get_logger().loginfo('text')",
        "AttributeError: 'RcutilsLogger' object has no attribute 'loginfo'",
        "the logger has debug, info, warning, error and fatal: `self.get_logger().info('text')`.",
    ),
    (
        "class Robot(Node):\n"
        "    def __init__(self):\n"
        "        super().__init__('robot')\n"
        "        self.clock.now()\n"
        "Robot()",
        "AttributeError: 'Robot' object has no attribute 'clock'",
        "did you mean `self.get_clock()`?",
    ),
    (
        "from rclpy.callback_groups import ReentrantCallbackGroup\n"
        "node.create_timer(1.0, print, callback_group=ReentrantCallbackGroup)",
        "TypeError: CallbackGroup.add_entity() missing 1 required positional argument: 'entity'",
        "this is a class of callback groups: create an object of it, with ( ).",
    ),
    (
        "from rclpy.executors import SingleThreadedExecutor\nSingleThreadedExecutor(node)",
        "TypeError: SingleThreadedExecutor.__init__() takes 1 positional argument but 2 were given",
        "an executor gets its nodes afterwards: `executor.add_node(node)`.",
    ),
    (
        "rclpy.spin([node, Node('other')])",
        "TypeError: unhashable type: 'list'",
        "one node is needed here, and this is a list. An executor runs several: call "
        "`executor.add_node(node)` for each of them, and then executor.spin().",
    ),
    (
        "Node('a_name', '/robot')",
        "TypeError: Node.__init__() takes 2 positional arguments but 3 were given",
        "Node takes the name, and all other values by their names: `Node('a_name', namespace='/robot')`.",
    ),
    (
        "class Other(Node):\n    pass\nOther('other').trigger_configure()",
        "AttributeError: 'Other' object has no attribute 'trigger_configure'",
        "only a lifecycle node has this method: derive the class from LifecycleNode, `from "
        "rclpy.lifecycle import LifecycleNode`.",
    ),
    (
        "class Talker():\n    def __init__(self):\n        self.create_timer(1.0, print)\nTalker()",
        "AttributeError: 'Talker' object has no attribute 'create_timer'",
        "write (Node) after the name of the class, class Talker(Node): then it has create_timer.",
    ),
    (
        "class Talker(Node):\n    def __init__(self):\n        super(Node).__init__('talker')\nTalker()",
        "TypeError: super() argument 1 must be type, not str",
        "write `super().__init__('a_name')`, with nothing in super( ).",
    ),
    (
        "class Talker(Node):\n    def __init__(self):\n        super().__int__('talker')\nTalker()",
        "AttributeError: 'super' object has no attribute '__int__'",
        "__init__ is misspelled: write `super().__init__('a_name')`.",
    ),
    (
        "rclpy.spin(Node('first'), Node('second'))",
        "AttributeError: 'Node' object has no attribute 'remove_node'",
        "spin takes one node. An executor runs several: call `executor.add_node(node)` for "
        "each of them, and then executor.spin().",
    ),
    (
        "node.get_clock.now()",
        "AttributeError: 'function' object has no attribute 'now'",
        "node.get_clock is a function: call it with ( ) before the dot, node.get_clock().now.",
    ),
    (
        "class Talker(Node):\n"
        "    def __init__(self):\n"
        "        super().__init__('talker')\n"
        "        self.start()\n"
        "        self.angle = 0.0\n"
        "    def start(self):\n"
        "        print(self.angle)\n"
        "Talker()",
        "AttributeError: 'Talker' object has no attribute 'angle'",
        "self.angle is set later, in line 5: move that line up, before this one.",
    ),
    (
        "class Talker(Node):\n"
        "    def __init__(self):\n"
        "        super().__init__('talker')\n"
        "    def heard(self, message):\n"
        "        self.message = message\n"
        "    def tick(self):\n"
        "        print(self.message)\n"
        "Talker().tick()",
        "AttributeError: 'Talker' object has no attribute 'message'",
        "self.message is set in heard, which has not run yet: write self.message = None in "
        "__init__, and `if self.message is None: return` before this line.",
    ),
    (
        "class Talker(Node):\n"
        "    def heard(self, message):\n"
        "        print(self.scale)\n"
        "Talker('talker').heard(Marker())",
        "AttributeError: 'Talker' object has no attribute 'scale'",
        "did you mean `message.scale`? It is a field of the message.",
    ),
    (
        "class Talker(Node):\n"
        "    def __init__(self):\n"
        "        super().__init__('talker')\n"
        "        self.timer_of = {}\n"
        "    def value(self, key):\n"
        "        return key\n"
        "Talker().values('rate')",
        "AttributeError: 'Talker' object has no attribute 'values'",
        "did you mean `value`?",
    ),
]
