#!/usr/bin/env python3
"""The most stack that a linked program for a Thumb core can need, from its disassembly.

    stack.py ELF --root FUNCTION ... [--calls CALLER=CALLEES ...] [--objdump PROGRAM] [--path]

In each function the depth of the stack pointer is followed along every branch; a call adds the callee's own most. What cannot be
followed is refused: a call through a register, a cycle of calls, a stack pointer that is computed, an instruction that moves it
in an unknown way. So the bound holds for every input. What interrupts put on the stack comes on top of it.

A call through a register is followed only if --calls says where it goes: both sides are regular expressions over the names of
functions, and the most of all that the right one finds counts. It is the one thing that is taken on trust.

Prints `FUNCTION: BYTES` for each root; with --path, the calls that it is made of.
Exit status 1 if a root cannot be bounded.
"""

import argparse
import re
import subprocess
import sys

SYMBOL = re.compile(r"^([0-9a-f]{8}) <(.+)>:$")
LINE = re.compile(r"^\s+([0-9a-f]+):\s+((?:[0-9a-f]{2,8} ?)+)\s*\t(\S+)\s*(.*)$")
TARGET = re.compile(r"\b([0-9a-f]+) <([^>]+)>")
# What does not write to its first operand.
READS_FIRST = re.compile("cmp|cmn|tst|v?(?:stm|ldm)")
CALLS = ("bl", "blx")
CONDITIONS = "eq ne cs cc mi pl vs vc hi ls ge lt gt le hs lo".split()


class Refused(Exception):
    """The stack of a function cannot be followed."""


class Instruction:
    def __init__(self, address, raw, name, operands):
        self.address, self.raw, self.operands = address, raw, re.split("[;@]", operands)[0].strip()
        self.name = name.removesuffix(".n").removesuffix(".w")
        self.size = len(raw)

    def __str__(self):
        return f"{self.address:#x}: {self.name} {self.operands}"


def disassemble(elf, objdump):
    """Functions by address, each a name and its instructions by address; and all bytes by address, those of data, too."""
    text = subprocess.run([objdump, "-d", "-z", elf], check=True, capture_output=True, text=True).stdout
    functions, memory, current = {}, {}, None
    for line in text.splitlines():
        if symbol := SYMBOL.match(line):
            current = functions.setdefault(int(symbol[1], 16), (symbol[2], {}))
        elif (parts := LINE.match(line)) and current is not None:
            address = int(parts[1], 16)
            raw = b"".join(bytes.fromhex(group)[::-1] for group in parts[2].split())
            memory.update(enumerate(raw, address))
            if not parts[3].startswith("."):
                current[1][address] = Instruction(address, raw, parts[3], parts[4])
    return functions, memory


def registers(text):
    """How many registers a list like {r4, r5, s16-s19, lr} has, in words."""
    count = 0
    for part in re.search(r"{(.*)}", text)[1].split(","):
        first, _, last = part.strip().partition("-")
        number = int(last[1:]) - int(first[1:]) + 1 if last else 1
        count += number * (2 if first.startswith("d") else 1)
    return count


def base(name):
    """The name without its condition, and whether it has one."""
    plain = name if name in ("subs", "adds", "movs") else re.sub("(" + "|".join(CONDITIONS) + ")$", "", name)
    return plain, plain != name


def returns(instruction):
    """Whether it loads the program counter from the stack."""
    (name, _), text = base(instruction.name), instruction.operands
    if name in ("pop", "ldmia"):
        return "pc" in text and (name == "pop" or text.startswith("sp!"))
    return name == "ldr" and re.match(r"pc, \[sp\], #", text) is not None


def grown(instruction):
    """By how many bytes the stack grows; negative if it shrinks."""
    (name, _), text = base(instruction.name), instruction.operands
    if name in ("push", "vpush"):
        return 4 * registers(text)
    if name in ("pop", "vpop"):
        return -4 * registers(text)
    if name in ("stmdb", "vstmdb") and text.startswith("sp!"):
        return 4 * registers(text)
    if name in ("ldmia", "vldmia") and text.startswith("sp!"):
        return -4 * registers(text)
    if name in ("sub", "subw", "add", "addw") and re.match(r"sp\b", text):
        number = re.fullmatch(r"sp,(?: sp,)? #(\d+)", text)
        if not number:
            raise Refused(f"a computed stack pointer: {instruction}")
        return int(number[1]) if name.startswith("sub") else -int(number[1])
    if indexed := re.search(r"\[sp, #(-?\d+)\]!|\[sp\], #(-?\d+)", text):
        return -int(indexed[1] or indexed[2])
    if re.match(r"sp\b", text) and not READS_FIRST.match(name):
        raise Refused(f"a computed stack pointer: {instruction}")
    return 0


def moved(instruction):
    """By how much the stack is deeper at the next instruction of the function."""
    by = grown(instruction)
    if by != 0 and base(instruction.name)[1]:
        # Either it returns, or it is not executed.
        if not returns(instruction):
            raise Refused(f"a stack pointer that moves on a condition: {instruction}")
        return 0
    return by


def jump(target, code, others):
    """A branch inside the function, or to another one, whose return is that of this one."""
    return ([], [target, *others], False) if target in code else ([target], others, True)


