"""Slips in code that raise no error."""

import pytest

from course_lib.grading.kept_state import find_growing_list
from course_lib.grading.node_slips import find_slip
from course_lib.grading.slips import find_hidden_error
from tests.notebooks.graded import WEEKS, cells_of, solution

NODE = """class Lamp(Node):
    def __init__(self):
        super().__init__("lamp")
        self.angle = 0.0

    def tick(self):
        {lines}
"""


def method(*lines: str) -> str:
    return NODE.format(lines="\n        ".join(lines))


SLIPS = [
    (("np.dot(place, turn)", "return place"), '"np.dot(place, turn)" has a result'),
    (
        ("angle = 360 * 0.25 * time", "x = math.sin(angle)", "return x"),
        '"math.sin(angle)": sin takes radians, and angle is in degrees',
    ),
    (("return math.cos(360 * t / 8)",), '"math.cos(360 * t / 8)": cos takes radians: a full turn'),
    (
        ("return math.radians(math.pi * t)",),
        '"math.radians(math.pi * t)": an angle with pi is in radians already',
    ),
    (("return np.round([x, y], 1)",), '"np.round([x, y], 1)" leaves out digits'),
    (
        ("self.timer = self.create_timer(int(1 / rate), self.tick)",),
        '"int(1 / rate)" makes a period below 1 s 0: leave out int( )',
    ),
    (("return int(stamp * 1000)",), '"int(stamp * 1000)" cuts 99.7 off to 99: round( )'),
    (
        (
            "p[0] = math.cos(a) * p[0] - math.sin(a) * p[1]",
            "p[1] = math.sin(a) * p[0] + math.cos(a) * p[1]",
        ),
        '"p[1] = math.sin(a) * p[0] + math.cos(a) * p[1]" reads p[0], which is rotated',
    ),
    (
        (
            "c, s = 1, 2",
            "c = math.cos(a)",
            "s = math.sin(a)",
            "x = c * x - s * y",
            "y = s * x + c * y",
        ),
        '"y = s * x + c * y" reads x, which is rotated already',
    ),
    (
        ("for kind, topic in topics.items():", "    viewer.add(kind, topic)"),
        "topics.items() gives the key first, a topic, and then its value",
    ),
    (
        ("for topic, kind in enumerate(topics):", "    viewer.add(kind, topic)"),
        "enumerate(topics) gives a number and then an item, so that topic is 0, 1, …",
    ),
    (("return kind in 'LaserScan'",), "\"kind in 'LaserScan'\" looks for a part"),
    (("return kind.lstrip('rviz/')",), "lstrip('rviz/') removes each of these letters"),
    (("return f'{score:.2}'",), ":.2 counts all digits: .2f has 2 after the point"),
    (
        ("return str(round(score, 2))",),
        '"str(round(score, 2))" leaves out zeros at the end: write {score:.2f}',
    ),
    (
        ("if self.p.get_subscription_count() > 0:", "    self.p.publish(text)"),
        '"if self.p.get_subscription_count() > 0" waits for a subscription',
    ),
    (
        ("return not parameter.value in range(1, 61)",),
        '"parameter.value in range(1, 61)": a range has whole numbers only',
    ),
    (
        ("return place[:3, :3] @ tip",),
        "place[:3, :3] is only the rotation: add the translation, place[:3, 3]",
    ),
    (
        ("beams = [(d, i) for i, d in enumerate(ranges)]", "return min(beams, key=lambda b: b[1])"),
        '"min(beams, key=lambda b: b[1])" compares i, the index in the list',
    ),
    (
        ("if detection.id in self.before:", "    return", "self.before[int(detection.id)] = 1"),
        "self.before has keys like int(detection.id), and is asked for detection.id",
    ),
    (
        ("lifts = {1.5: 1, own: 5}", "if self.seconds in lifts:", "    print(lifts)"),
        "self.seconds in lifts looks among the keys, which are 1.5 and own here",
    ),
    (("for item in items:", "    continue", "    print(item)"), '"print(item)" comes after "continue"'),
    (
        ("if x != math.nan:", "    return 1"),
        '"x != math.nan" is always true. Use math.isnan(x)',
    ),
    (
        ("place = np.zeros((4, 4))", "place = place @ turn", "return place"),
        '"place = np.zeros((4, 4))": a product that begins with 0 stays 0. Begin with np.eye',
    ),
    (
        ("names = ['pan']", "names += 'lift'", "return names"),
        "\"names += 'lift'\" adds each letter of the string as an item: write names.append('lift')",
    ),
    (
        ("for turn in turns:", "    place = np.eye(4)", "    place = place @ turn", "return place"),
        '"place = np.eye(4)" in the loop runs for each item: move it before the loop',
    ),
    (
        ("self.timer.timer_period_ns = 1 / rate",),
        '"self.timer.timer_period_ns = 1 / rate": in nanoseconds this is int((1 / rate) * 1e9)',
    ),
    (
        ("q.w, q.x, q.y, q.z = quaternion_from_euler(0, 0, yaw)",),
        '"q.w, q.x, q.y, q.z = quaternion_from_euler(0, 0, yaw)": the order of ROS is x, y, z, w',
    ),
    (
        ("marker.pose.orientation.z = yaw",),
        '"marker.pose.orientation.z = yaw": a quaternion has no angle in z. A turn by yaw about z is',
    ),
    (
        ("marker.pose.orientation.z = math.sin(yaw) / 2",),
        '"marker.pose.orientation.z = math.sin(yaw) / 2" divides the sin by 2',
    ),
    (
        ("x = math.sin(degrees / 2)", "return x"),
        '"math.sin(degrees / 2)": sin takes radians, and degrees is in',
    ),
    (
        ("yaw = math.degrees(heading)", "x = math.cos(yaw)", "return x"),
        '"math.cos(yaw)": cos takes radians, and yaw is in degrees',
    ),
    (
        ("marker.header.frame_id = 'm\u0430p'",),
        "the letter \u0430 in m\u0430p is Cyrillic and only looks like a Latin",
    ),
    (("self.tick = 1",), '"self.tick = 1" replaces the method tick, which cannot be called any more'),
    (("return SetParametersResult()",), "SetParametersResult() rejects the values, without a reason"),
    (("period = 1 // self.rate", "return period"), '"1 // self.rate" is 0 for every number above 1'),
    (
        ("if self.name is 'map':", "    return 1"),
        "\"self.name is 'map'\" tests whether both are the same object: compare",
    ),
    (("rclpy.spin_once(self)", "return 1"), '"rclpy.spin_once" in tick waits for callbacks'),
    (("count = 0", "++count", "print(count)"), '"++count" changes nothing: write count += 1'),
    (("marker.color.a == 0.8",), '"marker.color.a == 0.8" compares and changes nothing'),
    (("self.paint",), '"self.paint" does not call paint'),
    (("self.angle =+ 0.1",), "=+ sets self.angle to the value on the right"),
    (("items = items.append(1)",), "append() changes items and returns None"),
    (
        ("marker = Marker(id=1)", "marker.ns = 'a'", "marker = Marker()", "self.p.publish(marker)"),
        '"marker = Marker()" creates a second Marker',
    ),
    (
        ("marker = Marker()", "self.p.publish(marker)", "marker.id = 1"),
        '"marker.id = 1" comes after "self.p.publish(marker)"',
    ),
    (
        ("for item in items:", "    print(item)", "    return"),
        "return ends the loop of tick after its first item",
    ),
    (
        ("for item in items:", "    marker = Marker()", "self.p.publish(marker)"),
        '"self.p.publish(marker)" is after the loop',
    ),
    (
        ("for item in items:", "    found = []", "    found.append(item)", "return found"),
        '"found = []" in the loop empties the list',
    ),
    (
        ("marker = Marker()", "for item in items:", "    marker.id = item", "    found.append(marker)"),
        "marker is a single Marker, created before the loop",
    ),
    (
        ("for item in items:", "    if item > 1:", "        items.remove(item)"),
        '"items.remove(item)" changes items during the loop over it',
    ),
    (
        ("def walk(folder):", "    found = []", "    walk(folder[0])", "    return found", "return walk(1)"),
        '"walk(folder[0])" returns a list that is not used: write found.extend(walk(folder[0]))',
    ),
    (("sorted(items)", "return items"), '"sorted(items)" returns a value and changes nothing'),
    (
        ("text.replace('a', 'b')", "return text"),
        "\"text.replace('a', 'b')\" returns a value and",
    ),
    (("time.sleep(1.0)", "self.p.publish(marker)"), "time.sleep in tick stops the whole node"),
    (("return 1", "self.angle = 2.0"), '"self.angle = 2.0" comes after "return 1" and never runs'),
    (("angle = self.angle + 0.1",), "angle = … in tick sets a local variable, which is lost at the end"),
    (("share = (self.count - 1) // (b - a)", "return share"), '"(self.count - 1) // (b - a)" leaves out'),
    (("self.create_timer(1.0, lambda: self.tick)",), '"lambda: self.tick" does not call tick'),
    (("rate = 5", 'return """\na: {rate}\n"""'), "the string '{rate}' has names in { }"),
    (
        ("viewer.save_rviz('a.rviz')", "return Path('b.rviz').read_text()"),
        "The layout is saved as a.rviz, but the text is read from b.rviz",
    ),
    (
        ("while not self.buffer.can_transform('map', 'base', Time()):", "    pass", "return 1"),
        "\"while not self.buffer.can_transform('map', 'base', Time())\" in tick waits for messages",
    ),
    (
        ("threading.Timer(1.0, self.paint).start()",),
        '"threading.Timer(1.0, self.paint)" calls its function once',
    ),
    (
        ("return self.buffer.lookup_transform('map', 'base', self.get_clock().now())",),
        "self.get_clock().now() in lookup_transform is later than the last transform",
    ),
    (("place @ matrix", "return place"), '"place @ matrix" computes a value that is not used'),
    (
        ("while rclpy.ok():", "    self.p.publish(marker)", "    rate.sleep()"),
        '"while rclpy.ok()" in tick never ends, so that no callback of the node is called',
    ),
    (("while True:", "    self.paint()"), '"while True" in tick never ends'),
    (("u = round(self.t / 2)", "return u"), "round( ) leaves out the fraction of u"),
    (("t = int(self.steps * 0.02)", "return t"), "int( ) leaves out the fraction of t"),
    (
        ("before, self.agnle = self.angle, 1.0", "return before"),
        "self.agnle is set and never read, and self.angle is read and never set outside of __init__",
    ),
    (("return np.matmul(a, b, c)",), "np.matmul multiplies two matrices; the third is where"),
    (("marker.text = '{found.score:.2f} m'",), "the string '{found.score:.2f} m' has names in { }"),
    (("max(charge, 0.0)", "return charge"), '"max(charge, 0.0)" returns a value and changes nothing'),
    (("self.poses[-9:]", "return self.poses"), '"self.poses[-9:]" computes a value that is not used'),
    (("for item in items:", "    use(item)", "    break"), "break ends the loop of tick after its first"),
    (
        ("for x, y in items:", "    columns, rows = [], []", "    rows.append(y)", "return min(columns)"),
        '"columns = []" in the loop empties the list',
    ),
    (
        ("a = b = []", "a.append(1)", "b.append(2)", "return a, b"),
        '"a = b = []" creates one list with 2 names. Write a, b = [], [].',
    ),
    (
        ("viewer.save_rviz('a.rviz')", "viewer.view = Orbit()", "return viewer"),
        '"viewer.view = Orbit()" comes after "viewer.save_rviz(\'a.rviz\')"',
    ),
    (("if x < 1 and x > 60:", "    return"), '"x < 1 and x > 60" is never true: x cannot be both'),
    (("if x > 1 or x < 60:", "    return"), '"x > 1 or x < 60" is true for every number'),
    (("if 60.0 <= x <= 1.0:", "    return"), '"60.0 <= x <= 1.0" is never true, because 60.0 is more'),
    (
        ("if kind == 'Path' or 'Map':", "    return"),
        "\"kind == 'Path' or 'Map'\" is always true, because 'Map' alone is",
    ),
    (
        ("status = DiagnosticStatus()", "self.level = DiagnosticStatus.OK", "self.p.publish(status)"),
        "self.level = … sets an attribute of the node that nothing reads: is status.level meant?",
    ),
    (
        ("marker = Marker()", "marker.pose.position.z = 0.5", "marker.pose = Pose()"),
        '"marker.pose = Pose()" replaces the whole pose, and with it what "marker.pose.position.z',
    ),
    (
        ("color = ColorRGBA()", "for x in items:", "    color.r = x", "    marker.color = color"),
        "color is a single ColorRGBA, created before the loop: the color of each item is this object",
    ),
    (
        ("color = ColorRGBA()", "for x in items:", "    color.r = x", "    a.append(Marker(color=color))"),
        "color is a single ColorRGBA, created before the loop",
    ),
    (
        ("for angle in degrees:", "    angle = math.radians(angle)", "return degrees"),
        '"angle = math.radians(angle)" sets the variable of the loop, and degrees stays as it is. '
        "Write degrees = [math.radians(angle) for angle in degrees].",
    ),
    (("steps = 0", "paint(steps)", "steps += 1"), '"steps += 1" changes a local variable of tick'),
    (
        ("self.angle = 0.0", "paint(self.angle)", "self.angle += 0.1"),
        '"self.angle = 0.0" in tick runs in each call',
    ),
    (
        ("self.angle = None", "before, self.angle = self.angle, 1.0", "return before"),
        '"self.angle = None" in tick runs in each call',
    ),
    (("self.client.wait_for_service()",), '"self.client.wait_for_service()" in tick stops the whole node'),
    (
        ("p = np.array([0, 0, 0])", "p[1] = 0.5 * x", "return p"),
        "p has whole numbers only, because of np.array([0, 0, 0]), and cuts off fractions",
    ),
    (
        ("p = np.zeros(3, dtype=int)", "p[0], p[1] = 0.5 * x, y", "return p"),
        "p has whole numbers only, because of np.zeros(3, dtype=int)",
    ),
    (("return np.radians(x).astype(int)",), '"np.radians(x).astype(int)" cuts off the fraction'),
    (("r = np.array(message.ranges, dtype=int)", "return r"), '"np.array(message.ranges, dtype=int)" cuts'),
    (
        ("time = self.get_clock().now().nanoseconds", "return 2 * math.pi * time"),
        "time counts nanoseconds: / 1e9 converts it to seconds.",
    ),
    (
        ("time = self.get_clock().now().to_msg().sec", "return 2 * math.pi * time"),
        '"self.get_clock().now().to_msg().sec" has no fraction of a second: add the nanoseconds / 1e9',
    ),
    (
        ("time = self.get_clock().now()", "return time.seconds_nanoseconds()[0] - 5"),
        '"time.seconds_nanoseconds()[0]" has no fraction of a second',
    ),
    (
        ("return stamp.sec + stamp.nanosec",),
        '"stamp.sec + stamp.nanosec" is not a number of seconds: nanosec counts billionths, so write '
        "stamp.sec + stamp.nanosec / 1e9.",
    ),
    (
        ("good = [d for d in ranges if d > low]", "return good.index(min(good)) * scan.angle_increment"),
        '"good.index(min(good))" is an index in good, the selected beams',
    ),
    (
        ("r = r[r > low]", "return np.argmin(r) * scan.angle_increment"),
        '"np.argmin(r)" is an index in r, the selected beams',
    ),
    (
        ("t = self.get_clock().now().nanoseconds / 1e9", "if t > 5.0:", "    return t"),
        't counts from 1970 and is never as small as in "t > 5.0"',
    ),
    (
        ("lifts = {1: 1.5, 5: 2.0}", "t = int(time.time())", "if t in lifts:", "    return lifts[t]"),
        't counts from 1970 and is never as small as in "t in lifts"',
    ),
    (
        ("if x < 25:", "    return 1", "if x < 10:", "    return 2", "return 3"),
        '"x < 10" is never true here, because "x < 25" before it already returns',
    ),
    (
        ("for one in parameters:", "    if one == 'rate':", "        return one.value"),
        "\"one == 'rate'\" is never true: one is a Parameter, and its name is one.name",
    ),
]
RIGHT = [
    ("viewer.save_rviz('a.rviz')", "return Path('a.rviz').read_text()"),
    ("while True:", "    if self.paint():", "        break"),
    ("n = int(self.width / 0.1)", "return range(n)"),
    ("key = round(stamp * 1000)", "return key"),
    ("marker = Marker(id=number // 2)", "return marker"),
    ("stamp.sec = self.now // 10**9", "return stamp"),
    ("self.timer = 1", "return self.angle"),
    ("self.angles = [self.angle]", "self.angle = self.angles[0]"),
    ("row = index // width", "return image[row]"),
    ("return range(count // 2)",),
    ("half = items[: len(items) // 2]", "return half"),
    ("self.create_timer(1.0, lambda: self.tick())",),
    ('return """\nprint(f\'{rate}\')\n"""',),
    ("marker = Marker()", "marker.id = 1", "self.p.publish(marker)", "marker = Marker()", "marker.id = 2"),
    ("marker = Marker()", "self.p.publish(marker)", "marker.id = 1", "self.p.publish(marker)"),
    ("for item in items:", "    if item:", "        return item"),
    ("for item in items:", "    if item > 1:", "        items.remove(item)", "        break"),
    ("for item in list(items):", "    items.remove(item)"),
    ("def walk(folder):", "    found = []", "    found += walk(folder[0])", "    return found"),
    ("def walk(folder, found):", "    found = found or []", "    walk(folder[0], found)", "    return found"),
    ("marker = Marker()", "for _ in items:", "    marker = Marker()", "    found.append(marker)"),
    ("found = [Marker(id=n) for n in items]", "return [found[0] for n in range(3)]"),
    ("for n in range(3):", "    self.create_timer(1.0, lambda n=n: self.lamp(n))"),
    ("for n in items:", "    found.append(sorted(items, key=lambda item: item[n]))"),
    ("self.create_timer(1.0, partial(self.lamp, 1))",),
    ("marker = Marker()", "for item in items:", "    marker.points.append(item)", "found.append(marker)"),
    ("found = sorted(items)", "return found"),
    ("marker = Marker()", "for item in items:", "    marker.id += 1", "self.p.publish(marker)"),
    ("angle = self.angle + 0.1", "self.angle = angle"),
    ("text = '{found} m'.format(found=1)", "return text"),
    ("text = f'{self.angle:.2f} m'", "return text"),
    ("x = -1.0", "return x"),
    ("while not self.lines.empty():", "    self.lines.get()"),
    ("return self.buffer.lookup_transform('map', 'base', self.get_clock().now(), timeout)",),
    ("return self.buffer.lookup_transform('map', 'base', message.header.stamp)",),
    ("return np.matmul(a, b)",),
    ("charge = max(charge, 0.0)", "return charge"),
    ("for item in items:", "    if item:", "        break"),
    ("columns, rows = [], []", "for x, y in items:", "    rows.append(y)", "return min(columns)"),
    ("a = b = 0.0", "a += 1", "b += 2", "return a, b"),
    ("viewer.view = Orbit()", "viewer.save_rviz('a.rviz')", "return viewer"),
    ("viewer.save_rviz('a.rviz')", "viewer.view = Orbit()", "viewer.save_rviz('b.rviz')"),
    ("if x < 1 or x > 60:", "    return"),
    ("if x > 1 and x < 60:", "    return"),
    ("if x >= 1 and x <= 1:", "    return"),
    ("if 1.0 <= x <= 60.0:", "    return"),
    ("if kind == 'Path' or kind == 'Map':", "    return"),
    ("name = kind or 'Map'", "return name"),
    ("status = DiagnosticStatus()", "self.last = status", "self.p.publish(status)"),
    ("marker = Marker()", "marker.pose = Pose()", "marker.pose.position.z = 0.5"),
    (
        "pose = marker.pose",
        "marker.pose.position.z = 0.5",
        "marker.pose = Pose(position=marker.pose.position)",
    ),
    ("marker.pose.position.z = 0.5", "self.p.publish(marker)", "marker.pose = Pose()"),
    ("marker.pose.position.z = 0.5", "marker = Marker()", "marker.pose = Pose()"),
    ("color = ColorRGBA(r=1.0)", "for _ in items:", "    marker.color = color"),
    (
        "color = ColorRGBA()",
        "for x in items:",
        "    color.r = x",
        "    marker.color = color",
        "    self.p.publish(marker)",
    ),
    ("for angle in degrees:", "    angle = math.radians(angle)", "    found.append(angle)"),
    ("for angle in degrees:", "    angle = math.radians(angle)", "return angle"),
    ("steps = 0", "steps += 1", "return steps"),
    ("global steps", "paint(steps)", "steps += 1"),
    ("self.angle = 0.0", "for x in items:", "    self.angle += x"),
    ("self.angle += 0.1", "paint(self.angle)", "self.angle = 0.0"),
    ("self.client.wait_for_service(1.0)",),
    ("p = np.array([0.0, 0, 0])", "p[1] = 0.5 * x", "return p"),
    ("p = np.array([a, 0])", "p[1] = 0.5 * x", "return p"),
    ("p = np.zeros(3)", "p[0] = 0.5 * x", "return p"),
    ("p = np.zeros(3, dtype=int)", "p[0] = len(x)", "return p"),
    ("cells = (points / 0.1).astype(int)", "return image[cells]"),
    ("image = (255 * x).astype(np.uint8)", "return image"),
    ("time = self.get_clock().now().nanoseconds / 1e9", "return 2 * math.pi * time"),
    ("return Duration(nanoseconds=start.nanoseconds)",),
    ("return stamp.sec + stamp.nanosec * 1e-9",),
    ("seconds, fraction = stamp.sec, stamp.nanosec / 1e9", "return seconds + fraction"),
    (
        "if stamp.sec == 0:",
        "    return",
    ),
    ("point.time_from_start.sec = 3", "return point"),
    ("return stamp.sec * 10**9 + stamp.nanosec",),
    ("t = self.get_clock().now().nanoseconds / 1e9", "if t - self.start > 5.0:", "    return t"),
    ("t = self.get_clock().now().nanoseconds / 1e9", "if t > self.end:", "    return t"),
    ("if x < 10:", "    return 1", "if x < 25:", "    return 2", "return 3"),
    ("if x < 25:", "    y = 1", "if x < 10:", "    y = 2", "return y"),
    ("if x < 25:", "    return 1", "x = x - 20", "if x < 10:", "    return 2"),
    ("if x > 25:", "    return 1", "if x < 10:", "    return 2", "return 3"),
    ("good = [d for d in ranges if d > low]", "return ranges.index(min(good)) * scan.angle_increment"),
]


