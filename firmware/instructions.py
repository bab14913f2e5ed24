#!/usr/bin/env python3
"""The most instructions that a linked program for a Thumb core can take in a function, from its disassembly.

    instructions.py ELF --root FUNCTION ... --loops TABLE [--set NAME=NUMBER ...] [--calls CALLER=CALLEES ...]
                    [--objdump PROGRAM] [--parts]

The longest way through the branches of a function counts, and a call adds the callee's own most. How often a loop goes round is
taken from a table; the numbers in it are the one thing that is taken on trust. What cannot be followed is refused: a loop
that is not in the table, a loop with two ways in, and what stack.py refuses. So the bound holds for every input for
which the table does.

The table has `NAME = NUMBER` for each constant, which --set overrides, and lines of columns, two spaces apart:

    loop   FUNCTION  TEXT  ROUNDS          Each time that it is come to, the loop goes round so often at most.
    total  FUNCTION  TEXT  ROUNDS  OUTER   In a whole call of the function OUTER, the loop goes round so often at most.
    part   FUNCTION  TEXT  TIMES   OUTER   In a whole call of OUTER, so many rounds of the loop around it come to this line.
    calls  CALLEE    -     TIMES   OUTER   In a whole call of OUTER, so many calls of a function are made at most.
    size   CALLEE    REGISTER  REST        A call of this function has a constant SIZE in a register; REST is what it leaves to others.

FUNCTION and TEXT find the source: the symbol of a function with the name of what is inlined there, and a line of that; a loop is found
by lines of functions that all of its instructions come from. They, CALLEE and OUTER are regular
expressions, `-` finds everything; ROUNDS and TIMES are expressions of constants. Loops inside each other in one line take their
rounds from one iterator: they share them. A loop that is tested at its beginning is come to once more than it goes round.

Prints `FUNCTION: INSTRUCTIONS` for each root; with --parts, what they are made of, function by function.
Exit status 1 if a root cannot be bounded.
"""

import argparse
import collections
import itertools
import re
import subprocess
import sys

from stack import CALLS, Program, Refused

JUMP = re.compile(r"(?:b|cbz|cbnz|b(?:eq|ne|cs|cc|mi|pl|vs|vc|hi|ls|ge|lt|gt|le)) .*?\b([0-9a-f]+) <")
# Where the sources of the project are; what else is inlined belongs to the line of ours that calls it.
OURS = re.compile(r"/(?:controller|firmware)/.*\.rs$")


class Way:
    """Instructions that are executed one after the other, and what they are made of."""

    made = 0

    def __init__(self, cost, parts):
        Way.made += 1
        self.cost, self.parts, self.number = cost, parts, Way.made

    def then(self, other, times=1):
        return Way(self.cost + times * other.cost, ((self, 1), (other, times))) if times * other.cost else self

    def total(self):
        """How many instructions of each function are in it."""
        counts, times, ways = collections.Counter(), collections.Counter({self.number: 1}), {self.number: self}
        while ways:
            # What a way is made of was made before it.
            number = max(ways)
            way, many = ways.pop(number), times.pop(number)
            for part, factor in way.parts:
                if isinstance(part, Way):
                    ways[part.number] = part
                    times[part.number] += factor * many
                else:
                    counts[part] += factor * many
        return counts


NOTHING = Way(0, ())


def longest(ways):
    return max(ways, key=lambda way: way.cost, default=None)


class Block:
    """Instructions that are executed one after the other, and where they lead: targets, each with what is executed on the
    way there. A target of None leaves the function."""

    def __init__(self):
        self.way, self.edges, self.addresses, self.part = NOTHING, [], [], None


class Loop:
    """A natural loop: its header, and the blocks from which the header is reached without another visit to it."""

    def __init__(self, header):
        self.header, self.blocks, self.inner, self.parts = header, {header}, [], []


class Sweep:
    """How ways are counted: which blocks are, what is counted elsewhere, and the line that the loop around is in, with the
    rounds that are counted with its own."""

    def __init__(self, aside, counts, line=None):
        self.aside, self.counts, self.line, self.shared = aside, counts, line, []