class Program:
    def __init__(self, elf, objdump, calls):
        self.functions, self.memory = disassemble(elf, objdump)
        self.calls = calls
        self.bounds = {}
        self.open = []

    def named(self, name):
        return next((at for at, (known, _) in self.functions.items() if known == name), None)

    def bound(self, start):
        """Of a function and all that it calls: the most bytes, the calls that need them, and whether it ever returns."""
        if start in self.bounds:
            return self.bounds[start]
        if start not in self.functions:
            raise Refused(f"a call to {start:#x}, where no function starts")
        name, code = self.functions[start]
        if start in self.open:
            cycle = [self.functions[at][0] for at in self.open[self.open.index(start) :]]
            raise Refused(f"a cycle of calls: {' > '.join([*cycle, name])}")
        self.open.append(start)
        try:
            most, path, comes_back = self.walk(start, code)
        except Refused as why:
            raise Refused(f"{why}\n  in {name}") if "\n  in " not in str(why) else why
        self.open.pop()
        self.bounds[start] = most, [name, *path], comes_back
        return self.bounds[start]

    def walk(self, start, code):
        """Follows every branch of a function: see `bound`."""
        depths, work, most, path, comes_back = {}, [(start, 0)], 0, [], False
        while work:
            address, depth = work.pop()
            if depths.setdefault(address, depth) != depth:
                raise Refused(f"two depths of the stack at {address:#x}")
            if address not in code:
                raise Refused(f"no instruction at {address:#x}")
            instruction = code[address]
            calls, targets, leaves = self.flow(self.functions[start][0], instruction, code)
            depth += moved(instruction)
            most = max(most, depth)
            known = [self.bound(callee) for callee in calls]
            for below, its_path, _ in known:
                if depth + below > most:
                    most, path = depth + below, its_path
            goes_on = not known or any(returns for _, _, returns in known)
            comes_back |= leaves and goes_on
            if goes_on or instruction.name not in CALLS:
                work.extend((target, depth) for target in targets if depths.get(target) != depth)
        return most, path, comes_back

    def flow(self, function, instruction, code):
        """The functions that an instruction calls or jumps to, the addresses in this one that may be next, and whether it may
        go back to the caller, by itself or by the function that it jumps to."""
        name, text = instruction.name, instruction.operands
        after = instruction.address + instruction.size
        target = TARGET.search(text)
        if name in CALLS:
            return [int(target[1], 16)] if target else self.trusted(function, instruction), [after], False
        if name in ("tbb", "tbh"):
            return [], self.table(instruction, code), False
        if name in ("cbz", "cbnz") or (name[0] == "b" and name[1:] in CONDITIONS):
            return jump(int(target[1], 16), code, [after])
        if name == "b":
            return jump(int(target[1], 16), code, [])
        if name == "bx" or (name.startswith("bx") and name[2:] in CONDITIONS):
            if text != "lr":
                raise Refused(f"a jump through a register: {instruction}")
            return [], [] if name == "bx" else [after], True
        if name == "udf":
            return [], [], False
        if returns(instruction):
            return [], [after] if base(name)[1] else [], True
        if re.search(r"\bpc\b", text.split(",")[0]) or ("{" in text and "pc" in text):
            raise Refused(f"a jump that is computed: {instruction}")
        return [], [after], False

    def trusted(self, function, instruction):
        """Where a call through a register goes."""
        for caller, callees in self.calls:
            found = [at for at, (name, _) in self.functions.items() if re.search(callees, name)]
            if re.search(caller, function) and found:
                return found
        raise Refused(f"a call through a register: {instruction}")

    def table(self, instruction, code):
        """The targets of a table of branches, which lies behind it: as far as the first of them."""
        size = 1 if instruction.name == "tbb" else 2
        base = instruction.address + instruction.size
        targets, at = [], base
        while at < min(targets, default=at + 1) and all(byte in self.memory for byte in range(at, at + size)):
            entry = int.from_bytes(bytes(self.memory[at + i] for i in range(size)), "little")
            target = base + 2 * entry
            if target not in code:
                # Between the last entry and the first target there may be a byte to fill up.
                if targets and min(targets) - at < 4:
                    break
                raise Refused(f"a table of branches with an entry to {target:#x}: {instruction}")
            targets.append(target)
            at += size
        return targets


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("elf", help="a linked program with its local symbols")
    parser.add_argument("--root", action="append", required=True, help="a function that is called from outside")
    parser.add_argument("--calls", action="append", default=[], help="where the calls through a register of a function go")
    parser.add_argument("--objdump", default="arm-none-eabi-objdump")
    parser.add_argument("--path", action="store_true", help="print the calls that need the most")
    options = parser.parse_args()
    sys.setrecursionlimit(10000)
    program = Program(options.elf, options.objdump, [calls.split("=", 1) for calls in options.calls])
    status = 0
    for root in options.root:
        start = program.named(root)
        if start is None:
            print(f"{root}: no such function in {options.elf}", file=sys.stderr)
            return 2
        try:
            program.open.clear()
            most, path, _ = program.bound(start)
        except Refused as why:
            print(f"{root}: {why}", file=sys.stderr)
            status = 1
            continue
        print(f"{root}: {most}")
        if options.path:
            print("".join(f"    {name}\n" for name in path), end="")
    return status


if __name__ == "__main__":
    sys.exit(main())