SLIPS += [
    (
        ("return math.sin(math.degrees(self.angle))",),
        '"math.sin(math.degrees(self.angle))": sin takes radians',
    ),
    (
        ("yaw = self.angle + 90", "return yaw"),
        '"self.angle + 90": angles are in radians here, and 90° is math.pi',
    ),
    (("return angle % 360.0",), '"angle % 360.0": angles are in radians here, and 360.0° is 2 * math.pi'),
    (("x = 1 / 3", "return round(x, 1), x"), '"round(x, 1)" leaves out digits: return the number itself'),
    (
        ("marker = Marker()", "lifetime = Duration(seconds=1.0)", "self.p.publish(marker)"),
        '"lifetime = Duration(seconds=1.0)" sets a variable that nothing reads: is marker.lifetime meant?',
    ),
    (
        ("place = np.eye(4)", "place = place * shifted(shift)", "return place"),
        '"place * shifted(shift)" multiplies item by item: @ multiplies matrices.',
    ),
    (
        ("place = np.eye(4)", "place = np.multiply(place, shift)", "return place"),
        "np.multiply multiplies item by item: write place @ shift.",
    ),
    (
        ("place = np.eye(4)", "place += shift @ turn", "return place"),
        '"place += shift @ turn" combines item by item',
    ),
    (
        ("for i in range(len(joints) - 1):", "    print(joints[i])"),
        '"range(len(joints) - 1)" leaves out the last item: the indices are range(len(joints)).',
    ),
    (
        ("self.poses.append(pose)", "if len(self.poses) > 9:", "    self.poses.pop()"),
        '"self.poses.pop()" removes the newest item: self.poses.pop(0) removes the oldest one.',
    ),
    (
        ("return self.buffer.can_transform('map', 'base', self.get_clock().now())",),
        "self.get_clock().now() in can_transform is later than the last transform",
    ),
    (("return SetParametersResult",), "SetParametersResult is the class: return a result"),
    (
        ("made = Viewer()", "viewer.add('TF')", "made.save_rviz('a.rviz')"),
        "\"viewer.add('TF')\" uses the viewer of another cell, and this function has its own one, made",
    ),
    (
        ("carried = self.buffer.transform(message, 'map')", "self.publisher.publish(message)"),
        "\"carried = self.buffer.transform(message, 'map')\" sets carried, which nothing reads afterwards.",
    ),
    (
        ("print('base_link', 'Base_link')",),
        "'base_link' and 'Base_link' are two names: ROS distinguishes upper and lower case.",
    ),
    (
        ("for lamp in lamps:", "    self.publish(self.marker)"),
        'The loop over "lamps" never uses lamp: should each pass do something with it?',
    ),
    (
        ("return [math.radians(lifts[0]) for angle in lifts]",),
        'The loop over "lifts" never uses angle',
    ),
    (
        ("for n in range(3):", "    self.create_timer(1.0, lambda: self.lamp(n))"),
        '"lambda: self.lamp(n)" reads n when it is called, after the loop',
    ),
    (
        ("self.p.publish(marker)", "self.p.publish(marker)"),
        '"self.p.publish(marker)" is there twice in a row: leave one of them out.',
    ),
    (("self.create_timer(0, self.lamp)",), '"self.create_timer(0, self.lamp)" has the period 0'),
    (
        ("self.create_timer(1.0, self.lamp())",),
        '"self.create_timer(1.0, self.lamp())" calls lamp now, and passes what it returns',
    ),
    (
        ("threading.Thread(target=self.paint).start()",),
        '"threading.Thread(target=self.paint)" calls its function once, by the wall clock.',
    ),
]