class Table:
    """How often loops go round."""

    def __init__(self, path, settings):
        self.constants, self.lines = dict(settings), []
        with open(path, encoding="utf-8") as lines:
            for text in lines:
                text = text.split("#")[0].strip()
                if constant := re.fullmatch(r"(\w+) = (.+)", text):
                    self.constants.setdefault(constant[1], self.number(constant[2]))
                elif text:
                    kind, *columns = re.split(r"\s{2,}", text)
                    self.lines.append((kind, *columns, None)[:5])

    def number(self, expression):
        return int(eval(expression, {"__builtins__": {"min": min}}, self.constants))

    def rounds(self, places):
        """Which line of the sources a loop is in, of these, how often it goes round, and for a call of what."""
        for function, text in places:
            for line in self.lines:
                kind, where, what, rounds, outer = line
                if kind in ("loop", "total") and finds(where, function) and finds(what, text):
                    return (line, text), self.number(rounds), outer
        return None

    def parts(self, places):
        """What is said of the parts that these lines belong to."""
        for line in self.lines:
            kind, where, what, times, outer = line
            if kind == "part" and any(finds(where, function) and finds(what, text) for function, text in places):
                yield line, self.number(times), outer

    def size(self, callee):
        """The register that the size of what a function works on is in, and what of it is left to others."""
        return next((line[2:4] for line in self.lines if line[0] == "size" and finds(line[1], callee)), None)

    def calls(self, callee):
        """How often functions like this one are called for a call of what."""
        for line in self.lines:
            kind, where, _, times, outer = line
            if kind == "calls" and finds(where, callee):
                return line, self.number(times), outer
        return None


def finds(pattern, text):
    return pattern == "-" or re.search(pattern, text) is not None


