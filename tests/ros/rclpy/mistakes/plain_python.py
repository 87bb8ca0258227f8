"""Mistakes with Python's own types: numbers, lists, dictionaries and arrays."""

# (program, last line of the error, hint below it)
PLAIN_PYTHON = [
    (
        "min[5, 3]",
        "TypeError: 'builtin_function_or_method' object is not subscriptable",
        "a function is called with ( ), not with [ ].",
    ),
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
        "for (name, height), number in enumerate([('a', 1.0)]):\n    pass",
        "TypeError: cannot unpack non-iterable int object",
        "enumerate gives pairs, an index and then an item: `for index, item in enumerate(items)`.",
    ),
    (
        "async def chosen():\n    return [1]\nfor item in chosen():\n    pass",
        "TypeError: 'coroutine' object is not iterable",
        "an async function has no result yet: leave out async, or write await before the call.",
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
        "rows = list\nrows.append([1.0])",
        "TypeError: list.append() takes exactly one argument (0 given)",
        "append takes one item, in ( ). If one is there, the name stands for the class list "
        "itself: "
        "an empty list is `[]`.",
    ),
    (
        "{1.0, 2.0}[0]",
        "TypeError: 'set' object is not subscriptable",
        "{ } around single values makes a set, which has no order: use [ ] for a list.",
    ),
    (
        "filter(bool, [1, 2])[:1]",
        "TypeError: 'filter' object is not subscriptable",
        "a filter has no [ ]: make a list of it first, with list( ).",
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
        "rows can use heard, and names that the cells above define. Where is times from?",
    ),
    (
        "[1, 2]['a']",
        "TypeError: list indices must be integers or slices, not str",
        "a list has numbers as indices: [0] is its first item. A name in quotes is a key of a dictionary.",
    ),
    (
        "bytes([[0, 0], [0, 0]])",
        "TypeError: 'list' object cannot be interpreted as an integer",
        "one whole number is needed here, and this is of type list: print it. Is a list inside a "
        "list, or a number in quotes?",
    ),
    (
        "import numpy as np\nnp.array([1.0]).append(2.0)",
        "AttributeError: 'numpy.ndarray' object has no attribute 'append'",
        "an array has a fixed length: collect items in a list, `items.append(item)`, and make the "
        "array at the end.",
    ),
    (
        "speed = 2.0\nspeed.x",
        "AttributeError: 'float' object has no attribute 'x'",
        "this is a number, which has no x: print it, and look where it was set.",
    ),
    (
        "limits = {'speed': 2.0}\nlimits.speed",
        "AttributeError: 'dict' object has no attribute 'speed'",
        'a value of a dictionary is selected by its key in [ ] and quotes: ["speed"].',
    ),
    (
        "position = None\nposition.x",
        "AttributeError: 'NoneType' object has no attribute 'x'",
        "this is None: does the function that created it return something?",
    ),
    (
        "import numpy as np\nx = np.array([1.0])\nx > 0.0 & x < 1.0",
        "TypeError: ufunc 'bitwise_and' not supported for the input types",
        "put each comparison into ( ): `(items[0] > 0) & (items[0] < 1)`. An array of False "
        "is `np.zeros(3, bool)`.",
    ),
    (
        "corner = (1.0, 2.0)\ncorner['x']",
        "TypeError: tuple indices must be integers or slices, not str",
        "a tuple has numbers as indices: [0] is its first item.",
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
        "import numpy as np\nfloat(np.array([1.0, 2.0]))",
        "TypeError: only ",
        "one number is needed here, and this is an array: take one of its items, like [0].",
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
        "(1.0, 2.0)[2]",
        "IndexError: tuple index out of range",
        "the tuple is shorter than that: print len(…) of it first.",
    ),
    (
        "import io, sys\nsys.stdin = io.StringIO('')\nspeed = input('speed: ')",
        "EOFError: EOF when reading a line",
        "the program waits for a line from the keyboard, and there is none here: run it in a "
        "terminal, or take the value from a parameter.",
    ),
    (
        "[].pop()",
        "IndexError: pop from empty list",
        "each pop removes an item, and no item is left: loop over the list, or test first, with if values:.",
    ),
    (
        "LAMPS = ['red', 'green']\nnumber = 1\nLAMPS[number + 1]",
        "IndexError: list index out of range",
        "LAMPS has 2 items, from [0] to [1], so not [number + 1, which is 2].",
    ),
    (
        "topics = {'/scan': 'LaserScan'}\nfor topic, kind in topics.keys():\n    pass",
        "ValueError: too many values to unpack (expected 2)",
        "keys() gives only the keys: write topics.items().",
    ),
    (
        "{'a': 1}.has_key('a')",
        "AttributeError: 'dict' object has no attribute 'has_key'",
        "write `'known' in {}`: in tests whether a dictionary has a key.",
    ),
    (
        "markers = {}\nmarkers.append(1)",
        "AttributeError: 'dict' object has no attribute 'append'",
        "{ } is an empty dictionary, and an empty list is `[]`. A dictionary gets an entry by its "
        "key: "
        "`dict()['known'] = 1.0`.",
    ),
    (
        "markers = ()\nmarkers.append(1)",
        "AttributeError: 'tuple' object has no attribute 'append'",
        "a tuple, in ( ), cannot be changed: begin with a list, `items = []`.",
    ),
    (
        "markers = None\nmarkers.append(1)",
        "AttributeError: 'NoneType' object has no attribute 'append'",
        "this is None, which has no append: begin with an empty list, `items = []`. append itself "
        "returns "
        "None, so no = stands before it.",
    ),
    (
        "markers = list\nmarkers.append(1)",
        "TypeError: descriptor 'append' for 'list' objects doesn't apply to a 'int' object",
        "list without ( ) is the class itself: an empty one is list().",
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
        "scores = []\nscores[0]",
        "IndexError: list index out of range",
        "scores is empty here: test this first, with if len(scores) == 0.",
    ),
    (
        "corners = [(1.0, 1.0) (-1.0, 1.0)]",
        "TypeError: 'tuple' object is not callable",
        "a comma is missing between two items, before (.",
    ),
    (
        "rows = [[1.0, 0.0] [0.0, 1.0]]",
        "TypeError: list indices must be integers or slices, not tuple",
        "a comma is missing between two items, before [.",
    ),
    (
        "corners = [(1, 1)]\ncorners = corners.append((2, 2))\nfor x, y in corners:\n    pass",
        "TypeError: 'NoneType' object is not iterable",
        "corners.append(…) changes its object and returns None: leave out corners = before it.",
    ),
    (
        "speed = print(1.0)\nspeed + 1.0",
        "TypeError: unsupported operand type(s) for +: 'NoneType' and 'float'",
        "print(…) returns None: leave out print, as in speed = 1.0.",
    ),
    (
        "lamps = ['red']\nfor number in range(lamps):\n    pass",
        "TypeError: 'list' object cannot be interpreted as an integer",
        "range takes a number: range(len(lamps)) gives the indices of lamps.",
    ),
    (
        "def turned(x):\n    return x\ndef place():\n    turned = 0\n    return turned(1)\nplace()",
        "TypeError: 'int' object is not callable",
        "turned = … is a variable here and hides the function turned: rename it.",
    ),
    (
        "import math\nangle = 2 * math.pi * 0,25 * 3.0\nmath.sin(angle)",
        "TypeError: must be real number, not tuple",
        "a decimal number has a point, 0.5. With a comma, as in 0,25, these are two numbers.",
    ),
    (
        "joints, angles = [1, 2, 3], [0.1, 0.2, 0.3]\nfor joint, angle in joints, angles:\n    pass",
        "ValueError: too many values to unpack (expected 2)",
        "zip pairs the items of two lists: write for joint, angle in zip(joints, angles).",
    ),
    (
        "speed = 2.0\nspeed ^ 2.0",
        "TypeError: unsupported operand type(s) for ^: 'float' and 'float'",
        "a power has two stars, like `u**2`: ^ compares bits.",
    ),
    (
        "import numpy as np\nnp.zeros(3, 4)",
        "TypeError: Cannot interpret '4' as a data type",
        "the shape is one value, in ( ) of its own: `np.zeros((3, 4))`.",
    ),
    (
        "import math\nmath.atan2(1.0)",
        "TypeError: atan2 expected 2 arguments, got 1",
        "atan2 takes two values, with a comma between them: `math.atan2(1.0, 2.0)`, y and then x.",
    ),
    (
        "int('Person')",
        "ValueError: invalid literal for int() with base 10: 'Person'",
        "int(…) takes digits only, and this string is 'Person'. Is it another field?",
    ),
    (
        "items = [1.0]\nitems = items.append(2.0)\nitems.append(3.0)",
        "AttributeError: 'NoneType' object has no attribute 'append'",
        "items.append(…) changes its object and returns None: leave out items = before it.",
    ),
    (
        "from nav_msgs.msg import Path\nfor point in Path(): ...",
        "TypeError: 'Path' object is not iterable",
        "a Path is not a list, but has one: loop over its field poses.",
    ),
    (
        "markers = []\nmarkers += Marker()",
        "TypeError: 'Marker' object is not iterable",
        "+= adds all items of a list. `items.append(item)` adds a single item.",
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
        "for key in {}.items: ...",
        "TypeError: 'builtin_function_or_method' object is not iterable",
        "this is a function that is not called: are its ( ) missing?",
    ),
    (
        "import numpy as np\nnp.zeros(3).x",
        "AttributeError: 'numpy.ndarray' object has no attribute 'x'",
        "an array has indices: [0] is x, [1] is y, [2] is z.",
    ),
    (
        "import math\nmath.radians([30.0, 60.0])",
        "TypeError: must be real number, not list",
        "functions of math take one number. For each number of a list: "
        "`[math.radians(angle) for angle in (30.0, 60.0)]`.",
    ),
    (
        "import math\nmath.sin('1.0')",
        "TypeError: must be real number, not str",
        "functions of math take a number, and this is of type str: print it.",
    ),
    (
        "joints = [['z', 1.0]]\nangles = [0.5]\nfor joint in joints:\n    angles[joint]",
        "TypeError: list indices must be integers or slices, not list",
        "an index is a whole number: `for i in range(len(items))` gives indices, "
        "`for item in items` the items.",
    ),
    (
        "from sensor_msgs.msg import JointState\nJointState().position['elbow_joint'] = 1.0",
        "TypeError: array indices must be integers",
        "an index is a whole number: // instead of /, or int(…). A name is not an index: "
        "`state.position = [0.1, 0.2]` sets the whole field.",
    ),
    (
        "from sensor_msgs.msg import JointState\nJointState().position[0] = 1.0",
        "IndexError: array assignment index out of range",
        "the array is shorter, and empty in a new message. Set the whole field in one step: "
        "`state.position = [0.1, 0.2]`.",
    ),
    (
        "place = (1.0, 2.0)\nplace[0] = 2.0",
        "TypeError: 'tuple' object does not support item assignment",
        "a tuple cannot be changed: make a list, or a new one.",
    ),
    (
        "[1.0, 2.0] * 0.5",
        "TypeError: can't multiply sequence by non-int of type 'float'",
        "a list or a string times a number repeats it. An array multiplies each number: "
        "`np.array([1.0, 2.0]) * 0.5`. A number in quotes is a string: remove the quotes.",
    ),
    (
        "[1.0] + 1.0",
        'TypeError: can only concatenate list (not "float") to list',
        "+ joins two lists: a single item in [ ] can be added to a list. To add numbers, use "
        "`np.array([1.0, 2.0]) + 1.0`.",
    ),
    (
        "{'amplitude': 0.5} * 2.0",
        "TypeError: unsupported operand type(s) for *: 'dict' and 'float'",
        "one side is a dictionary: take one of its values, by its name in [ ].",
    ),
    (
        "[1.0] - [0.5]",
        "TypeError: unsupported operand type(s) for -: 'list' and 'list'",
        "one side is a list: take an item of it, like [0], or use `np.array([1.0, 2.0])`.",
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
        "len(1.0)",
        "TypeError: object of type 'float' has no len()",
        "len() takes a list, and this is of type float: print it.",
    ),
    (
        "{'x': 1}[[0.0]]",
        "TypeError: unhashable type: 'list'",
        "a list cannot be a key: are two arguments swapped?",
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
        "joints = []\njoints(1.0)",
        "TypeError: 'list' object is not callable",
        "select an item of a list with [ ], not with ( ).",
    ),
    (
        "import numpy as np\nnp.eye(4) @ [1.0, 2.0, 3.0]",
        "ValueError: matmul: Input operand 1 has a mismatch in its core dimension 0, with gufunc "
        "signature (n?,k),(k,m?)->(n?,m?) (size 3 is different from 4)",
        "a 4 x 4 matrix needs points with four numbers: x, y, z and 1.",
    ),
    (
        "import numpy as np\nnp.eye(3) @ np.eye(4)",
        "ValueError: matmul: Input operand 1 has a mismatch in its core dimension 0, with gufunc "
        "signature (n?,k),(k,m?)->(n?,m?) (size 4 is different from 3)",
        "the sizes 4 and 3 do not fit: print .shape of both sides of @.",
    ),
    (
        "import numpy as np\n1 @ np.eye(4)",
        "ValueError: matmul: Input operand 0 does not have enough dimensions (has 0, gufunc core "
        "with signature (n?,k),(k,m?)->(n?,m?) requires 1)",
        "one side of @ is a number, but @ multiplies arrays: begin the product with `np.eye(4)`.",
    ),
    (
        "import numpy as np\nnp.array([[1.0, 2.0], 1.0])",
        "ValueError: setting an array element with a sequence. The requested array has an "
        "inhomogeneous shape after 1 dimensions. The detected shape was (2,) + inhomogeneous part.",
        "the rows have different lengths, or one item is a list and another a number. A * unpacks "
        "a list into another one: [*tip, 1.0].",
    ),
    (
        "[1.0, 2.0].index(3.0)",
        "ValueError: 3.0 is not in list",
        "the value is not among the items: print both. nan is not equal to any value, not even to itself.",
    ),
    (
        "min([])",
        "ValueError: min() arg is an empty sequence",
        "the list is empty: handle this case first, with if not values: return. A generator or a "
        "map is empty after its first use: make it a list, with [ ] or list( ).",
    ),
    (
        "import numpy as np\nif np.zeros(3) < 1.0: ...",
        "ValueError: The truth value of an array with more than one element is ambiguous. Use "
        "a.any() or a.all()",
        "an array has many values: compare one of them, or use .any() or .all().",
    ),
    (
        "int(float('inf'))",
        "OverflowError: cannot convert float infinity to integer",
        "the number is infinite: filter it out first, with math.isfinite(…).",
    ),
    ("mine = {'amplitude': 0.5}\nmine['amplitud']", "KeyError: 'amplitud'", "did you mean 'amplitude'?"),
    (
        "{'z': 1.0}[0.5]",
        "KeyError: 0.5",
        "the dictionary has no such key: print its keys with list(…).",
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
        "from tf2_ros import TransformListener\nTransformListener(Node('a'), Buffer())",
        "AttributeError: 'Buffer' object has no attribute 'create_subscription'",
        "the buffer comes first, then the node: `TransformListener(self.buffer, self)`.",
    ),
    (
        "def two_link(a, b, first):\n    return lift\ntwo_link(1.0, 1.0, 0.0)",
        "NameError: name 'lift' is not defined",
        "two_link can use a, b and first, and names that the cells above define. Where is lift from?",
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
        "[1.0].sort()[:2]",
        "TypeError: 'NoneType' object is not subscriptable",
        "this is None: does the function or method before [ ] return something? list.sort() does not.",
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
        "scan = [1.0] * 10\nscan[len(scan) / 2]",
        "TypeError: list indices must be integers or slices, not float",
        "an index is a whole number: // instead of /, or int(…).",
    ),
    (
        "list = []\nitems = list('abc')",
        "TypeError: 'list' object is not callable",
        "list is a variable here, list = …, and hides Python's list(): choose another name for "
        "it. In a notebook, del list gives back Python's own.",
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
        "for x, y, z in enumerate([(1.0, 2.0, 3.0)]):\n    pass",
        "ValueError: not enough values to unpack (expected 3, got 2)",
        "enumerate gives pairs, an index and an item. The names for the item's parts are in ( ): "
        "`for index, (x, y) in enumerate([(1.0, 2.0)])`.",
    ),
    (
        "for marker in enumerate([Marker()]):\n    marker.scale.x = 1.0",
        "AttributeError: 'tuple' object has no attribute 'scale'",
        "enumerate gives pairs: `for index, item in enumerate(items)`.",
    ),
    (
        "markers = {'car': Marker()}\nfor marker in markers.items():\n    marker.scale.x = 1.0",
        "AttributeError: 'tuple' object has no attribute 'scale'",
        "items() gives pairs, a key and a value: write two names between for and in.",
    ),
    (
        "node.limits = {'speed': 2.0}\nfor name, limit in node.limits:\n    pass",
        "ValueError: too many values to unpack (expected 2)",
        "node.limits is a dictionary, whose loop gives only its keys: write node.limits.items().",
    ),
    (
        "(low, high), limits = [[1.0, 2.0, 3.0]] * 2",
        "ValueError: too many values to unpack (expected 2)",
        "there are more values than names on the left: print the value on the right.",
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
        "text = '{} {:.2f}'.format('Car')",
        "IndexError: Replacement index 1 out of range for positional args tuple",
        "the string has more { } than format( ) has values. An f-string contains the names: "
        "`f'{speed:.2f} m/s'`.",
    ),
    (
        "import numpy as np\nx = np.dot([1.0, 2.0], [1.0, 2.0, 3.0])",
        "ValueError: shapes (2,) and (3,) not aligned: 2 (dim 0) != 3 (dim 0)",
        "the shapes (2,) and (3,) do not fit: the last number of the first one and the first "
        "number of the second one have to be equal.",
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
        "import numpy as np\nnp.norm([3.0, 4.0])",
        "AttributeError: module 'numpy' has no attribute 'norm'",
        "this function is in linalg: write np.linalg.norm.",
    ),
    (
        "import numpy as np\nnp.array(1.0, 2.0, 3.0)",
        "TypeError: array() takes from 1 to 2 positional arguments but 3 were given",
        "put the values into one list: `np.array([1.0, 2.0, 3.0])`.",
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
        "x = f'{3.2.2f}'",
        "SyntaxError: invalid decimal literal",
        "in an f-string the format follows a colon: `f'{3.14159:.2f}'`.",
    ),
    (
        "import numpy as np\np = np.array([0, 0])\np += 0.5",
        "_UFuncOutputCastingError: Cannot cast ufunc 'add' output from dtype('float64') to "
        "dtype('int64') with casting rule 'same_kind'",
        "this array has whole numbers only: begin it with decimal points, `np.array([0.0, 0.0])`, "
        "or "
        "dtype=float.",
    ),
    (
        "reversed(zip([1], [2]))",
        "TypeError: 'zip' object is not reversible",
        "reversed needs a list: reversed(list(zip(…))).",
    ),
    (
        "if ['LaserScan'] in 'LaserScan':\n    pass",
        "TypeError: 'in <string>' requires string as left operand, not list",
        "write the value first, then the list: `'map' in ['map', 'odom']`.",
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
        "import numpy as np\nnp.deg2rad('90')",
        "TypeError: ufunc 'deg2rad' not supported for the input types, and the inputs could not "
        "be safely "
        "coerced to any supported types according to the casting rule ''safe''",
        "numpy computes with numbers, and one of these is a string or None: print it. "
        "`float('90')` makes a "
        "number of a string.",
    ),
    (
        "import numpy as np\nnp.dot([1, 2], [1, 2], [3])",
        "TypeError: 'out' must be an array",
        "np.dot and np.matmul take two values, and the third is where the result is stored: "
        "multiply with "
        "@, one after the other.",
    ),
    (
        "import numpy as np\nnp.array([1.0, 2.0])[0.5]",
        "IndexError: only integers, slices (`:`), ellipsis (`...`), numpy.newaxis (`None`) and "
        "integer or "
        "boolean arrays are valid indices",
        "an index is a whole number: // divides without a fraction, and int(…) cuts it off.",
    ),
    (
        "import numpy as np\nnp.array([1, 2, 3]).reshape(2, 2)",
        "ValueError: cannot reshape array of size 3 into shape (2,2)",
        "rows times columns is not 3, the number of items: print .shape before.",
    ),
    (
        "import math\nmath.deg2rad(90)",
        "AttributeError: module 'math' has no attribute 'deg2rad'",
        "math has `math.radians(90.0)` and math.degrees; deg2rad is in numpy.",
    ),
    (
        "[].add(1.0)",
        "AttributeError: 'list' object has no attribute 'add'",
        "the method of a list is append: `items.append(item)`.",
    ),
    (
        "[1.0].length",
        "AttributeError: 'list' object has no attribute 'length'",
        "len(…) is the number of items.",
    ),
    (
        "def size():\n    print(1.0, 2.0)\nx, y = size()",
        "TypeError: cannot unpack non-iterable NoneType object",
        "this is None: does each branch of the function that created it end with a return?",
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
        "import numpy as np\nnp.zeros(3).shape()",
        "TypeError: 'tuple' object is not callable",
        ".shape is a value and not a function: leave out its ( ).",
    ),
    (
        "[[1, 2], [3, 4]][0, 1]",
        "TypeError: list indices must be integers or slices, not tuple",
        "a list of lists is indexed twice, as in [0][1]. Only an array takes two indices in one "
        "pair of brackets, `matrix[0, 0]`.",
    ),
    (
        "import numpy as np\nnp.append(np.zeros((2, 3)), [1.0, 2.0, 3.0], axis=0)",
        "ValueError: all the input arrays must have same number of dimensions, but the array at "
        "index 0 has 2 dimension(s) and the array at index 1 has 1 dimension(s)",
        "one is a row and the other a matrix: a row in [ ] of its own is a matrix, `np.array([[1.0, 2.0]])`.",
    ),
    (
        "import numpy as np\nnp.concatenate([1.0], [2.0])",
        "TypeError: 'list' object cannot be interpreted as an integer",
        "concatenate takes the arrays in one list: `np.concatenate([[1.0], [2.0]])`.",
    ),
    (
        "import numpy as np\nnp.vstack([1.0], [2.0])",
        "TypeError: vstack() takes 1 positional argument but 2 were given",
        "vstack takes the arrays in one list: `np.vstack([[1.0, 2.0], [3.0, 4.0]])`.",
    ),
    (
        "import numpy as np\nnp.concatenate([np.zeros((2, 3)), np.zeros((2, 2))])",
        "ValueError: all the input array dimensions except for the concatenation axis must match "
        "exactly, but along dimension 1, the array at index 0 has size 3 and the array at index 1 "
        "has size 2",
        "the sizes do not fit: print .shape of each array.",
    ),
    (
        "import numpy as np\nnp.linalg.norm(np.zeros(3), axis=1)",
        "numpy.exceptions.AxisError: axis 1 is out of bounds for array of dimension 1",
        "axes are counted from 0, and this array has 1: print its shape. Without axis, the "
        "function uses all numbers.",
    ),
    (
        "import numpy as np\nnp.linalg.inv(np.zeros((2, 2)))",
        "numpy.linalg.LinAlgError: Singular matrix",
        "this matrix has no inverse: print it. Is a row or a column 0, or are two of them the same?",
    ),
    (
        "import numpy as np\nnp.linalg.inv(np.zeros((2, 3)))",
        "numpy.linalg.LinAlgError: Last 2 dimensions of the array must be square",
        "only a square matrix has an inverse: print its shape.",
    ),
    (
        "import numpy as np\nnp.math.sin(1.0)",
        "AttributeError: module 'numpy' has no attribute 'math'",
        "the functions of math are in `import math`, and numpy has functions of its own, like `np.sin(1.0)`.",
    ),
    (
        "import numpy as np\nnp.float(1)",
        "The aliases was originally deprecated in NumPy 1.20; for more details and guidance see "
        "the original release note at:",
        "write float, without np.",
    ),
    (
        "import numpy as np\nnp.interp(0.25, 3.0, 5.0)",
        "ValueError: object of too small depth for desired array",
        "np.interp takes two lists, places and their values: `np.interp(0.25, [0.0, 1.0], [3.0, 5.0])`.",
    ),
    (
        "import numpy as np\nnp.arctan2(1.0)",
        "TypeError: arctan2() takes from 2 to 3 positional arguments but 1 was given",
        "arctan2 takes two values: `np.arctan2(1.0, 2.0)`, y and then x.",
    ),
    (
        "import numpy as np\n[1, 2, 3][np.float64(1.0)]",
        "TypeError: list indices must be integers or slices, not numpy.float64",
        "an index is a whole number: // instead of /, or int(…).",
    ),
    (
        "for i in range(0, 1, 0.1):\n    pass",
        "TypeError: 'float' object cannot be interpreted as an integer",
        "range has whole numbers only: `np.arange(0.0, 1.0, 0.1)` has steps of a tenth.",
    ),
    (
        "import numpy as np\nmatrix = np.eye(4)\nmatrix[:3, 3] = [1.0, 2.0]",
        "ValueError: could not broadcast input array from shape (2,) into shape (3,)",
        "the shapes do not match: print .shape of both sides.",
    ),
    (
        "import numpy as np\nmatrix = np.eye(4)\nmatrix[:3, 3] = [[1.0], [2.0], [3.0]]",
        "ValueError: setting an array element with a sequence. The requested array would exceed "
        "the maximum number of dimension of 1.",
        "each item must be a single number, and one of them is a list: print .shape of both sides.",
    ),
    (
        "round('1.5')",
        "TypeError: type str doesn't define __round__ method",
        "this is a string: `round(float('1.5'))`.",
    ),
    ("values = {'1': 1.0}\nvalues[1]", "KeyError: 1", "the key is a string, '1', and not 1."),
    ("values = {1: 1.0}\nvalues['1']", "KeyError: '1'", "the key is a number, 1, and not '1'."),
    (
        "'{x}'.format(y=1.0)",
        "KeyError: 'x'",
        "format( ) gets no value with the name x: write x=… in its ( ).",
    ),
    (
        "open('data.csv')",
        "FileNotFoundError: [Errno 2] No such file or directory: 'data.csv'",
        "a file name without a folder is looked up where the program was started, and in a "
        "notebook next to it: `os.listdir()` lists the files there.",
    ),
    (
        "values = {'a': 1, 'b': 2}\nfor key in values:\n    del values[key]",
        "RuntimeError: dictionary changed size during iteration",
        "the loop changes its own list: loop over a copy, as in `for item in list(items)`.",
    ),
    (
        "r, g, b = 'gray'",
        "ValueError: too many values to unpack (expected 3)",
        "the right side is the string 'gray', of which each letter is a value: write numbers.",
    ),
    (
        "GRAY = 'gray'\nr, g, b = GRAY",
        "ValueError: too many values to unpack (expected 3)",
        "the right side is the string 'gray', of which each letter is a value: write numbers.",
    ),
]