@pytest.mark.parametrize(("lines", "sentence"), SLIPS)
def test_slip_is_reported(lines: tuple[str, ...], sentence: str) -> None:
    assert find_slip(method(*lines)).startswith(sentence)


def test_parameter_that_a_function_never_reads_is_reported() -> None:
    source = "def place(joints, tip):\n    return joints[0]\n"
    assert find_slip(source) == "place never uses tip: does its result not depend on it?"
    assert find_slip(source.replace("tip", "_tip")) == ""


def test_parameter_replaced_by_a_fixed_value_is_reported() -> None:
    source = "def box(k, corners):\n    k = [277.0, 0.0]\n    return k[0] * corners\n"
    assert find_slip(source).startswith('"k = [277.0, 0.0]" replaces the k that box gets with each call')
    pair = source.replace("k = [277.0, 0.0]", "near, k = 0.1, [277.0]")
    assert find_slip(pair).startswith('"near, k = (0.1, [277.0])" replaces the k that box gets')
    assert find_slip(source.replace("[277.0, 0.0]", "k[:2]")) == ""
    assert find_slip(source.replace("    k =", "    if not k:\n        k =")) == ""


def test_callback_that_is_a_generator_is_reported() -> None:
    source = method("yield 1").replace("self.angle = 0.0", "self.create_timer(1.0, self.tick)")
    assert find_slip(source).startswith("yield makes tick a generator")
    assert find_slip(method("yield 1")) == ""


