"""Nodes of the graph are made one after the other, in an order that the source says. C leaves open in which order the
arguments of a call, or both sides of an operator, are computed, and compilers differ; of two products in a sum the later
one is fused, so that bits would hang on who compiled the program. No call and no operator has two parts that make nodes.
(Lists in braces are computed from the first to the last by all compilers.) Argument: the source folder."""

import pathlib
import re
import sys

CALL = re.compile(r"\b([A-Za-z_]\w*)\s*\(")
DEFINITION = re.compile(r"^((?:static |inline |const )*)([A-Za-z_]\w*) (\*?)([A-Za-z_]\w*)\(([^;{}]*?)\)\s*\{", re.M)
STRUCT = re.compile(r"typedef\s+(?:struct|union)\s*\w*\s*\{((?:[^{}]|\{[^{}]*\})*)\}\s*(\w+)\s*;")
NO_CODE = re.compile(r"/\*.*?\*/|//[^\n]*|\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])*'", re.S)
WORDS = {"if", "while", "for", "switch", "return", "sizeof"}
# Both sides are computed, in any order. (&&, || and ?: say an order; a comma stands between arguments.)
OPERATOR = re.compile(r"\s*(==|!=|<=|>=|\+|-|\*|/|%|<|>|&(?!&)|\|(?!\|)|\^)\s*(?=[\w(])")


def blanked(text):
    return NO_CODE.sub(lambda m: re.sub(r"[^\n]", " ", m.group(0)), text)


def end_of(text, at):
    """Behind the bracket that closes the one at `at`; the places of commas directly inside."""
    deep, commas = 0, []
    for k in range(at, len(text)):
        if text[k] in "([{":
            deep += 1
        elif text[k] in ")]}":
            deep -= 1
            if deep == 0:
                return k + 1, commas
        elif text[k] == "," and deep == 1:
            commas.append(k)
    return len(text), commas


def types_of_nodes(texts):
    """ir_node, and what holds some."""
    structs = STRUCT.findall("\n".join(texts.values()))
    types = {"ir_node"}
    while True:
        more = {name for body, name in structs
                if name not in types and any(re.search(r"\b%s\s+\w" % t, body) for t in types)}
        if not more:
            return types
        types |= more


def definitions(texts):
    """(file, name): type and the names that it calls."""
    found = {}
    for file, text in texts.items():
        for m in DEFINITION.finditer(text):
            body = text[m.end():end_of(text, m.end() - 1)[0]]
            far = "static" not in m.group(1) or file.endswith(".h")
            found[file, m.group(4)] = (m.group(2) + m.group(3), set(CALL.findall(body)), far)
    return found


def makers(texts):
    """For each file the names that make nodes and return them."""
    defined, types = definitions(texts), types_of_nodes(texts)
    making = {key for key in defined if key[1] == "intern"}
    while True:
        far = {name for file, name in making if defined[file, name][2]}
        own = {}
        for file, name in defined:
            own.setdefault(file, set()).add(name)
        makes = {file: {n for f, n in making if f == file} | (far - own.get(file, set())) for file in texts}
        more = {key for key, (_, calls, _) in defined.items() if key not in making and calls & makes[key[0]]}
        if not more:
            break
        making |= more
    types_of = {}
    for (file, name), (kind, _, far) in defined.items():
        types_of.setdefault(name, set()).add(kind)
    return {file: {n for n in names if types_of[n] & types} for file, names in makes.items()}


def faults(texts):
    for file, names in makers(texts).items():
        text = texts[file]

        def makes(part):
            return any(m.group(1) in names for m in CALL.finditer(part))

        for m in CALL.finditer(text):
            line = text.count("\n", 0, m.start()) + 1
            end, commas = end_of(text, m.end() - 1)
            places = [m.end() - 1, *commas, end - 1]
            parts = [text[a + 1:b] for a, b in zip(places, places[1:])]
            if m.group(1) not in WORDS and sum(map(makes, parts)) > 1:
                yield "%s:%d: two arguments of %s make nodes: make one in a statement before" % (file, line, m.group(1))
            other = m.group(1) in names and OPERATOR.match(text, end)
            if other:
                beyond = CALL.match(text, other.end())
                if beyond and beyond.group(1) in names:
                    yield "%s:%d: both sides of %s make nodes: make one in a statement before" % (file, line, other.group(1))


def plant(texts):
    """Faults of its own, which it must see, and what is none."""
    file = "generator/lower/planted.c"
    good = "static ir_node good(ir *g) {\n  const ir_node b = ir_constant(g, 2);\n  return ir_add(g, ir_constant(g, 1), b);\n}\n"
    bad = "static ir_node bad(ir *g) {\n  return ir_add(g, ir_constant(g, 1), good(g));\n}\n"
    same = "static bool same(ir *g) {\n  return good(g) == ir_constant(g, 2);\n}\n"
    pair = "typedef struct pair {\n  ir_node of[2];\n} pair;\nstatic pair both(ir *g) {\n  return (pair){{good(g), good(g)}};\n}\n"
    taken = "static int taken(ir *g) {\n  return sum_of_pairs(both(g), both(g));\n}\n"
    for text, count in ((good, 0), (good + bad, 1), (good + same, 1), (good + pair, 0), (good + pair + taken, 1)):
        found = [f for f in faults({**texts, file: blanked(text)}) if f.startswith(file)]
        if len(found) != count:
            sys.exit("FAILED: of %d planted faults it sees %s in\n%s" % (count, found, text))


def main():
    root = pathlib.Path(sys.argv[1])
    paths = [p for p in sorted(root.glob("generator/*/*.[ch]")) if p.parent.name != "playground"]
    texts = {str(p.relative_to(root)): blanked(p.read_text()) for p in paths}
    found = list(faults(texts))
    if found:
        sys.exit("\n".join(["FAILED:", *found]))
    some = {name: texts[name] for name in texts if name.startswith(("generator/ir/ir.", "generator/lower/lowering.h"))}
    plant(some)
    print("ok: in %d files nodes are made one at a time" % len(texts))


main()
