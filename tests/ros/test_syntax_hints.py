"""Hints for syntax errors and decimal commas: text from web pages, other keyboards, C++ and terminals."""

import ast
import linecache
import re

import pytest
from IPython.core.interactiveshell import InteractiveShell

from course_lib.ros.hints import hint
from course_lib.ros.syntax_hints import syntax_hint
from course_lib.tools.notebook import shorten_tracebacks

QUOTES = 'write straight quotes, like `"map"`. Web pages and word processors make curved ones.'
BLOCK = "a block begins with a colon, and its lines are indented: there are no { }."
LOOP = "`for i in range(3): print(i)` counts 0, 1, 2."
ITEMS = "`for item in items: print(item)` loops over a list: no ( ) around it, and the word is in."
FUNCTION = "a function begins with def and has no types: `def twice(x): return 2 * x`."
BASE = "the base class is in ( ): class Camera(Node): …."
COMMENT = "a comment begins with #."
NOT = "the operator ! is called not: `not (a == b)`."
LAMBDA = "a function in an expression is `lambda x: x + 1`."
# Code of a student, and the hint.
PROSE = "this line is text and not code: delete it, or begin it with # as a comment."
ZIP = "zip pairs the items of two lists: `[a * b for a, b in zip([1, 2], [3, 4])]`."
SYNTAX = [
    (
        "def area(width height):\n    pass",
        "the names in ( ) have commas between them: `def area(width, height): return width * height`.",
    ),
    (
        "$ ros2 topic list",
        "the $ is the prompt of a terminal: leave it out. In a cell a command of ROS begins with "
        "a percent sign, %ros2 ….",
    ),
    ("my-node = 3", "a name cannot contain -: if this is one name, write my_node."),
    ("a = \u201cmap\u201d", f"instead of \u201c {QUOTES}"),
    ("a = \u2018map\u2019", f"instead of \u2018 {QUOTES}"),
    ("a = \u20131.0", "instead of \u2013 write the minus sign of the keyboard, -."),
    ("a = 2 \u00d7 3", "instead of \u00d7 write *."),
    ("print\uff081\uff09", "instead of \uff08 write (, with the keyboard set to English."),
    ("a = 0\uff0e5", "instead of \uff0e write ., with the keyboard set to English."),
    ("a = \u2603", "the code cannot contain \u2603: delete it."),
    (
        "a =\u00a01",
        "the line has an invisible or unusual character, as in text from a web page: type the line again.",
    ),
    (
        "if 1:\n        a = 1\n\tb = 2",
        "indent with spaces only: delete the space in front of this line, and type 4 spaces for each level.",
    ),
    (
        "if 1:\n    a = 1\n   b = 2",
        "begin the line exactly below the first letter of the line above to which it belongs.",
    ),
    (
        "a = 1\n    b = 2",
        "the line begins with more spaces than the line before it, which does not end with a colon.",
    ),
    (
        "def f():\nreturn 1",
        "the lines of this block begin with 4 more spaces. A block without lines needs `pass`.",
    ),
    (
        "Point(x=0,5, y=1.0)",
        "a decimal number has a point, 0.5. With a comma, as in 0,5, these are two numbers.",
    ),
    ("f(x=1, 2)", ""),
    (
        "a = 1.0m",
        "a letter follows a number. A unit goes into a comment, `1.0  # [m]`; a product has a star, `2 * 3`.",
    ),
    ("a = 08", "write the number without zeros in front of it."),
    ("return 5", "the line is outside of the function: indent it as far as the function's other lines."),
    (
        "print('don't')",
        'the text ends at its second quote: put a text with an apostrophe into double quotes, `"don\'t"`.',
    ),
    ("a = 'map", "a quote is missing on this line, at the end of the text or in front of it."),
    ("```python\na = 1\n```", "delete the lines with ```: they mark code in a chat or on a web page."),
    ("if a:\n    b = 1\nelse if c:\n    b = 2", "`else if` is written elif."),
    ("import Marker from visualization_msgs.msg", "the module comes first: `from math import pi`."),
    ("// the next step", "a comment begins with #."),
    ("marker->pose = 1", "Python has a dot instead of ->, as in `marker.pose`."),
    ("a = Marker::CUBE", "Python has a dot instead of ::, as in `math.pi`."),
    ("a = new Marker()", "an object is created without new: Marker()."),
    ("float a = 1.0;", "a variable has no type in front of it: a = …."),
    ("if a && b:\n    c = 1", "the operators are called and, or, not."),
    ("a++", "to count, write `count += 1`."),
    (
        "if a > 3 {\n    b()\n}",
        "a block begins with a colon, and its lines are indented: there are no { }.",
    ),
    (
        "else:\n    a = 1",
        "else follows the lines of an if: it begins in the same column as this if, "
        "and nothing is between them.",
    ),
    (
        "a = 1\nros2 topic list",
        "in a cell this command begins with a percent sign: %ros2 …. In a file it is not possible.",
    ),
    (
        "course check week01_exercise.ipynb",
        "course is a command of a terminal: type it there (in JupyterLab: File → New → Terminal).",
    ),
    ("lambda = 0.5", "lambda is a keyword of Python: choose another name."),
    ("a = # later", "the value after = is missing."),
    (
        "a = b +",
        "the line ends with +: a value is missing. An expression in ( ) may continue on the next line.",
    ),
    (
        "if a = 3:\n    b = 1",
        "a comparison has two signs, ==; a value is set with one, on a line of its own.",
    ),
    # Habits of C, Java, JavaScript and Matlab.
    ("if a { b = 1 }", BLOCK),
    ("if (a == 1) { b = 1; }", BLOCK),
    ("while (i < 3) { i++; }", BLOCK),
    ("if a:\n    b = 1\n}", BLOCK),
    ("try {\n    a = 1\n} catch (e) {\n}", BLOCK),
    ("if a:\n    b = 1\nelseif c:\n    b = 2", "elseif is written elif."),
    ("if a:\n    b = 1\nelse a == 2:\n    b = 2", "else has no condition: with a condition it is elif."),
    ("for (int i = 0; i < 3; i++) {\n}", LOOP),
    ("for i = 1:3\n    print(i)", LOOP),
    ("for i in 0..3:\n    print(i)", LOOP),
    ("for (auto x : items) {\n}", ITEMS),
    ("foreach x in items:\n    print(x)", ITEMS),
    ("function f(x)\n    return x", FUNCTION),
    ("void f(x) {\n}", FUNCTION),
    ("public void f(self):\n    pass", FUNCTION),
    (
        "def f(float x):\n    return x",
        "the type of a parameter is after its name, or left out: `def twice(x: float): return 2 * x`.",
    ),
    ("def f:\n    pass", "a function has ( ), even without parameters: def tick(): …."),
    ("class A extends Node:\n    pass", BASE),
    ("switch (a) {\n}", "instead of switch and case write if, elif and else."),
    ("a = 1  // the first number", COMMENT),
    ("/* the next step */", COMMENT),
    ("a = 1 % the first number", COMMENT),
    ("This is the next step.", PROSE),
    ("Sure! Here is the corrected function:", PROSE),
    ("Copy the lines of side_view, and change them.", PROSE),
    ("It's the robot's arm", PROSE),
    ("def f():\n    f is empty: copy the lines of g, and change them.", PROSE),
    ("def f():\n    return red, green blue, alpha", ""),
    ("a = O.5", "this is a letter and not a digit: type the 0 or the 1 again."),
    ("a = 0·5", "a decimal number has a point, 0.5: instead of · write the point of the keyboard."),
    ("a = ½", "instead of ½ write 0.5, with the digits 0 to 9."),
    ("a = \u0665", "instead of \u0665 write 5, with the digits 0 to 9."),
    ("def f(a):\n    global a", "a parameter belongs to its function already: leave out the line."),
    (
        "def f():\n    nonlocal a",
        "nonlocal is for a function inside another one. A node keeps a value in an attribute, like "
        "self.count.",
    ),
    ("a = max(y - x for x, y in times, times[1:])", ZIP),
    ("a = [x + y for x, y in (b.x, b.y), c]", ZIP),
    ("std::cout << a", "`print(x)` writes a value."),
    ("throw new Error('a')", 'an exception is raised with `raise ValueError("too large")`.'),
    ("try:\n    a = 1\ncatch KeyError:\n    a = 2", "the word is except, as in except KeyError: …."),
    ("If a:\n    b = 1", "the keywords of Python are written in lower case."),
    ("Marker a = Marker()", "a variable has no type in front of it: a = …."),
    ("double[] a = {1.0}", "a variable has no type in front of it: a = …."),
    ("frame rate = 5.0", "a name cannot contain a space: if this is one name, write frame_rate."),
    ("if !a:\n    b = 1", NOT),
    ("a = !(b == 1)", NOT),
    ("if a ~= 1:\n    b = 1", "the operator is written !=."),
    ("if a === 1:\n    b = 1", "the operator is written ==."),
    ("if a =< 1:\n    b = 1", "the operator is written <=."),
    ("if a => 1:\n    b = 1", "the operator is written >=."),
    ("f = x => x + 1", LAMBDA),
    ("f = @(x) x + 1", LAMBDA),
    ("f = lambda x: return x", LAMBDA),
    ("a = b > 0 ? 1 : 2", "the condition is in the middle: `1 if x > 0 else 2`."),
    ("$a = 1", "the name of a variable has no $."),
    ("if a then\n    b = 1", "a condition ends with a colon, without then."),
    ("if (a > 3) b = 1", "a condition ends with a colon: `if x > 0: y = 1`."),
    ("a: = 3", "a value is set with =, without a colon."),
    ("node.create_publisher(Bool, /light, 10)", 'the name of a topic is in quotes: `"/robot/scan"`.'),
    ("a = [1, 2; 3, 4]", "a matrix is a list of lists: `[[1.0, 2.0], [3.0, 4.0]]`."),
    ("a = b .* c", "numpy's arrays need no dot: `a * b` multiplies each item."),
    ("a = {rate = 5.0}", 'write a dictionary with colons, and its keys in quotes: `{"rate": 5.0}`.'),
    ("Point(x: 1.0)", "an argument is passed with =, not with a colon: `Point(x=1.0)`."),
    ("a = 5 m", "a unit goes into a comment, `1.0  # [m]`; a product has a star, `2 * 3`."),
    ("a(1) = 3", "( ) calls a function. An item is in [ ], as in a[0], and the first one has the index 0."),
    # Python's own text is enough.
    ("a = (1, 2", ""),
    ("def f()\n    return 1", ""),
    ("print 'a'", ""),
    ('print(f"{a:.2f")', "a { in the f-string has no }: close it after the name, as in `f'{3.14159:.2f}'`."),
]