@pytest.mark.parametrize(
    ("handler", "is_hiding"),
    [
        (("except:", "return"), True),
        (("except Exception:", "pass"), True),
        (("except Exception as error:", "print(error)"), False),
        (("except TransformException:", "return"), False),
    ],
)
def test_empty_catch_all_handler_is_reported(handler: tuple[str, str], is_hiding: bool) -> None:
    head, body = handler
    sentence = find_hidden_error(method("try:", "    self.paint()", head, f"    {body}"))
    assert sentence.startswith(f'"{head}" also hides your own errors') == is_hiding


def test_list_in_the_body_of_a_class_is_reported_if_it_grows() -> None:
    source = method("self.markers += [Marker() for _ in items]", "self.p.publish(self.markers)")
    source = source.replace("self.angle = 0.0", "self.create_timer(1.0, self.tick)")
    source = source.replace("(Node):\n", "(Node):\n    markers = []\n\n")
    assert find_growing_list(source).startswith("self.markers keeps the items of each earlier call of tick")
    assert find_growing_list(source.replace("self.markers +=", "self.markers =")) == ""


GROWING = "self.markers.append(marker)"


@pytest.mark.parametrize(
    "line",
    [
        "self.markers = []",
        "self.markers.clear()",
        "del self.markers[:]",
        "self.markers = self.markers[-9:]",
        "if len(self.markers) > 9: self.markers.pop(0)",
        "markers = self.markers[-9:]",
    ],
)
def test_list_that_grows_with_each_call_of_a_callback_is_reported(line: str) -> None:
    creation = "self.markers = []; self.create_timer(1.0, self.tick)"
    source = method(GROWING, "self.p.publish(self.markers)").replace("self.angle = 0.0", creation)
    assert find_growing_list(source).startswith("self.markers keeps the items of each earlier call of tick")
    assert find_growing_list(method(line, GROWING).replace("self.angle = 0.0", creation)) == ""


