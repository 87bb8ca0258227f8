"""Mistakes with lists, tuples, dictionaries and arrays."""

# (program, last line of the error, hint below it)
SEQUENCES = [
    (
        "min[5, 3]",
        "TypeError: 'builtin_function_or_method' object is not subscriptable",
        "a function is called with ( ), not with [ ].",
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
        "limits = {'speed': 2.0}\nlimits.speed",
        "AttributeError: 'dict' object has no attribute 'speed'",
        'a value of a dictionary is selected by its key in [ ] and quotes: ["speed"].',
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
        "import numpy as np\nfloat(np.array([1.0, 2.0]))",
        "TypeError: only ",
        "one number is needed here, and this is an array: take one of its items, like [0].",
    ),
    (
        "(1.0, 2.0)[2]",
        "IndexError: tuple index out of range",
        "the index is beyond the end of the tuple: print len(…) of it first.",
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
        "lamps = ['red']\nfor number in range(lamps):\n    pass",
        "TypeError: 'list' object cannot be interpreted as an integer",
        "range takes a number: range(len(lamps)) gives the indices of lamps.",
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
        "import numpy as np\nnp.zeros(3, 4)",
        "TypeError: Cannot interpret '4' as a data type",
        "the shape is one value, in ( ) of its own: `np.zeros((3, 4))`.",
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
        "import numpy as np\nif np.zeros(3) < 1.0: ...",
        "ValueError: The truth value of an array with more than one element is ambiguous. Use "
        "a.any() or a.all()",
        "an array has many values: compare one of them, or use .any() or .all(). To test whether "
        "it is set, write is not None.",
    ),
    ("mine = {'amplitude': 0.5}\nmine['amplitud']", "KeyError: 'amplitud'", "did you mean 'amplitude'?"),
    (
        "{'z': 1.0}[0.5]",
        "KeyError: 0.5",
        "the dictionary has no such key: print its keys with list(…).",
    ),
    (
        "from tf2_ros import TransformListener\nTransformListener(Node('a'), Buffer())",
        "AttributeError: 'Buffer' object has no attribute 'create_subscription'",
        "the buffer comes first, then the node: `TransformListener(self.buffer, self)`.",
    ),
    (
        "[1.0].sort()[:2]",
        "TypeError: 'NoneType' object is not subscriptable",
        "sort(…) changes its object and returns None: call it on a line of its own, then use the object.",
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
        "x = f'{3.2.2f}'",
        "SyntaxError: invalid decimal literal",
        "in an f-string the format follows a colon: `f'{3.14159:.2f}'`.",
    ),
    (
        "import numpy as np\np = np.array([0, 0])\np += 0.5",
        "_UFuncOutputCastingError: Cannot cast ufunc 'add' output from dtype('float64') to "
        "dtype('int64') with casting rule 'same_kind'",
        "this array has whole numbers only: create it with decimal points, `np.array([0.0, 0.0])`, "
        "or "
        "dtype=float.",
    ),
    (
        "if ['LaserScan'] in 'LaserScan':\n    pass",
        "TypeError: 'in <string>' requires string as left operand, not list",
        "write the value first, then the list: `'map' in ['map', 'odom']`.",
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
        "np.interp takes two lists, x coordinates and their values: "
        "`np.interp(0.25, [0.0, 1.0], [3.0, 5.0])`.",
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
    ("values = {'1': 1.0}\nvalues[1]", "KeyError: 1", "the key is a string, '1', and not 1."),
    ("values = {1: 1.0}\nvalues['1']", "KeyError: '1'", "the key is a number, 1, and not '1'."),
    (
        "'{x}'.format(y=1.0)",
        "KeyError: 'x'",
        "format( ) gets no value with the name x: write x=… in its ( ).",
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
    (
        "import numpy as np\nnp.concatenate([1.0, 2.0], 1.0)",
        "TypeError: 'float' object cannot be interpreted as an integer",
        "concatenate takes the arrays in one list: `np.concatenate([[1.0], [2.0]])`.",
    ),
    (
        "import numpy as np\ntip = [1.0, 2.0, 3.0]\nnp.eye(4) @ tip.append(1.0)",
        "ValueError: matmul: Input operand 1 does not have enough dimensions (has 0, "
        "gufunc core with signature (n?,k),(k,m?)->(n?,m?) requires 1)",
        "append(…) changes its object and returns None: call it on a line of its own, then use the object.",
    ),
    (
        "poses, most = [1.0], 5\n[*poses, 2.0][-most]",
        "IndexError: list index out of range",
        "[-most] selects one item. The last most items are [-most:], with a colon.",
    ),
    (
        "import numpy as np\nnp.cross([1.0, 2.0, 3.0], 4.0)",
        "ValueError: At least one array has zero dimension",
        "a cross product takes two vectors of three numbers, and one value is a single number: print both.",
    ),
    (
        "poses = [1.0]\nposes = poses.append(2.0)[-5:]",
        "TypeError: 'NoneType' object is not subscriptable",
        "append(…) changes its object and returns None: call it on a line of its own, then use the object.",
    ),
]