@pytest.mark.parametrize(("code", "expected"), SYNTAX)
def test_syntax_error_has_the_hint_for_its_cause(code: str, expected: str) -> None:
    with pytest.raises(SyntaxError) as raised:
        compile(code, "cell", "exec")
    assert syntax_hint(raised.value) == expected


@pytest.mark.parametrize(
    "code",
    ["def f():\n    a = 1\n   b = 2", "return 5", "a = \u201cmap\u201d", "if (a == 1) {\n    b = 1\n}"],
)
def test_cell_with_a_syntax_error_shows_the_hint(code: str, capsys: pytest.CaptureFixture[str]) -> None:
    shell = InteractiveShell()
    shorten_tracebacks(shell)
    shell.run_cell(code)
    assert capsys.readouterr().out.count("hint: ") == 1


@pytest.mark.parametrize(
    ("code", "expected"),
    [
        ("if (a == 1) {\n    b = 1\n}", BLOCK),
        ("do {\n    a = 1\n} while (a < 3)", BLOCK),
        ("class Camera : Node\n    pass", BASE),
        (
            "a = 1 + ...\n    2",
            "an expression continues on the next line inside ( ), without the dots.",
        ),
        ("a = {\n    rate = 5.0\n}", ""),
    ],
)
def test_line_before_the_syntax_error_gives_the_hint(code: str, expected: str) -> None:
    linecache.cache["cell of a student"] = (len(code), None, code.splitlines(keepends=True), "")
    with pytest.raises(SyntaxError) as raised:
        compile(code, "cell of a student", "exec")
    assert syntax_hint(raised.value) == expected