class Instructions(Program):
    """Its bounds are ways."""

    def __init__(self, elf, objdump, calls, table):
        super().__init__(elf, objdump, calls)
        self.rules, self.sources = table, Sources(elf, objdump, self.functions)
        # By function: what is counted for a whole call of one of its callers.
        self.aside = {}
        # By function that has a size: what it calls.
        self.sized = {}

    def whole(self, start):
        """The longest way through a function and all that it calls."""
        way, _, _ = self.bound(start)
        if left := self.aside[start]:
            raise Refused(f"counted for a call of {', '.join(outer for _, outer, _ in left.values())}, which it does not make")
        return way

    def walk(self, start, code):
        """The longest way through a function: see `bound`."""
        name = self.functions[start][0]
        aside = self.aside[start] = {}
        blocks = self.blocks(start, code, aside)
        above = dominators(start, blocks)
        loops = natural_loops(blocks, above)
        self.find_parts(blocks, above, loops)
        outs, _ = self.sweep(blocks, start, set(blocks), loops, Sweep(aside, lambda block: not block.part))
        most = longest(way for _, _, way in outs) or NOTHING
        for key, (times, outer, way) in list(aside.items()):
            if finds(outer, name):
                most = most.then(way, times)
                del aside[key]
        return most, [], bool(outs)

    def blocks(self, start, code, aside):
        """The blocks of a function by their first addresses."""
        name = self.functions[start][0]
        nodes, work = {}, [start]
        while work:
            address = work.pop()
            if address in nodes:
                continue
            if address not in code:
                raise Refused(f"no instruction at {address:#x}")
            instruction = code[address]
            callees, targets, leaves = self.flow(name, instruction, code)
            known = [self.called(callee, code, address, aside) for callee in callees]
            called = longest(way for way, _ in known) or NOTHING
            goes_on = not known or any(returns for _, returns in known)
            one = Way(1, ((name, 1),))
            if instruction.name in CALLS:
                one = one.then(called)
                edges = [(target, NOTHING) for target in targets] if goes_on else []
            else:
                # What it jumps to is executed only if it jumps.
                edges = [(target, NOTHING) for target in targets] + ([(None, called)] if leaves and goes_on else [])
            nodes[address] = one, edges
            work.extend(target for target, _ in edges if target is not None)
        return joined(start, nodes)

    def called(self, callee, code, address, aside):
        """What a call adds, and whether it comes back; a part of it may be counted for a whole call of a caller."""
        name = self.functions[callee][0]
        if sized := self.rules.size(name):
            register, rest = sized
            size = constant(code, address, register)
            if size is None:
                raise Refused(f"a call of {name} whose {register} is not known, at {address:#x}")
            self.rules.constants["SIZE"] = size
            self.rules.constants["REST"] = self.rules.number(rest)
            for at in (callee, *self.sized.get(callee, ())):
                self.bounds.pop(at, None)
            before = set(self.bounds)
            way, _, returns = self.bound(callee)
            self.sized[callee] = set(self.bounds) - before - {callee}
        else:
            way, _, returns = self.bound(callee)
        merge(aside, self.aside[callee])
        if counted := self.rules.calls(name):
            line, times, outer = counted
            merge(aside, {line: (times, outer, way)})
            return NOTHING, returns
        return way, returns

    def find_parts(self, blocks, above, loops):
        """Tells which blocks belong to a part: those that are only reached through its beginning."""
        found = {}
        for at, block in blocks.items():
            for line, times, outer in self.rules.parts(self.sources.places(block.addresses)):
                found.setdefault(line, (times, outer, []))[2].append(at)
        parts = []
        for times, outer, members in found.values():
            shared = set.intersection(*(above[at] for at in members))
            # The last one that is before all of these.
            begin = max(shared, key=lambda at: len(above[at]))
            around = innermost(loops, begin)
            if begin not in members or around is None or begin == around.header:
                raise Refused(f"a part that does not begin in a loop, at {begin:#x}")
            parts.append((begin, times, outer))
        # Of a part inside another one, the blocks are its own.
        for part in sorted(parts, key=lambda part: len(above[part[0]])):
            around = innermost(loops, part[0])
            around.parts.append(part)
            for at in around.blocks:
                if part[0] in above[at]:
                    blocks[at].part = part

    def sweep(self, blocks, entry, region, loops, how):
        """The longest ways from the beginning of `entry` to each edge out of a region, whose loops count as one block: as
        source, target and way; and the longest one back to the entry."""
        inner = {loop.header: loop for loop in loops}
        edges = {}

        def leads(node):
            if node not in edges:
                if node in inner:
                    edges[node] = self.round_and_round(blocks, inner[node], how)
                else:
                    own = blocks[node].way if how.counts(blocks[node]) else NOTHING
                    edges[node] = [(node, target, own.then(way)) for target, way in blocks[node].edges]
            return edges[node]

        ways, outs, back = {entry: NOTHING}, [], None
        for node in ordered(entry, lambda node: [it for _, it, _ in leads(node) if it in region and it != entry]):
            for source, target, way in leads(node):
                way = ways[node].then(way)
                if target == entry:
                    back = longest([way, back or NOTHING])
                elif target not in region:
                    outs.append((source, target, way))
                else:
                    ways[target] = longest([way, ways.get(target, NOTHING)])
        return outs, back

    def round_and_round(self, blocks, loop, how):
        """The longest ways through a loop to each edge out of it."""
        counted = self.rules.rounds(self.places(blocks, loop))
        if counted is None:
            raise Refused(f"a loop that is not in the table: {self.describe(blocks, loop)}")
        line, rounds, outer = counted
        inside = Sweep(how.aside, how.counts, line)
        outs, back = self.sweep(blocks, loop.header, loop.blocks, loop.inner, inside)
        for begin, times, whole in loop.parts:
            mine = Sweep(how.aside, lambda block, begin=begin: block.part is not None and block.part[0] == begin, line)
            ways, again = self.sweep(blocks, loop.header, loop.blocks, loop.inner, mine)
            most = longest([again or NOTHING, *(way for _, _, way in ways)])
            for shared in mine.shared:
                most = most.then(shared, rounds)
            merge(how.aside, {begin: (times, whole, most)})
        latches = {at for at in loop.blocks if any(target == loop.header for target, _ in blocks[at].edges)}
        tested_first = len(loop.blocks) > 1 and any(source == loop.header for source, _, _ in outs)
        tested = tested_first or any(source in latches for source, _, _ in outs)

        def begun(source):
            """Whether the round in which a way leads out is one of those that are counted."""
            return source != loop.header if tested_first else source in latches or tested

        if outer is not None or line == how.line:
            # Its rounds are counted with those of others.
            most = longest([back or NOTHING, *(way for source, _, way in outs if begun(source))])
            if outer is None:
                how.shared += [most, *inside.shared]
            else:
                for shared in inside.shared:
                    most = most.then(shared)
                merge(how.aside, {loop.header: (rounds, outer, most)})
            return [(source, target, NOTHING if begun(source) else way) for source, target, way in outs]
        through = []
        for source, target, way in outs:
            before = rounds - 1 if begun(source) else rounds
            if before >= 0:
                way = way.then(back or NOTHING, before)
                for shared in inside.shared:
                    way = way.then(shared, rounds)
                through.append((source, target, way))
        return through

    def places(self, blocks, loop):
        """Which lines tell what loop it is: those of the branches back and of its header, in functions that all of it is in."""
        latches = [block for at, block in blocks.items() if at in loop.blocks and any(t == loop.header for t, _ in block.edges)]
        ends = [latch.addresses[-1] for latch in latches] + blocks[loop.header].addresses[::-1]
        return self.sources.places(ends, [at for block in loop.blocks for at in blocks[block].addresses])

    def describe(self, blocks, loop):
        places = self.places(blocks, loop)
        return f"{loop.header:#x}" + "".join(f"\n    {function}: {text}" for function, text in places)


