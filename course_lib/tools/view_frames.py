"""`ros2 run tf2_tools view_frames`: the tree of frames as a picture (geometry2, tf2_tools/view_frames.py)."""

import time
from argparse import Namespace
from base64 import b64encode
from collections.abc import Mapping
from html import escape
from io import BytesIO
from pathlib import Path
from typing import Any

from course_lib.ros import tf2_core
from course_lib.ros.graph import current_graph
from course_lib.tools.sources import Source
from course_lib.tools.tf2 import TransformStream, log_line
from course_lib.tools.verb import Verb, Write, seconds, value

_WIDTH, _HEIGHT = 2.3, 1.7  # [in] of a frame with what leads to it
_IMAGE = '<img style="max-width: 100%" alt="{}" src="data:image/svg+xml;base64,{}">'  # as wide as the cell
_LABELS = {
    "broadcaster": "Broadcaster",
    "rate": "Average rate",
    "buffer_length": "Buffer length",
    "most_recent_transform": "Most recent transform",
    "oldest_transform": "Oldest transform",
}


def _view_frames(source: Source, arguments: Namespace, write: Write) -> None:
    """Listen for a while, then draw the frames below the cell, or into a .gv and a .pdf file."""
    import yaml  # type: ignore[import-untyped]  # PyYAML ships no types

    stream, now_ns = TransformStream(source), current_graph().now_ns
    write(log_line("view_frames", now_ns, f"Listening to tf data for {arguments.wait_time} seconds..."))
    now_ns = max(stream.ticks(0.1, arguments.wait_time), default=now_ns)
    write(log_line("view_frames", now_ns, "Generating graph..."))
    text = tf2_core.as_yaml(stream.buffer)
    result = f"tf2_msgs.srv.FrameGraph_Response(frame_yaml={text!r})"
    write(log_line("view_frames", now_ns, f"Result:{result}"))
    frames: dict[str, Any] = yaml.safe_load(text) or {}
    if current_graph().notebook and source.live:
        from IPython.display import HTML, display

        tree = "; ".join(f"{frame} in {about['parent']}" for frame, about in frames.items())
        drawn = b64encode(picture(frames, now_ns, "svg")).decode()
        display(HTML(_IMAGE.format(escape(f"The tree of frames: {tree}"), drawn)))  # type: ignore[no-untyped-call]  # IPython does not annotate it
        return
    name = arguments.output or f"frames_{time.strftime('%Y-%m-%d_%H.%M.%S')}"
    write(log_line("view_frames", now_ns, f"Exporting graph in {name}.pdf file..."))
    Path(f"{name}.gv").write_text(dot(frames, now_ns), encoding="utf-8")
    Path(f"{name}.pdf").write_bytes(picture(frames, now_ns, "pdf"))


def dot(frames: Mapping[str, Any], now_ns: int) -> str:
    """Return the tree in graphviz's language, as view_frames writes it."""
    if not frames:
        return 'digraph G { "No tf data received" }'
    edges = "".join(
        f'"{about["parent"]}" -> "{frame}"[label=" {_label(about, end=chr(92) + "n")}"];\n'
        for frame, about in frames.items()
    )
    root = _roots(frames)[-1]
    return (
        f"digraph G {{\n{edges}edge [style=invis];\n"
        ' subgraph cluster_legend { style=bold; color=black; label ="view_frames Result";\n'
        f'"Recorded at time: {now_ns // 10**9 + now_ns % 10**9 / 1e9}"[ shape=plaintext ] ;\n'
        f'}}->"{root}";\n}}'
    )


def picture(frames: Mapping[str, Any], now_ns: int, kind: str) -> bytes:
    """Draw the tree as SVG or PDF; frames outside of a tree with a root are left out."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    places = _places(frames)
    wide = 1 + max((x for x, _ in places.values()), default=0)
    deep = 2 + max((depth for _, depth in places.values()), default=0)
    figure = Figure(figsize=(wide * _WIDTH, (deep - 0.8) * _HEIGHT))
    axes = figure.add_axes((0, 0, 1, 1), xlim=(-0.5, wide - 0.5), ylim=(deep - 0.6, 0.2))
    axes.axis("off")
    legend = f"view_frames Result\nRecorded at time: {now_ns / 1e9}"
    axes.text(-0.45, 0.3, legend if frames else "No tf data received", va="top", bbox={"fc": "white"})
    for frame, (x, depth) in places.items():
        about = frames.get(frame)
        if about:
            start, above = places[about["parent"]]
            corner = "angle,angleA=0,angleB=90"  # sideways, then down through the label
            arrow = {"arrowstyle": "-|>", "fc": "black", "shrinkB": 12, "connectionstyle": corner}
            axes.annotate("", (x, depth + 1), (start, above + 1), arrowprops=arrow)
            label, blank = _label(about, end="\n").rstrip(), {"fc": "white", "ec": "none", "pad": 1}
            axes.text(x, depth + 0.55, label, fontsize=8, ha="center", va="center", bbox=blank)
        axes.text(
            x, depth + 1, frame, ha="center", va="center", bbox={"fc": "white", "boxstyle": "round"}, zorder=4
        )
    file = BytesIO()
    with rc_context({"svg.hashsalt": "view_frames", "svg.fonttype": "none"}):
        figure.savefig(file, format=kind, metadata={"Date" if kind == "svg" else "CreationDate": None})
    return file.getvalue()


def _places(frames: Mapping[str, Any]) -> dict[str, tuple[float, int]]:
    """Return the column and the depth of each frame: leaves side by side, parents centred above."""
    places: dict[str, tuple[float, int]] = {}
    columns = iter(range(len(frames) + 1))

    def place(frame: str, depth: int) -> float:
        places[frame] = 0.0, depth  # in a loop it is its own descendant
        below = (name for name, about in frames.items() if about["parent"] == frame and name not in places)
        children = [place(name, depth + 1) for name in below]
        x = (children[0] + children[-1]) / 2 if children else float(next(columns))
        places[frame] = x, depth
        return x

    for root in _roots(frames):
        place(root, 0)
    return places


def _roots(frames: Mapping[str, Any]) -> list[str]:
    """List the frames without a parent; of frames in a loop, the first one's parent."""
    parents = [str(about["parent"]) for about in frames.values()]
    return list(dict.fromkeys(parent for parent in parents if parent not in frames)) or parents[:1]


def _label(about: Mapping[str, Any], end: str) -> str:
    return "".join(f"{title}: {about[name]}{end}" for name, title in _LABELS.items())


_OPTIONS = (
    value("-t", "--wait-time", type=seconds, default=5.0, help="Listen for this many seconds"),
    value("-o", "--output", help="Output filename"),
)
VIEW_FRAMES = Verb("run tf2_tools", "view_frames", "Draw the tree of frames", _OPTIONS, _view_frames)