COMMA = "a decimal number has a point, 0.5. With a comma, as in {}, these are two numbers."


@pytest.mark.parametrize(
    ("code", "expected"),
    [
        ("import math; math.sin(0,5)", COMMA.format("0,5")),
        ("a = 1.0; a += 0,1", COMMA.format("0,1")),
        ("a, b = 0,4, 0,4", COMMA.format("0,4")),
        (
            "a, b = 1,0,0",
            "there are more values than names on the left: print the value on the right.",
        ),
    ],
)
def test_decimal_comma_in_a_failing_line_is_the_hint(code: str, expected: str) -> None:
    linecache.cache["cell of a student"] = (len(code), None, [code], "cell of a student")
    with pytest.raises((TypeError, ValueError)) as raised:
        exec(compile(code, "cell of a student", "exec"), {"__name__": "__main__"})
    assert hint(raised.value) == expected


RUN_FIRST = "run the cell above that defines Camera first, and see whether it ends with an error."


@pytest.mark.parametrize(
    ("code", "expected"),
    [
        ("end", "a block ends where its lines are no longer indented: delete end."),
        ("a = 2 // number", "if number is a comment, begin it with #: // divides."),
        ("check('week06.camera', Camera)", RUN_FIRST),
        ("run_live(Camera())", RUN_FIRST),
        ("spin_for(2.0, Camera())", RUN_FIRST),
        ("sorted([[1, 2]], key=row[1])", "key is a function of an item: write key=lambda row: row[1]."),
        (
            "def f():\n    values = {'speed': 1.0}\n    print(values, speed)\nf()",
            'it is a name in quotes: write "speed".',
        ),
    ],
)
def test_line_with_an_undefined_name_gives_the_hint(code: str, expected: str) -> None:
    lines = code.splitlines(keepends=True)
    linecache.cache["cell of a student"] = (len(code), None, lines, "cell of a student")
    names = dict.fromkeys(("check", "run_live", "spin_for"), print)
    with pytest.raises(NameError) as raised:
        exec(compile(code, "cell of a student", "exec"), {"__name__": "__main__", **names})
    assert hint(raised.value) == expected


def test_names_in_super_have_a_hint() -> None:
    code = (
        "class Base:\n    pass\nclass A(Base):\n    def __init__(self):\n"
        "        super(Base, self).__init__(1)\nA()"
    )
    linecache.cache["cell of a student"] = (len(code), None, code.splitlines(keepends=True), "")
    with pytest.raises(TypeError) as raised:
        exec(compile(code, "cell of a student", "exec"), {"__name__": "__main__"})
    assert hint(raised.value) == "write `super().__init__('a_name')`, with nothing in super( )."


def test_examples_in_backticks_are_valid_code() -> None:
    for _, text in SYNTAX:
        for snippet in re.findall(r"`([^`]+)`", text.replace("```", "")):
            if snippet != "else if":
                ast.parse(snippet)
