"""Small URDF robots."""

LIMIT = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'


def links(*names: str) -> str:
    return "".join(f'<link name="{name}"/>' for name in names)


def joint(name: str, parent: str, child: str, kind: str = "revolute", inner: str = LIMIT) -> str:
    ends = f'<parent link="{parent}"/><child link="{child}"/>'
    return f'<joint name="{name}" type="{kind}">{ends}{inner}</joint>'


def robot(*parts: str) -> str:
    return f'<robot name="small">{"".join(parts)}</robot>'


# Two links of 1 m and 0.5 m, turning about z.
ARM_2R = robot(
    links("base", "upper", "fore", "tip"),
    joint("shoulder", "base", "upper", inner=LIMIT + '<axis xyz="0 0 1"/>'),
    joint("elbow", "upper", "fore", inner=LIMIT + '<origin xyz="1 0 0"/><axis xyz="0 0 1"/>'),
    joint("tip_joint", "fore", "tip", "fixed", '<origin xyz="0.5 0 0"/>'),
)

# One joint of each kind; finger mimics lift, thumb mimics finger.
ALL_KINDS = robot(
    links("base", "wheel", "mast", "finger", "thumb", "plate", "balloon", "lamp"),
    joint("drive", "base", "wheel", "continuous", '<origin xyz="0 0.2 0"/><axis xyz="0 1 0"/>'),
    joint("lift", "base", "mast", "prismatic", LIMIT + '<origin rpy="0 0.3 0.5"/><axis xyz="0 0 2"/>'),
    joint("finger", "mast", "finger", inner=LIMIT + '<mimic joint="lift" multiplier="2" offset="0.5"/>'),
    joint("thumb", "finger", "thumb", inner=LIMIT + '<mimic joint="finger" multiplier="-1"/>'),
    joint("slide", "base", "plate", "planar", '<origin xyz="0 0 1"/>'),
    joint("fly", "base", "balloon", "floating", ""),
    joint("hang", "balloon", "lamp", "fixed", '<origin xyz="0 0 -1" rpy="0 0 1.5"/>'),
)


def with_mesh(uri: str) -> str:
    mesh = f'<geometry><mesh filename="{uri}"/></geometry>'
    return robot(f'<link name="base"><visual>{mesh}</visual></link>')
