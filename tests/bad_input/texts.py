"""Scene files that are not TOML, or TOML of an unusual form."""

import random

from tests.bad_input.case import CUBE, SENSOR, Case, body, from_bytes, from_text

WHOLE = SENSOR + body()
# Bytes that begin no character of UTF-8, an overlong slash, half of a surrogate pair.
NOT_UTF8 = (b"\xff", b"\xc0\xaf", b"\xed\xa0\x80", b"\x80")


def cases() -> list[Case]:
    return [*_malformed(), *_encodings(), *_extremes(), *_truncated(), *_garbage()]


def _malformed() -> list[Case]:
    wrong = {
        "an open table": "[[sensor]\n",
        "an open array": 'name = ["a"',
        "an open string": 'title = "never closed\n',
        "an open inline table": "medium = { relative_permittivity = 1",
        "a key without a value": "title = \n",
        "a value without a key": "= 1\n",
        "two values": "title = 1 2\n",
        "a key twice": "title = 1\ntitle = 2\n",
        "a table twice": "[medium]\nrelative_permittivity = 1\n[medium]\n",
        "an unknown escape": 'title = "\\q"\n',
        "a control character": 'title = "\x01"\n',
        "a month of 13": "title = 1979-13-01\n",
        "an integer of 5000 digits": f"title = {'9' * 5000}\n",
        "a number with two points": "title = 1.2.3\n",
        "a number that begins with 0": "title = 012\n",
        "prose": "this is a letter, not a scene\n",
        "JSON": '{"sensor": []}\n',
    }
    return [from_text(f"malformed: {name}", text + SENSOR, "") for name, text in wrong.items()]


def _encodings() -> list[Case]:
    return [
        from_bytes("byte order mark", b"\xef\xbb\xbf" + WHOLE.encode(), None),
        from_bytes("line ends of two characters", WHOLE.replace("\n", "\r\n").encode(), None),
        from_bytes("line ends of another system", WHOLE.replace("\n", "\r").encode(), ""),
        from_bytes("UTF-16", WHOLE.encode("utf-16"), ""),
        from_bytes("NUL between lines", WHOLE.replace("\n[[object]]", "\n\0[[object]]").encode(), ""),
        from_bytes("NUL at the end", WHOLE.encode() + b"\0", ""),
        from_text("NUL in a name", WHOLE.replace('"body"', '"bo\\u0000dy"'), None),
        from_text("a line's end in a name", WHOLE.replace('"body"', '"bo\\ndy"'), None),
        from_text("a line's end in a wrong object's name", WHOLE.replace('"body"', '"bo\\ndy"') + "size = 1\n", "size"),
        from_text("letters of many alphabets in a name", WHOLE.replace('"body"', '"Hände ▢ 手 \\U0001F590"'), None),
        from_text("a line's end in a key", WHOLE + '"a\\nb" = 1\n', "b"),
        *(from_bytes(f"not UTF-8: {wrong.hex()}", WHOLE.replace("body", "bo!dy").encode().replace(b"!", wrong), "") for wrong in NOT_UTF8),
    ]  # fmt: skip


def _extremes() -> list[Case]:
    """Deep, long and many."""
    links = "".join(
        f'[[link]]\nname = "l{k}"\n' + (f'parent = "l{k - 1}"\n' if k else "") for k in range(1000)
    )
    return [
        from_text("no bytes", "", "at least one"),
        from_text("a comment alone", "# nothing\n", "at least one"),
        from_text("arrays in arrays, 100", f"title = {'[' * 100}{']' * 100}\n" + SENSOR, "title"),
        from_text("arrays in arrays, 100000", f"title = {'[' * 100_000}{']' * 100_000}\n" + SENSOR, ""),
        from_text("open arrays in arrays", "title = " + "[" * 100_000, ""),
        from_text("tables in tables", f"title = {'{a=' * 100_000}1{'}' * 100_000}\n" + SENSOR, ""),
        from_text("a key of 1000 parts", ".".join("a" * 1000) + " = 1\n" + SENSOR, "a"),
        from_text("a table of 1000 parts", SENSOR + f"[{'.'.join('a' * 20_000)}]\n", "a"),
        from_text("a key of a million letters", f"{'a' * 1_000_000} = 1\n" + SENSOR, "aaa"),
        from_text("a name of a million letters", WHOLE.replace('"body"', f'"{"b" * 1_000_000}"') + "size = 1\n", "size"),
        from_text("fifty thousand numbers", WHOLE + f"quaternion = [{'1,' * 50_000}]\n", "quaternion"),
        from_text("a chain of 1000 links", links + WHOLE, None),
        from_text(
            "a cycle of 1000 links",
            links.replace('name = "l0"\n', 'name = "l0"\nparent = "l999"\n') + WHOLE,
            "parent",
        ),
        from_text("a million segments of a sphere", SENSOR + body('type = "sphere", radius = 0.1, segments = 1000000'), "segments"),
        from_text("the most segments of all", SENSOR + body(f'type = "cylinder", radius = 0.1, height = 1, segments = {2**31 - 1}'), "segments"),
        from_text(
            "more segments than that",
            SENSOR + body(f'type = "arc", inner_radius = 1, outer_radius = 2, height = 1, degrees = 9, segments = {2**40}'),
            "segments",
        ),
        from_text(
            "objects by the hundred",
            SENSOR + "".join(body(CUBE, f"translation = [0, 0, {k}]").replace('"body"', f'"body {k}"') for k in range(1, 201)),
            None,
        ),
    ]  # fmt: skip


def _truncated() -> list[Case]:
    """Cut within a word or a bracket, never between two lines that could end a scene."""
    places = [
        WHOLE.index(word) + 3
        for word in ("[[sensor", "plates", "corner", "edge_v", "[[object", "shape", "cube")
    ]
    return [from_text(f"cut after {at} bytes", WHOLE[:at], "") for at in places]


def _garbage() -> list[Case]:
    chance = random.Random(1)
    sizes = (1, 100, 10_000)
    made = [from_bytes(f"{size} random bytes", b"\xfe" + chance.randbytes(size), "") for size in sizes]
    return [*made, from_bytes("a megabyte of NUL", bytes(2**20), "")]