def joined(start, nodes):
    """Blocks of instructions, each with its way and its edges."""
    entries = collections.Counter(target for _, edges in nodes.values() for target, _ in edges)
    heads = {start} | {at for at in entries if at is not None and entries[at] > 1}
    heads |= {target for _, edges in nodes.values() if len(edges) != 1 for target, _ in edges if target is not None}
    blocks = {}
    for head in heads:
        block, at = blocks.setdefault(head, Block()), head
        while True:
            way, edges = nodes[at]
            block.way, block.edges = block.way.then(way), edges
            block.addresses.append(at)
            if len(edges) != 1 or edges[0][0] in heads or edges[0][0] is None:
                break
            at = edges[0][0]
    return blocks


def ordered(entry, leads):
    """What is reached from `entry`, each before what it leads to; refused if that goes in circles."""
    after, state, work = [], {}, [(entry, iter(leads(entry)))]
    state[entry] = "open"
    while work:
        node, rest = work[-1]
        for target in rest:
            if state.get(target) == "open":
                raise Refused(f"a loop with two ways in, at {target:#x}")
            if target not in state:
                state[target] = "open"
                work.append((target, iter(leads(target))))
                break
        else:
            state[node] = "done"
            after.append(node)
            work.pop()
    return after[::-1]


def before(blocks):
    """The blocks that lead to each."""
    into = collections.defaultdict(set)
    for at, block in blocks.items():
        for target, _ in block.edges:
            if target is not None:
                into[target].add(at)
    return into


def dominators(start, blocks):
    """The blocks through which alone each is reached, itself among them."""
    into = before(blocks)
    above = {at: set(blocks) for at in blocks}
    above[start] = {start}
    changed = True
    while changed:
        changed = False
        for at in blocks:
            if at != start:
                known = set.intersection(*(above[earlier] for earlier in into[at])) | {at}
                changed |= known != above[at]
                above[at] = known
    return above


def natural_loops(blocks, above):
    """The outermost loops of a function, each with those inside it."""
    into, loops = before(blocks), {}
    for header in blocks:
        work = [at for at in into[header] if header in above[at]]
        if work:
            loop = loops[header] = Loop(header)
            while work:
                at = work.pop()
                if at not in loop.blocks:
                    loop.blocks.add(at)
                    work.extend(into[at])
    outermost = []
    for loop in loops.values():
        around = [it for it in loops.values() if it is not loop and loop.header in it.blocks]
        holder = min(around, key=lambda it: len(it.blocks), default=None)
        (holder.inner if holder else outermost).append(loop)
    return outermost


def innermost(loops, at):
    """The innermost loop around a block."""
    for loop in loops:
        if at in loop.blocks:
            return innermost(loop.inner, at) or loop
    return None


def merge(aside, more):
    """Adds what is counted elsewhere; the more of two ways of one thing."""
    for key, (times, outer, way) in more.items():
        known = aside.get(key, (times, outer, way))
        aside[key] = times, outer, longest([way, known[2]])