@pytest.mark.parametrize(
    ("before", "lines", "items"),
    [
        ("", ("for x in found:", "    MARKERS.append(x)", "return MARKERS"), "MARKERS is outside of tick"),
        ("", ("MARKERS.extend(found)", "return MARKERS"), "MARKERS is outside of tick"),
        ("", ("found = MARKERS", "found += [1, 2]", "return found"), "MARKERS is outside of tick"),
        ("MARKERS = []", ("Lamp.MARKERS.extend(found)", "return 1"), "Lamp.MARKERS keeps the items of"),
        ("MARKERS = []", ("found = self.MARKERS", "found.extend(items)"), "self.MARKERS keeps the items of"),
        ("", ("m = self.marker", "m.points += [1, 2]"), "self.marker.points keeps the items of"),
        ("", ("MARKERS.append(1)", "return MARKERS[0]"), "MARKERS is outside of tick"),
        ("", ("MARKERS.append(1)", "return MARKERS"), ""),
        ("", ("self.found[x] = 1", "return self.found.values()"), "self.found keeps the entries of each"),
        ("", ("FOUND[x] = 1", "return list(FOUND.values())"), "FOUND keeps the entries of each earlier call"),
        ("", ("self.found[x] = 1", "return self.found[0]"), ""),
        ("", ("self.found = {}", "self.found[x] = 1", "return self.found.values()"), ""),
        ("", ("self.found.pop(y)", "self.found[x] = 1", "return self.found.values()"), ""),
        ("", ("found = {}", "found[x] = 1", "return found.values()"), ""),
        ("", ("while LAMPS:", "    lamp = LAMPS.pop(0)"), '"LAMPS.pop(0)" takes items out of LAMPS'),
        ("", ("LAMPS.append(x)", "lamp = LAMPS.pop(0)"), ""),
        ("", ("lamps = list(LAMPS)", "lamp = lamps.pop(0)"), ""),
        ("", ("MARKERS.clear()", "MARKERS.extend(found)"), ""),
        ("", ("MARKERS = []", "MARKERS.extend(found)"), ""),
        ("", ("found = []", "MARKERS = found", "MARKERS.extend(items)"), ""),
        ("", ("found = self.MARKERS", "found = []", "found.extend(items)"), ""),
    ],
)
def test_list_extended_by_several_items_in_each_call_is_reported_as_certain(
    before: str, lines: tuple[str, ...], items: str
) -> None:
    creation = "self.marker = Marker(id=1); self.create_timer(1.0, self.tick)"
    source = method(*lines).replace("self.angle = 0.0", creation)
    source = source.replace("(Node):\n", f"(Node):\n    {before}\n\n")
    slip = find_growing_list(source, is_certain=True)
    assert slip.startswith(items) if items else slip == ""


