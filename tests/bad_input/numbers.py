"""Numbers that are allowed and far from any that a sensor needs: denormal, tiny, huge, the largest of all."""

from __future__ import annotations

import sys

from tests.bad_input.case import SENSOR, Case, body, from_text

DENORMAL, SMALLEST, LARGEST = "5e-324", repr(sys.float_info.min), repr(sys.float_info.max)


def cases() -> list[Case]:
    return [*_sizes(), *_beyond(), *_places(), *_directions(), *_sensors(), *_distance_sensors()]


def _sizes() -> list[Case]:
    made = []
    for size in (DENORMAL, SMALLEST, "1e-160", "1e-30", "1e30"):
        for shape in (
            f'cube", size = {size}',
            f'plate", size = [{size}, {size}]',
            f'sphere", radius = {size}',
            f'cylinder", radius = {size}, height = 1',
            f'cone", radius = 1, height = {size}',
            f'capsule", radius = {size}, length = 1',
            f'ellipsoid", semi_axes = [1, {size}, {size}]',
            f'disc", radius = {size}',
            f'person", height = {size}',
            f'polygon", vertices = [[0, 0], [{size}, 0], [0, {size}]]',
        ):
            kind = shape.split('"')[0]
            made.append(from_text(f"{kind} of {size}", SENSOR + body(f'type = "{shape}'), None))
    return made


def _beyond() -> list[Case]:
    """Numbers whose squares are none."""
    return (
        [
            from_text(f"a body of {size}", SENSOR + body(f'type = "cube", size = {size}'), "size")
            for size in ("1.1e30", "1e160", "1e300", LARGEST)
        ]
        + [
            # The parsers themselves know no such number, and so no key either.
            from_text(f"a body of {size}", SENSOR + body(f'type = "cube", size = {size}'), "")
            for size in ("1e309", "1e-400")
        ]
        + [
            from_text(f"a body at {far}", SENSOR + body(more=f"translation = [0, 0, {far}]"), "translation")
            for far in ("-1.1e30", "1e160", LARGEST)
        ]
    )


def _places() -> list[Case]:
    return [
        from_text(f"a body at {far}", SENSOR + body(more=f"translation = [0, 0, {far}]"), None)
        for far in (DENORMAL, "1e-200", "1e30")
    ] + [
        from_text(
            f"turned by {angle} degrees",
            SENSOR
            + body(more=f"translation = [0, 0, 1]\nrotation = {{ axis = [1, 2, 3], degrees = {angle} }}"),
            None,
        )
        for angle in (DENORMAL, "1e22", "1e30")
    ]


def _directions() -> list[Case]:
    made = []
    for size in (DENORMAL, "1e-320", "1e-200", "1e30"):
        turned = f"translation = [0, 0, 1]\nrotation = {{ axis = [{size}, {size}, 0], degrees = 30 }}"
        made.append(from_text(f"an axis of {size}", SENSOR + body(more=turned), None))
        turned = f"translation = [0, 0, 1]\nquaternion = [{size}, 0, {size}, 0]"
        made.append(from_text(f"a quaternion of {size}", SENSOR + body(more=turned), None))
    return made


def _sensors() -> list[Case]:
    made = []
    for size in (DENORMAL, "1e-320", "1e-200", "1e-30", "1e30"):
        plate = SENSOR.replace("[0.1, 0, 0]", f"[{size}, 0, 0]").replace("[0, 0.1, 0]", f"[0, {size}, 0]")
        made.append(from_text(f"a plate of {size}", plate + body(), None))
    skew = SENSOR.replace("[0.1, 0, 0]", "[1e-200, 0, 0]").replace("[0, 0.1, 0]", "[1e-202, 1e-200, 0]")
    made.append(from_text("a tiny plate that is no rectangle", skew + body(), "edge_v"))
    skew = SENSOR.replace("[0.1, 0, 0]", "[1e29, 0, 0]").replace("[0, 0.1, 0]", "[1e27, 1e29, 0]")
    made.append(from_text("a huge plate that is no rectangle", skew + body(), "edge_v"))
    long = SENSOR.replace("[0.1, 0, 0]", f"[{LARGEST}, {LARGEST}, 0]").replace("[0, 0.1, 0]", "[0, 0, 1]")
    made.append(from_text("an edge longer than any number", long + body(), "edge_"))
    for key in ("input_voltage", "coupling_capacitance"):
        made += [
            from_text(f"{key} of {size}", SENSOR + f"{key} = {size}\n" + body(), None)
            for size in (DENORMAL, "1e30")
        ]
    return made


def _distance_sensors() -> list[Case]:
    made = []
    for size in (DENORMAL, "1e-200", "1e30"):
        eye = f'[[distance_sensor]]\nname = "eye"\napex = [0, 0, 0]\ndirection = [0, 0, {size}]\n'
        made.append(
            from_text(
                f"a direction of {size}", SENSOR + eye + "full_angle_degrees = 30\nrange = 1\n" + body(), None
            )
        )
        for key, other in (("range", "full_angle_degrees = 30"), ("full_angle_degrees", "range = 1")):
            if key == "range" or size == "1e-200":
                told = SENSOR + eye.replace(size, "1") + f"{other}\n{key} = {size}\n" + body()
                made.append(from_text(f"{key} of {size}", told, None))
    return made
