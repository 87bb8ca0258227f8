"""Parameters of a node."""

# (program, last line of the error, hint below it)
PARAMETERS = [
    (
        "def limit(parameters):\n    raise ValueError('too fast')\n"
        "node.declare_parameter('speed', 1.0)\nnode.add_on_set_parameters_callback(limit)\n"
        "node.set_parameters([rclpy.parameter.Parameter('speed', value=2.0)])",
        "ValueError: too fast",
        "an exception in this callback ends the node. To reject the value, write `return "
        "SetParametersResult(successful=False, reason='too large')`.",
    ),
    (
        "Parameter('speed', value=1.0).value = 2.0",
        "AttributeError: property 'value' of 'Parameter' object has no setter",
        "accept or reject the new value in the callback; elsewhere call self.set_parameters([…]).",
    ),
    (
        "node.declare_parameter('speed', 1)\nnode.declare_parameter('speed', 2)",
        "rclpy.exceptions.ParameterAlreadyDeclaredException: Parameter(s) already declared: ['speed']",
        "declare it once, in __init__; set_parameters changes it.",
    ),
    (
        "node.get_parameter('speed')",
        "rclpy.exceptions.ParameterNotDeclaredException: Invalid access to undeclared parameter(s): speed",
        "declare speed first, with a default value: `self.declare_parameter('a_name', 1.0)`.",
    ),
    (
        "node.set_parameters([Parameter('speed', value=1)])",
        "rclpy.exceptions.ParameterNotDeclaredException: Invalid access to undeclared parameter(s): []",
        "declare it first: `self.declare_parameter('a_name', 1.0)`.",
    ),
    (
        "node.declare_parameter('speed', 1.0)\nprint(node.get_parameter('speed') * 2)",
        "TypeError: unsupported operand type(s) for *: 'Parameter' and 'int'",
        "read its value: `self.get_parameter('a_name').value`.",
    ),
    (
        "node.declare_parameter('speed', {'max': 1.0})",
        "TypeError: The given value is not one of the allowed types '{'max': 1.0}'.",
        "use bool, int, float, str, or lists of them.",
    ),
    (
        "node.declare_parameter('speeds', [1, 'fast'])",
        "TypeError: The given value is not a list of one of the allowed types '[1, 'fast']'.",
        "use bool, int, float, str, or lists of them.",
    ),
    (
        "node.add_on_set_parameters_callback(lambda parameters: None)\nnode.declare_parameter('speed', 1.0)",
        "rclpy.exceptions.InvalidParameterValueException: Invalid parameter value (1.0) for "
        "parameter. Reason: Callback returned an invalid type: speed",
        "end the callback with `return SetParametersResult(successful=True)`.",
    ),
    (
        "node.declare_parameter('speed', Parameter.Type.DOUBLE)\nnode.get_parameter('speed').value",
        "rclpy.exceptions.ParameterUninitializedException: The parameter 'speed' is not initialized: speed",
        "declare it with a default value, or set it before.",
    ),
    (
        "node.declare_parameter('speed', 1)\nnode.set_parameters([('speed', 2)])",
        "TypeError: parameter must be instance of type '<class 'rclpy.parameter.Parameter'>'",
        "pass parameters: `self.set_parameters([Parameter('gain', value=2.0)])`, with rclpy's Parameter.",
    ),
    (
        "node.declare_parameter('speed', 1.0)\nnode.get_parameter('speed').get_parameter_value() + 1",
        "TypeError: unsupported operand type(s) for +: 'ParameterValue' and 'int'",
        "a ParameterValue can hold any type. The value itself is `self.get_parameter('known').value`.",
    ),
    (
        "node.declare_parameter('frame', 'map')\nPoseStamped().header.frame_id = node.get_parameter('frame')",
        "AssertionError: The 'frame_id' field must be of type 'str'",
        "this is a parameter: read its value, `self.get_parameter('a_name').value`.",
    ),
    (
        "node.declare_parameter('frame', 'map')\n"
        "value = node.get_parameter('frame').get_parameter_value()\n"
        "PoseStamped().header.frame_id = value",
        "AssertionError: The 'frame_id' field must be of type 'str'",
        "a ParameterValue can hold any type. The value itself is `self.get_parameter('a_name').value`.",
    ),
    (
        "node.declare_parameter('gain', 1.0)\n"
        "def change(name, value): ...\n"
        "node.add_on_set_parameters_callback(change)\n"
        "node.set_parameters([Parameter('gain', value=2.0)])",
        "TypeError: change() missing 1 required positional argument: 'value'",
        "the callback gets a list of parameters: write `def change(self, parameters)`.",
    ),
    (
        "node.declare_parameter('gain', 1.0)\n"
        "def change(parameters):\n"
        "    node.set_parameters(parameters)\n"
        "node.add_on_set_parameters_callback(change)\n"
        "node.set_parameters([Parameter('gain', value=2.0)])",
        "RecursionError: maximum recursion depth exceeded",
        "set_parameters calls this callback again: leave it out. The parameter has its new value "
        "when the callback has returned `SetParametersResult(successful=True)`.",
    ),
    (
        "node.declare_parameters('', ['speed', 'frame_id'])",
        "TypeError: Invalid parameter tuple length at index 0 in parameters list: speed; "
        "expecting length "
        "between 1 and 3",
        "each parameter is a pair: `self.declare_parameters('', [('speed', 1.0), ('frame_id', 'map')])`.",
    ),
    (
        "from rcl_interfaces.msg import Parameter\nParameter.Type.DOUBLE",
        "AttributeError: type object 'Parameter' has no attribute 'Type'",
        "this is the message Parameter of rcl_interfaces. The class for nodes is another one: "
        "`from rclpy.parameter import Parameter`.",
    ),
    (
        "from rcl_interfaces.msg import Parameter\nParameter('speed', value=2.0)",
        "TypeError: Parameter.__init__() takes 1 positional argument but 2 were given",
        "this is the message Parameter of rcl_interfaces. The class for nodes is another one: "
        "`from rclpy.parameter import Parameter`.",
    ),
    (
        "node.declare_parameter('speed', 1.0)\nnode.set_parameters(Parameter('speed', value=2.0))",
        "TypeError: 'Parameter' object is not iterable",
        "this is a single parameter, and set_parameters takes a list: `self.set_parameters([parameter])`.",
    ),
    (
        "Parameter('speed', 2.0)",
        "TypeError: type must be an instance of '<enum 'Type'>'",
        "pass the value by its name: `Parameter('speed', value=2.0)`.",
    ),
    (
        "Parameter('speed', Parameter.Type.DOUBLE, 2)",
        "ValueError: Type 'Type.DOUBLE' and value '2' do not agree",
        "the value is not of type DOUBLE, and a double has a point. Without the type, the value "
        "decides: `Parameter('speed', value=2.0)`.",
    ),
    (
        "node.add_on_set_parameters_callback(print())",
        "TypeError: ('Callback must be callable, got {}', <class 'NoneType'>)",
        "pass the function itself, without ( ): `self.add_on_set_parameters_callback(f)`.",
    ),
    (
        "node.declare_parameter(1.0, 'speed')",
        "TypeError: First element 1.0 at index 0 in parameters list is not a str.",
        "the name comes first, then the default value: `self.declare_parameter('a_name', 1.0)`.",
    ),
    (
        "node.declare_parameter('period', 1.0)\nnode.create_timer(node.get_parameter('period'), print)",
        "TypeError: float() argument must be a string or a real number, not 'Parameter'",
        "the period is a parameter: read its value, `self.get_parameter('a_name').value`.",
    ),
    (
        "print(node.declare_parameter('speed', 1.0).value())",
        "TypeError: 'float' object is not callable",
        ".value is a value and not a function: leave out its ( ).",
    ),
]