def constant(code, address, register, steps=32):
    """The largest number that instructions shortly before this one have put into a register, on whichever way it is come to;
    none, if it may be something else."""
    before = [at for at in (address - 2, address - 4) if at in code and code[at].size == address - at]
    before = [at for at in before if not re.fullmatch("b|bx|udf|tbb|tbh", code[at].name)]
    before += [at for at, it in code.items() if (jump := JUMP.match(f"{it.name} {it.operands}")) and int(jump[1], 16) == address]
    found = []
    for at in before:
        instruction = code[at]
        if number := re.fullmatch(rf"{register}, #(\d+)", instruction.operands):
            found.append(int(number[1]) if instruction.name in ("mov", "movs", "movw") else None)
        elif re.match(rf"{register}\b", instruction.operands) or instruction.name in CALLS or not steps:
            found.append(None)
        else:
            found.append(constant(code, at, register, steps - 1))
    return max(found) if found and None not in found else None


class Sources:
    """Which lines of our sources an instruction comes from, and in which functions."""

    def __init__(self, elf, objdump, functions):
        self.lines, self.texts = {}, {}
        self.names = {at: name for name, code in functions.values() for at in code}
        options = ["-d", "-C", "-l", "--inlines", "--no-show-raw-insn"]
        text = subprocess.run([objdump, *options, elf], check=True, capture_output=True, text=True).stdout
        function = place = None
        around = []
        for line in text.splitlines():
            if inliner := re.fullmatch(r"inlined by (.+):(\d+)(?: \(discriminator \d+\))? \((.+)\)", line):
                around.append(inliner.groups())
            elif name := re.fullmatch(r"(\S.*)\(\):", line):
                function = name[1]
            elif where := re.fullmatch(r"(/.+):(\d+)(?: \(discriminator \d+\))?", line):
                place = where.groups()
            elif address := re.match(r"\s+([0-9a-f]+):\t", line):
                self.lines[int(address[1], 16)] = [(*(place or ("", 0)), function), *around]
                around = []

    def places(self, addresses, inside=()):
        """Function and text of the lines that addresses come from, the innermost first; only those of functions that all of
        `inside` come from, if there are any."""
        deepest = self.common(inside)
        found = {}
        for address in addresses:
            lines = self.lines.get(address, [])
            for file, number, function in lines[max(0, len(lines) - deepest) :] if inside else lines:
                if OURS.search(file) or function is None:
                    found.setdefault((f"{self.names[address]} {function}", self.text(file, int(number))))
        return found or {(self.names[addresses[0]], ""): None}

    def common(self, addresses):
        """How many functions, inlined in each other, all of these addresses come from: calls in the same lines."""
        chains = []
        for address in addresses:
            lines = self.lines.get(address, [])
            # What the compiler adds has no line.
            if lines and int(lines[0][1]):
                chains.append([None, *(line[:2] for line in lines[:0:-1])])
        return sum(1 for _ in itertools.takewhile(lambda callers: len(set(callers)) == 1, zip(*chains)))

    def text(self, file, number):
        if file not in self.texts:
            with open(file, encoding="utf-8") as source:
                self.texts[file] = source.read().splitlines()
        return self.texts[file][number - 1].strip()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("elf", help="a linked program with its local symbols and its line numbers")
    parser.add_argument("--root", action="append", required=True, help="a function, by a regular expression: the one that takes the most, if it finds several")
    parser.add_argument("--loops", required=True, help="how often loops go round")
    parser.add_argument("--set", action="append", default=[], help="another number for a constant of the table")
    parser.add_argument("--calls", action="append", default=[], help="where the calls through a register of a function go")
    parser.add_argument("--objdump", default="arm-none-eabi-objdump")
    parser.add_argument("--parts", action="store_true", help="print what the bound is made of")
    options = parser.parse_args()
    sys.setrecursionlimit(10000)
    settings = {name: int(number) for name, number in (setting.split("=") for setting in options.set)}
    calls = [calls.split("=", 1) for calls in options.calls]
    program = Instructions(options.elf, options.objdump, calls, Table(options.loops, settings))
    status = 0
    for root in options.root:
        starts = [at for at, (name, _) in program.functions.items() if re.search(root, name)]
        if not starts:
            print(f"{root}: no such function in {options.elf}", file=sys.stderr)
            return 2
        try:
            program.open.clear()
            way = longest(program.whole(start) for start in starts)
        except Refused as why:
            print(f"{root}: {why}", file=sys.stderr)
            status = 1
            continue
        print(f"{root}: {way.cost}")
        if options.parts:
            print("".join(f"{count:10} {name}\n" for name, count in way.total().most_common()), end="")
    return status


if __name__ == "__main__":
    sys.exit(main())