@pytest.mark.parametrize(
    ("lines", "sentence"),
    [
        ("    rows.append(x)\n    return rows", "rows is outside of table and keeps what each earlier call"),
        ("    memo[x] = 1\n    return memo", "memo is outside of table and keeps what each earlier call"),
        ("    def add():\n        rows.append(x)\n    add()\n    return rows", "rows is outside of table"),
        (
            "    global total\n    total += x\n    return total",
            "global keeps total between the calls of table",
        ),
        ("    global total\n    total = 0\n    total += x\n    return total", ""),
        ("    rows = []\n    rows.append(x)\n    return rows", ""),
        ("    rows.clear()\n    rows.append(x)\n    return rows", ""),
        ("    rows = []\n    def add():\n        rows.append(x)\n    add()\n    return rows", ""),
        ("    made = viewer.add(x)\n    return made", ""),
    ],
)
def test_value_that_a_function_keeps_between_calls_is_reported(lines: str, sentence: str) -> None:
    slip = find_growing_list(f"def table(x):\n{lines}\n", is_certain=True)
    assert slip.startswith(sentence) if sentence else slip == ""


def test_list_of_a_message_that_grows_is_reported() -> None:
    creation = "self.array = MarkerArray(); self.create_timer(1.0, self.tick)"
    lines = ("self.array.markers += [marker]", "self.p.publish(self.array)")
    source = method(*lines).replace("self.angle = 0.0", creation)
    assert find_growing_list(source).startswith("self.array.markers keeps the items")
    renewed = source.replace(
        "self.array.markers +=", "self.array = MarkerArray()\n        self.array.markers +="
    )
    assert find_growing_list(renewed) == ""


