"""Mistakes with Python's own types: numbers, strings, functions and objects."""

# (program, last line of the error, hint below it)
PLAIN_PYTHON = [
    (
        "f'{2.0:.1q}'",
        "ValueError: Unknown format code 'q' for object of type 'float'",
        "after the colon in { } is a format, such as .2f for a number with two decimals, or d for "
        "a "
        "whole number.",
    ),
    (
        "def turn(angle):\n    math = 3\n    return math.cos(angle)\nturn(1.0)",
        "AttributeError: 'int' object has no attribute 'cos'",
        "math is a variable here, math = …, and hides the module math: choose another name for "
        "it, and "
        "import the module again.",
    ),
    (
        "def limit():\n    return 1.0\nlimit < 2.0",
        "TypeError: '<' not supported between instances of 'function' and 'float'",
        "one side is a function that is not called: are its ( ) missing?",
    ),
    (
        "def limit():\n    return 1.0\n2.0 < limit",
        "TypeError: '<' not supported between instances of 'float' and 'function'",
        "one side is a function that is not called: are its ( ) missing?",
    ),
    (
        "import json\njson.loads('Panels:')",
        "json.decoder.JSONDecodeError: Expecting value: line 1 column 1 (char 0)",
        "the text is not JSON: print it. An .rviz or .yaml file is YAML, which yaml.safe_load(text) reads.",
    ),
    (
        "from datetime import time as Time\nTime.from_msg(None)",
        "AttributeError: type object 'datetime.time' has no attribute 'from_msg'",
        "this is the class time of datetime. `from rclpy.time import Time` imports ROS's Time.",
    ),
    (
        "def lowest(items):\n    round = 3\n    return [round(item) for item in items]\nlowest([1.5])",
        "TypeError: 'int' object is not callable",
        "round is a variable here, round = …, and hides Python's round(): choose another name for "
        "it. "
        "In a notebook, del round gives back Python's own.",
    ),
    (
        "def rows(heard):\n    return len(times)\nrows({})",
        "NameError: name 'times' is not defined",
        "rows can use heard, and names that cells of this notebook define. Where is times from?",
    ),
    (
        "speed = 2.0\nspeed.x",
        "AttributeError: 'float' object has no attribute 'x'",
        "this is a number, which has no x: print it, and look where it was set.",
    ),
    (
        "position = None\nposition.x",
        "AttributeError: 'NoneType' object has no attribute 'x'",
        "this is None: does the function that created it return something?",
    ),
    (
        "for joint in {'arm': 1.0}:\n    joint['arm']",
        "TypeError: string indices must be integers, not 'str'",
        "this is a string: print it. Did a loop over a dictionary give its keys?",
    ),
    (
        "Marker()['ns'] = 'arm'",
        "TypeError: 'Marker' object does not support item assignment",
        "a Marker has no [ ]: set one of its attributes, as in `marker.color.r = 1.0`.",
    ),
    (
        "2.0 * node.get_name",
        "TypeError: unsupported operand type(s) for *: 'float' and 'method'",
        "one side is a function that is not called: are its ( ) missing?",
    ),
    (
        "with 1.0:\n    pass",
        "TypeError: 'float' object does not support the context manager protocol",
        "with needs a file or a lock, and this is of type float.",
    ),
    (
        "int(float('nan'))",
        "ValueError: cannot convert float NaN to integer",
        "the number is nan: filter it out first, with math.isfinite(…).",
    ),
    (
        "float('fast')",
        "ValueError: could not convert string to float: 'fast'",
        "the string is not a number: print it.",
    ),
    (
        "import io, sys\nsys.stdin = io.StringIO('')\nspeed = input('speed: ')",
        "EOFError: EOF when reading a line",
        "the program waits for a line from the keyboard, and there is none here: run it in a "
        "terminal, or take the value from a parameter.",
    ),
    (
        "before = set()\nbefore['a'] = 1",
        "TypeError: 'set' object does not support item assignment",
        "set() has no keys: an empty dictionary is `{}`.",
    ),
    (
        "' '.join(['Person', 0.95])",
        "TypeError: sequence item 1: expected str instance, float found",
        "join takes strings, and one item is of type float: an f-string converts it, `f'{speed:.2f} m/s'`.",
    ),
    (
        "speed = print(1.0)\nspeed + 1.0",
        "TypeError: unsupported operand type(s) for +: 'NoneType' and 'float'",
        "print(…) returns None: leave out print, as in speed = 1.0.",
    ),
    (
        "def turned(x):\n    return x\ndef place():\n    turned = 0\n    return turned(1)\nplace()",
        "TypeError: 'int' object is not callable",
        "turned = … is a variable here and hides the function turned: rename it.",
    ),
    (
        "speed = 2.0\nspeed ^ 2.0",
        "TypeError: unsupported operand type(s) for ^: 'float' and 'float'",
        "a power has two stars, like `u**2`: ^ compares bits.",
    ),
    (
        "import math\nmath.atan2(1.0)",
        "TypeError: atan2 expected 2 arguments, got 1",
        "atan2 takes two values, with a comma between them: `math.atan2(1.0, 2.0)`, y and then x.",
    ),
    (
        "Duration(second=1.0)",
        "TypeError: Duration.__init__() got an unexpected keyword argument 'second'",
        "did you mean `seconds`?",
    ),
    (
        "class Painter(Node):\n    def paint(self): ...\nPainter('a').paint(1)",
        "TypeError: Painter.paint() takes 1 positional argument but 2 were given",
        "paint takes nothing besides self, and the call passes 1 value: write paint().",
    ),
    (
        "import math\nmath.sin('1.0')",
        "TypeError: must be real number, not str",
        "functions of math take a number, and this is of type str: print it.",
    ),
    (
        "[1.0, 2.0] * 0.5",
        "TypeError: can't multiply sequence by non-int of type 'float'",
        "a list or a string times a number repeats it. An array multiplies each number: "
        "`np.array([1.0, 2.0]) * 0.5`. A number in quotes is a string: remove the quotes.",
    ),
    (
        "'0.5' * 2.0",
        "TypeError: can't multiply sequence by non-int of type 'float'",
        "a list or a string times a number repeats it. An array multiplies each number: "
        "`np.array([1.0, 2.0]) * 0.5`. A number in quotes is a string: remove the quotes.",
    ),
    (
        "Point() - Point()",
        "TypeError: unsupported operand type(s) for -: 'Point' and 'Point'",
        "a Point is not an array: compute with its fields x, y and z.",
    ),
    (
        "0.25 * Node('a').get_clock().now()",
        "TypeError: unsupported operand type(s) for *: 'float' and 'Time'",
        "a Time is not a number: the time in seconds is `self.get_clock().now().nanoseconds / 1e9`.",
    ),
    (
        "None < 1.0",
        "TypeError: '<' not supported between instances of 'NoneType' and 'float'",
        "one side is None: was it set before this line?",
    ),
    (
        "'0.5' < 1.0",
        "TypeError: '<' not supported between instances of 'str' and 'float'",
        "one side is a string: remove the quotes, or convert it with float(…).",
    ),
    (
        "range(10 / 2)",
        "TypeError: 'float' object cannot be interpreted as an integer",
        "a count is a whole number: int(…), or // instead of /.",
    ),
    (
        "def two_link(lift, elbow): ...\ntwo_link(1.0, 1.0, 0.0, 0.0)",
        "TypeError: two_link() takes 2 positional arguments but 4 were given",
        "the call passes 4 values, and two_link takes 2. If check(…) makes the "
        "call, the function must take the arguments that the task names.",
    ),
    (
        "def two_link(a, b, c): ...\ntwo_link(1.0, 1.0)",
        "TypeError: two_link() missing 1 required positional argument: 'c'",
        "the call passes no value for c: put it in ( ).",
    ),
    (
        "Node('a').create_publisher(String, 'b', 10)(String())",
        "TypeError: 'Publisher' object is not callable",
        "write `self.publisher.publish(message)`.",
    ),
    (
        "min([])",
        "ValueError: min() arg is an empty sequence",
        "the list is empty: handle this case first, with if not values: return. A generator or a "
        "map is empty after its first use: make it a list, with [ ] or list( ).",
    ),
    (
        "int(float('inf'))",
        "OverflowError: cannot convert float infinity to integer",
        "the number is infinite: filter it out first, with math.isfinite(…).",
    ),
    (
        "class Robot(Node):\n    def answer(self, request): ...\nRobot('a').answer()",
        "TypeError: Robot.answer() missing 1 required positional argument: 'request'",
        "the call passes no value for request: put it in ( ).",
    ),
    (
        "TransformBroadcaster()",
        "TypeError: TransformBroadcaster.__init__() missing 1 required positional argument: 'node'",
        "pass the node: `TransformBroadcaster(self)`.",
    ),
    (
        "TransformBroadcaster(Node('a')).publish(1)",
        "AttributeError: 'TransformBroadcaster' object has no attribute 'publish'",
        "write `broadcaster.sendTransform(transform)`.",
    ),
    (
        "TransformBroadcaster(Node('a')).sendTransform()",
        "TypeError: TransformBroadcaster.sendTransform() missing 1 required positional argument: 'transform'",
        "pass the transform: `broadcaster.sendTransform(transform)`.",
    ),
    (
        "def two_link(a, b, first):\n    return lift\ntwo_link(1.0, 1.0, 0.0)",
        "NameError: name 'lift' is not defined",
        "two_link can use a, b and first, and names that cells of this notebook define. Where is lift from?",
    ),
    (
        "import tf2_geometry_msgs\nBuffer().transform('map', Point())",
        "tf2_ros.buffer_interface.TypeException: Type <class 'str'> is not loaded or supported",
        "the message comes first, then the frame: `self.buffer.transform(point, 'map')`.",
    ),
    (
        "import tf2_geometry_msgs\nBuffer().transform(Point(), 'map')",
        "tf2_ros.buffer_interface.TypeException: Type <class 'geometry_msgs.msg._point.Point'> is "
        "not loaded or supported",
        "a Point has no header, so no frame and no time: transform a PointStamped.",
    ),
    (
        "class Robot(Node):\n    def tick(self):\n        time = 1.0\n        return "
        "self.time\nRobot('a').tick()",
        "AttributeError: 'Robot' object has no attribute 'time'",
        "time is a variable of this method: write `time` without self.",
    ),
    (
        "from vision_msgs.msg import Detection3D\nDetection3D().score",
        "AttributeError: 'Detection3D' object has no attribute 'score'",
        "did you mean `results[0].hypothesis.score`? `%ros2 interface show "
        "vision_msgs/msg/Detection3D` lists its fields.",
    ),
    (
        "node = Node('a')\nnode.declare_parameter('max_detections', 5)\nnode.get_parameter('max_detection')",
        "rclpy.exceptions.ParameterNotDeclaredException: Invalid access to undeclared "
        "parameter(s): max_detection",
        "did you mean 'max_detections'? It is declared.",
    ),
    (
        "sorted([Point(), Point()])",
        "TypeError: '<' not supported between instances of 'Point' and 'Point'",
        "two objects of type Point have no order: compare a number of each, as in sorted(items, "
        "key=score_of).",
    ),
    (
        "-'20'",
        "TypeError: bad operand type for unary -: 'str'",
        "a sign needs a number, and this is of type str: print it.",
    ),
    *(
        (
            f"from sensor_msgs.msg import JointState\nimport numpy as np\nJointState().name = {value}",
            "AssertionError: The 'name' field must be a set or sequence and each value of type 'str'",
            hint,
        )
        for value, hint in (
            ("1", "this is one value, 1, and the field takes several: put them into a list, in [ ]."),
            ("'arm'", "this is one value, 'arm', and the field takes several: put them into a list, in [ ]."),
            (
                "{'arm': 1.0}",
                "this is a dictionary, and the field takes a list: list its values in the right order.",
            ),
            ("[['a']]", "item 0 is a list in the list: does it have [ ] of its own, or is a * missing?"),
            (
                "np.eye(2)",
                "this is an array of 2 dimensions, and the field takes one: `matrix.ravel()` is flat.",
            ),
        )
    ),
    (
        "max = 3\nlargest = max(1, 2)",
        "TypeError: 'int' object is not callable",
        "max is a variable here, max = …, and hides Python's max(): choose another name for it. "
        "In a notebook, del max gives back Python's own.",
    ),
    (
        "Marker = Marker()\nmarker = Marker()",
        "TypeError: 'Marker' object is not callable",
        "Marker is an object here, Marker = …, and hides the class Marker: choose another name "
        "for the object, and import the class again.",
    ),
    (
        "x = 1.0 & 2.0",
        "TypeError: unsupported operand type(s) for &: 'float' and 'float'",
        "& and | compare the bits of whole numbers: conditions are joined by the words and, or.",
    ),
    (
        "text = '%s %.2f' % 'Car'",
        "TypeError: not enough arguments for format string",
        "each % in the string needs one value, in ( ) with commas. An f-string contains the names: "
        "`f'{speed:.2f} m/s'`.",
    ),
    (
        "def score_of(item): ...\nsorted([1.0], key=score_of())",
        "TypeError: score_of() missing 1 required positional argument: 'item'",
        "the call passes no value for item: put it in ( ). To pass the function itself, write "
        "score_of without ().",
    ),
    (
        "x = 0.5 * '2.0'",
        "TypeError: can't multiply sequence by non-int of type 'float'",
        "a list or a string times a number repeats it. An array multiplies each number: "
        "`np.array([1.0, 2.0]) * 0.5`. A number in quotes is a string: remove the quotes.",
    ),
    (
        "x = 2\nx(3)",
        "TypeError: 'int' object is not callable",
        "a number is not a function: is a star missing before ( ), as in `2 * (3 + 4)`, or is "
        "there an extra ()?",
    ),
    (
        "angle = 0.5\nangle.cos()",
        "AttributeError: 'float' object has no attribute 'cos'",
        "a function of math takes the number in ( ): math.cos(x).",
    ),
    (
        "import math\nmath.dist([1.0])",
        "TypeError: dist expected 2 arguments, got 1",
        "dist takes 2 values, with a comma between them.",
    ),
    (
        "float('1,5')",
        "ValueError: could not convert string to float: '1,5'",
        "a decimal number has a point and not a comma: replace it, as in `text.replace(',', '.')`.",
    ),
    (
        "items = ['a', 'b']\nfor item in range(len(items)):\n    item.upper()",
        "AttributeError: 'int' object has no attribute 'upper'",
        "item is a number here: the item is items[item]. Or loop over the items themselves: for "
        "item in items.",
    ),
    (
        "reversed(zip([1], [2]))",
        "TypeError: 'zip' object is not reversible",
        "reversed needs a list: reversed(list(zip(…))).",
    ),
    (
        "import copy\nimport threading\ncopy.deepcopy(threading.Lock())",
        "TypeError: cannot pickle '_thread.lock' object",
        "a node, a viewer or a lock cannot be copied: create a new one, or copy a message alone.",
    ),
    (
        "def angles():\n    yield next(iter([]))\nlist(angles())",
        "RuntimeError: generator raised StopIteration",
        "next(…) is at the end of its iterator: itertools.cycle(…) begins again.",
    ),
    (
        "def turn():\n    print(count)\n    global count",
        "SyntaxError: name 'count' is used prior to global declaration",
        "global is the first line of the function. An attribute like self.count needs no global.",
    ),
    (
        "marker = Marker()\nmarker.id := 1",
        "SyntaxError: cannot use assignment expressions with attribute",
        "a value is set with =, without a colon.",
    ),
    (
        "Node = 3\nclass Robot(Node):\n    pass",
        "TypeError: int() takes at most 2 arguments (3 given)",
        "Node is a variable here, Node = …, and hides the class Node: choose another name for it, "
        "and "
        "import the class again.",
    ),
    (
        "def turn(angle):\n    return turn(angle)\nturn(1.0)",
        "RecursionError: maximum recursion depth exceeded",
        "turn calls itself endlessly: leave this call out, or return before it in one case.",
    ),
    (
        "def turn(angle):\n    return back(angle)\ndef back(angle):\n    return turn(angle)\nturn(1.0)",
        "RecursionError: maximum recursion depth exceeded",
        "turn calls back, which calls turn again, endlessly: leave one of these calls out.",
    ),
    (
        "class Robot(Node):\n    def __init__(self):\n        Robot.__init__(self)\nRobot()",
        "RecursionError: maximum recursion depth exceeded",
        "__init__ creates or calls its own class again: begin it with super().__init__('a_name').",
    ),
    (
        "class Arm:\n    @property\n    def angle(self):\n        return self.angle\nArm().angle",
        "RecursionError: maximum recursion depth exceeded",
        "self.angle in the property angle calls it again: keep the value in self._angle.",
    ),
    (
        "class Arm:\n    def __getattr__(self, name):\n        return self.missing\nArm().angle",
        "RecursionError: maximum recursion depth exceeded",
        "__getattr__ reads an attribute that is missing, and so calls itself: leave __getattr__ out.",
    ),
    (
        "import math\nmath.deg2rad(90)",
        "AttributeError: module 'math' has no attribute 'deg2rad'",
        "math has `math.radians(90.0)` and math.degrees; deg2rad is in numpy.",
    ),
    (
        "raise",
        "RuntimeError: No active exception to reraise",
        "raise alone repeats an error inside except. Delete the line if it is left over from the exercise.",
    ),
    (
        "raise NotImplemented('empty')",
        "TypeError: 'NotImplementedType' object is not callable",
        "delete the line with raise when your own lines are there.",
    ),
    (
        "next(iter([]))",
        "StopIteration",
        "next(…) is at the end of its iterator: use a for loop, or pass a default, `next(iter([]), None)`.",
    ),
    (
        "for i in range(0, 1, 0.1):\n    pass",
        "TypeError: 'float' object cannot be interpreted as an integer",
        "range has whole numbers only: `np.arange(0.0, 1.0, 0.1)` has steps of a tenth.",
    ),
    (
        "round('1.5')",
        "TypeError: type str doesn't define __round__ method",
        "this is a string: `round(float('1.5'))`.",
    ),
    (
        "open('data.csv')",
        "FileNotFoundError: [Errno 2] No such file or directory: 'data.csv'",
        "a file name without a folder is looked up where the program was started, and in a "
        "notebook next to it: `os.listdir()` lists the files there.",
    ),
    (
        "import math\nmath.cosine(0.5)",
        "AttributeError: module 'math' has no attribute 'cosine'",
        "did you mean `cos`?",
    ),
    (
        "import math\nmath.pi()",
        "TypeError: 'float' object is not callable",
        ".pi is a value and not a function: leave out its ( ).",
    ),
    (
        "name = '1.5'\nprint(f'{name:.2f}')",
        "ValueError: Unknown format code 'f' for object of type 'str'",
        "this is a string, and .2f is for numbers: convert it first, as in `f\"{float('1.5'):.2f}\"`.",
    ),
    (
        "print(f'{[1.0]:.2f}')",
        "TypeError: unsupported format string passed to list.__format__",
        "a format like .2f is for one number, and this is of type list: format each of its numbers.",
    ),
    (
        "facts = {rate: 25.0}",
        "NameError: name 'rate' is not defined",
        "a key of a dictionary is a string, in quotes: 'rate'.",
    ),
    (
        "exec(\"facts = {'rate' = 25.0}\")",
        "SyntaxError: cannot assign to literal here. Maybe you meant '==' instead of '='?",
        "in a dictionary a key is followed by a colon: 'rate': ….",
    ),
    (
        "exec(\"facts = {'rate': 25,0, 'width': 64}\")",
        "SyntaxError: ':' expected after dictionary key",
        "a decimal number has a point, 0.5. With a comma, as in 25,0, these are two numbers.",
    ),
    (
        "exec('print(f\"{name\")')",
        "SyntaxError: f-string: expecting '}'",
        "a { in the f-string has no }: close it after the name, as in `f'{3.14159:.2f}'`.",
    ),
    (
        "exec('from my-package import Robot')",
        "SyntaxError: invalid syntax",
        "a name cannot contain a minus: write my_package. A package with a minus in its "
        "name cannot be imported.",
    ),
    (
        "axes = {'x': 0, 'y': 1}\ndef turned(axis, angle):\n    return axes[axis]\nturned(0.5, 'x')",
        "KeyError: 0.5",
        "turned(…) gets axis = 0.5 in line 4: are its values right, and in order?",
    ),
    (
        "def half(number):\n"
        "    try:\n"
        "        result = 1.0 / number\n"
        "    except ZeroDivisionError:\n"
        "        print('no number')\n"
        "    return result\n"
        "half(0.0)",
        "UnboundLocalError: cannot access local variable 'result' where it is not associated with a value",
        'the line that sets result raised an error, and after "except ZeroDivisionError:" '
        "the function goes on without a value: end the except with return.",
    ),
    (
        "rows = [(1, 2.0), (2, 1.0)]\nsorted(rows, key=lambda: rows[1])",
        "TypeError: <lambda>() takes 0 positional arguments but 1 was given",
        "this function is called with each item: give its parameter a name, key=lambda item: …, "
        "and use item after the colon.",
    ),
    (
        "import numpy as np\ncorners = [(1.0, 2.0, 3.0)] * 4\nx, y, z = np.array(corners)",
        "ValueError: too many values to unpack (expected 3)",
        "unpacking an array gives its rows. Its columns are the rows of .T: x, y, z = np.array(corners).T",
    ),
    (
        "joints, angles = [('x', 1.0)], [0.5]\nfor (axis, shift), angle in zip(angles, joints):\n    pass",
        "TypeError: cannot unpack non-iterable float object",
        "(axis, shift) gets an item of angles, which is a single value: exchange the lists, "
        "zip(joints, angles).",
    ),
    (
        "base = None\nbase[0] = 1.0",
        "TypeError: 'NoneType' object does not support item assignment",
        "this is None, which has no [ ]: was it set before this line? To set the whole value, "
        "write = "
        "without [ ].",
    ),
    (
        "lifts = {1: 1.5, 5: 0.5}\nlifts[2]",
        "KeyError: 2",
        "lifts has only 1 and 5 as keys. Test first whether the key is there: if … in lifts.",
    ),
    (
        "class Lamp:\n    def __init__(self):\n        height = 1.4\n    def tick(self):\n"
        "        return height\nLamp().tick()",
        "NameError: name 'height' is not defined",
        "height is a local variable of __init__, and exists only there: keep it in the node, "
        "self.height = … in __init__, and read self.height here.",
    ),
    (
        "class Lamp:\n    def __init__(self):\n"
        "        self.publisher = node.create_publisher(Marker, '/m', 10)\n"
        "    def publish_marker(self):\n        "
        "self.pub.publish(Marker())\nLamp().publish_marker()",
        "AttributeError: 'Lamp' object has no attribute 'pub'",
        "did you mean `publisher`?",
    ),
    (
        "from geometry_msgs.msg import Transform\nMarker().pose = Transform()",
        "AssertionError: The 'pose' field must be a sub message of type 'Pose'",
        "this is a Transform: copy x, y, z and the quaternion to the fields of the Pose.",
    ),
]
