#!/usr/bin/env python3
"""Checks cede.dbc with cantools: check.py DBC HEADER MANUAL.

- It is a sound database: signals do not overlap, and each fits its message.
- Each signal but counters and checksums has a comment; the fields of cede.h that it names exist.
- A signal takes every number that its field can have, as the field's own comment in the header gives its range.
- The numbered choices are those of the header.
- The table of signals in the manual is that of the database.
"""

import re
import sys

import cantools

PROTECTION = {"counter", "crc"}


def structures(header):
    """Each structure's fields, with the comment of each."""
    found = {}
    for body in re.finditer(r"typedef struct (\w+) {(.*?)^} \1;", header, re.S | re.M):
        fields = re.finditer(r"/\*\*(.*?)\*/\s*[\w ]+?[ *](\w+)(?:\[\w+\])?;", body[2], re.S)
        found[body[1]] = {field[2]: re.sub(r"\s*\*\s*", " ", field[1]).strip() for field in fields}
    return found


def choices(header, enumeration):
    """Names and numbers of an enumeration or of a group of constants, without their prefix."""
    prefix = f"CEDE_{enumeration.upper()}_"
    pairs = re.findall(rf"\b{prefix}(\w+)(?: =)? (\d+)", header)
    return {int(number): name for name, number in pairs}


def ranges(comment):
    """The closed ranges like [-1, 100] of a comment."""
    return [(float(low), float(high)) for low, high in re.findall(r"\[(-?[\d.]+), (-?[\d.]+)\]", comment)]


def rows(database):
    """The rows of the manual's table."""
    for message in database.messages:
        for signal in sorted(message.signals, key=lambda signal: signal.start):
            if signal.name not in PROTECTION:
                unit = f" {signal.unit}" if signal.unit else ""
                scale = "" if signal.scale == 1 else f"{signal.scale:.4g}{unit}"
                offset = f"{signal.offset:g}" if signal.offset else ""
                yield f"| `{message.name}.{signal.name}` | {signal.length} | {scale} | {offset} | {signal.comment} |"


def wrong(database, header, manual):
    """What does not hold, in words."""
    known = structures(header)
    for message in database.messages:
        if message.cycle_time != 100:
            yield f"{message.name}: not once every 100 ms"
        for signal in message.signals:
            name = f"{message.name}.{signal.name}"
            if signal.name in PROTECTION:
                continue
            if not signal.comment:
                yield f"{name}: no comment says which field it is"
                continue
            for structure, field in re.findall(r"\b(cede_\w+)\.(\w+)", signal.comment):
                if field not in known.get(structure, {}):
                    yield f"{name}: cede.h has no {structure}.{field}"
                    continue
                for low, high in ranges(known[structure][field]):
                    if signal.minimum > low or signal.maximum < high:
                        yield f"{name}: [{signal.minimum}, {signal.maximum}] is less than {structure}.{field} in [{low}, {high}]"
            for function in re.findall(r"\bcede_approach_\w+", signal.comment):
                if not re.search(rf"\b{function}\(", header):
                    yield f"{name}: cede.h has no {function}()"
            low, high = signal.offset, signal.offset + signal.scale * (2**signal.length - 1)
            if signal.minimum < low - 1e-9 or signal.maximum > high + 1e-9:
                yield f"{name}: [{signal.minimum}, {signal.maximum}] does not fit {signal.length} bits"
            if signal.choices:
                numbers = {number: str(choice) for number, choice in signal.choices.items()}
                theirs = {number: text for number, text in choices(header, signal.name).items() if text != "OTHER"}
                if numbers != theirs:
                    yield f"{name}: {numbers}, but the header has {theirs}"
    for row in rows(database):
        if row not in manual:
            yield f"the manual has no row\n{row}"


def main():
    dbc, header, manual = sys.argv[1:]
    database = cantools.database.load_file(dbc, strict=True)
    with open(header, encoding="utf-8") as file, open(manual, encoding="utf-8") as text:
        complaints = list(wrong(database, file.read(), text.read()))
    for complaint in complaints:
        print(f"{dbc}: {complaint}", file=sys.stderr)
    signals = sum(len(message.signals) for message in database.messages)
    print(f"cede.dbc: {len(database.messages)} messages, {signals} signals, {len(complaints)} complaints")
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