def test_mutated_default_argument_is_reported() -> None:
    source = "def collect(item, found=[]):\n    found.append(item)\n    return found\n"
    assert find_slip(source).startswith("the default found=[] is created once")
    assert find_slip("def collect(item, found=[]):\n    return [*found, item]\n") == ""


@pytest.mark.parametrize("lines", RIGHT)
def test_similar_code_without_a_slip_is_accepted(lines: tuple[str, ...]) -> None:
    assert find_slip(method(*lines)) == ""


@pytest.mark.parametrize("week", WEEKS)
def test_solution_has_no_slip(week: str) -> None:
    # The broken functions of the exercise are to be found by students.
    cells = [cell for cell in cells_of(solution(week)) if "def broken_" not in cell]
    assert [slip for cell in cells if (slip := find_slip(cell))] == []


@pytest.mark.parametrize("source", ["", "class A(", "x = 1\n" * 10, "def f():\n" + "    " * 200 + "pass"])
def test_code_that_is_not_python_has_no_slip(source: str) -> None:
    assert find_slip(source) == ""


@pytest.mark.parametrize(("call", "is_slip"), [("swing(angle, size)", True), ("swing(size, angle)", False)])
def test_arguments_in_another_order_than_the_parameters_are_reported(call: str, is_slip: bool) -> None:
    source = f"def move(size, angle):\n    return {call}\n\ndef swing(size, angle):\n    return size * angle"
    expected = f'"{call}" passes its values in another order than def swing(size, angle).' if is_slip else ""
    assert find_slip(source) == expected


def test_conversion_of_an_angle_in_radians_is_reported() -> None:
    source = "def turned(x, yaw):\n    yaw = math.radians(yaw)\n    return x * math.cos(yaw)\n"
    assert find_slip(source).startswith('"yaw = math.radians(yaw)": angles are in radians here')
