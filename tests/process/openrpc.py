"""What marchd --openrpc says is held to what a daemon answers.

openrpc.py protocol OPENRPC PROTOCOL.MD         the page's table of methods has the same methods, parameters and members
openrpc.py answers OPENRPC ANSWERS EVENTS       every answer and event is as described, and everything described is told
openrpc.py params OPENRPC SOCKET JOB            the daemon refuses what the description does not allow, and reads all
                                                else; the job is one that is not over
openrpc.py sources OPENRPC FILE.c...            every parameter that the code reads is described
"""

import json
import re
import socket
import sys

# Members that cannot be seen as null, or at all, in a short test on one machine.
UNSEEN = {
    "root.id null": "a root has a marker, or is away at the daemon's start",
    "phase_event.phase_progress null": "a worker that does not know how far it is",
    "job.show.document null": "somebody else's job: daemon_rights_test",
}


class Book:
    """The document, and what of its schemas was seen."""

    def __init__(self, path):
        with open(path, encoding="utf-8") as file:
            self.document = json.load(file)
        self.methods = {method["name"]: method for method in self.document["methods"]}
        self.schemas = self.document["components"]["schemas"]
        self.seen = set()
        self.faults = []

    def all_places(self):
        """Every property, and every property as null, that the document describes."""
        named = dict(self.schemas)
        for name, method in self.methods.items():
            named[name] = method["result"]["schema"]
        for name, schema in named.items():
            for key, member in schema.get("properties", {}).items():
                yield f"{name}.{key}"
                if any(part.get("type") == "null" for part in member.get("anyOf", [])):
                    yield f"{name}.{key} null"

    def check(self, value, schema, place, name):
        """`name` is of the schema that has the properties, for what was seen."""
        if "$ref" in schema:
            name = schema["$ref"].rpartition("/")[2]
            self.check(value, self.schemas[name], place, name)
            return
        for word in ("anyOf", "oneOf"):
            if word in schema:
                self.check_choice(value, schema[word], place, name)
                return
        if not has_type(value, schema["type"]):
            self.faults.append(f"{place}: expected {schema['type']}, got {json.dumps(value)[:80]}")
        elif "enum" in schema and value not in schema["enum"]:
            self.faults.append(f"{place}: expected one of {schema['enum']}, got {value!r}")
        elif "minimum" in schema and value < schema["minimum"] or "maximum" in schema and value > schema["maximum"]:
            self.faults.append(f"{place}: {value} is out of bounds")
        elif schema["type"] == "array":
            for i, element in enumerate(value):
                self.check(element, schema["items"], f"{place}[{i}]", name)
        elif "properties" in schema:
            self.check_object(value, schema, place, name)

    def check_choice(self, value, choices, place, name):
        before = len(self.faults)
        for choice in choices:
            seen = set(self.seen)
            self.check(value, choice, place, name)
            if len(self.faults) == before:
                return
            told = self.faults[before:]
            del self.faults[before:]
            self.seen = seen
        self.faults.append(f"{place}: none of {len(choices)} choices: {json.dumps(value)[:200]}: {told}")

    def check_object(self, value, schema, place, name):
        for key in schema["required"]:
            if key not in value:
                self.faults.append(f"{place}: {key} is missing")
        for key, member in value.items():
            if key not in schema["properties"]:
                self.faults.append(f"{place}: {key} is not described")
                continue
            self.seen.add(f"{name}.{key}" + (" null" if member is None else ""))
            self.seen.add(f"{name}.{key}")
            self.check(member, schema["properties"][key], f"{place}.{key}", name)


def has_type(value, kind):
    if kind == "integer":
        return isinstance(value, int) and not isinstance(value, bool)
    if kind == "number":
        return isinstance(value, (int, float)) and not isinstance(value, bool)
    return isinstance(value, {"string": str, "boolean": bool, "object": dict, "array": list, "null": type(None)}[kind])


def check_answers(book, answers, events):
    told = set()
    with open(answers, encoding="utf-8") as file:
        for line in file:
            method, answer = line.rstrip("\n").split("\t", 1)
            message = json.loads(answer)
            if "result" in message:
                told.add(method)
                book.check(message["result"], book.methods[method]["result"]["schema"], method, method)
            else:
                codes = [fault["code"] for fault in book.document["components"]["errors"].values()]
                if message["error"]["code"] not in codes:
                    book.faults.append(f"{method}: the code of {answer} is not described")
    with open(events, encoding="utf-8") as file:
        for line in file:
            message = json.loads(line)
            if message.get("method") == "event":
                book.check(message["params"], {"$ref": "#/components/schemas/event"}, "event", "event")
    for name in sorted(set(book.methods) - told):
        book.faults.append(f"{name}: never answered with a result")
    for place in book.all_places():
        if place not in book.seen and place not in UNSEEN:
            book.faults.append(f"{place}: described, and never told")


class Daemon:
    def __init__(self, path):
        self.socket = socket.socket(socket.AF_UNIX)
        self.socket.connect(path)
        self.lines = self.socket.makefile("rb")

    def ask(self, method, params):
        request = {"jsonrpc": "2.0", "id": 1, "method": method, "params": params}
        self.socket.sendall(json.dumps(request).encode() + b"\n")
        return json.loads(self.lines.readline())


def error_of(answer):
    return answer.get("error", {"code": 0, "message": ""})


def right_value(schema):
    """A value that the schema allows."""
    return schema["enum"][0] if "enum" in schema else {"integer": 0, "string": "x"}.get(schema.get("type"), {})


def wrong_values(schema):
    """Values that the schema does not allow."""
    yield {"nonsense": 1} if schema.get("type") != "object" else 7
    for bound, step in (("minimum", -1), ("maximum", 1)):
        if bound in schema:
            yield schema[bound] + step
    if "enum" in json.dumps(schema):
        yield "nonsense"


def check_params(book, path, job):
    for name, method in book.methods.items():
        first = {}
        for param in method["params"]:
            if param["required"]:
                first[param["name"]] = int(job) if param["name"] == "id" else right_value(param["schema"])
        error = error_of(Daemon(path).ask(name, {**first, "nonsense_of_a_test": 1}))
        if error["code"] != -32602 or "nonsense_of_a_test" not in error["message"]:
            book.faults.append(f"{name}: an unknown parameter is answered with {error}")
        for param in method["params"]:
            for value in wrong_values(param["schema"]):
                params = {**first, param["name"]: value}
                error = error_of(Daemon(path).ask(name, params))
                if error["code"] != -32602 or f"params.{param['name']}" not in error["message"]:
                    book.faults.append(f"{name}: {params} is answered with {error}")
            for bound in {"minimum", "maximum"} & set(param["schema"]) if param["name"] != "id" else []:
                value = param["schema"][bound]
                error = error_of(Daemon(path).ask(name, {**first, param["name"]: value}))
                if f"params.{param['name']}" in error["message"]:
                    book.faults.append(f"{name}: {param['name']} {value} is answered with {error}")


def check_sources(book, files):
    known = {param["name"] for method in book.methods.values() for param in method["params"]}
    ways = (r"json_node_child\(&request->params, ", r"\w*read_\w+\(request, ")
    reads = re.compile(rf'(?:{"|".join(ways)})"(\w+)"')
    count = 0
    for path in files:
        with open(path, encoding="utf-8") as file:
            for key in reads.findall(file.read()):
                count += 1
                if key not in known:
                    book.faults.append(f"{path} reads params.{key}, which no method describes")
    if count < 10:
        book.faults.append(f"only {count} parameters are read by {' '.join(files)}")


def paragraph(text, name):
    return re.search(rf"^- \*{name}\*(?::| has).*?\n(.*?)\n- ", text, re.M | re.S).group(1)


def check_protocol(book, path):
    with open(path, encoding="utf-8") as file:
        part = file.read().split("## Clients to the daemon", 1)[1].split("\n## ", 1)[0]
    rows = {}
    for line in part.splitlines():
        cells = re.split(r" \|(?= )", line.removesuffix(" |"))
        if len(cells) == 3 and cells[0].startswith("| `"):
            for name in re.findall(r"`([a-z_.]+)`", cells[0]):
                rows[name] = cells
    for name in sorted(set(rows) ^ set(book.methods)):
        book.faults.append(f"{name}: in the {'page' if name in rows else 'description'} alone")
    for name in sorted(set(rows) & set(book.methods)):
        words = set(re.findall(r"\w+", rows[name][1]))
        for param in book.methods[name]["params"]:
            if param["name"] not in words:
                book.faults.append(f"{path}: {name} has the parameter {param['name']}, too")
        words = set(re.findall(r"\w+", rows[name][2]))
        for key in book.methods[name]["result"]["schema"].get("properties", {}):
            if key not in words | set(book.schemas["job"]["properties"]):
                book.faults.append(f"{path}: the result of {name} has {key}, too")
    for name in ("job", "frame", "worker"):
        told = paragraph(part, name)
        told += paragraph(part, "accuracy") if "*accuracy*" in told else ""
        for key in book.schemas[name]["properties"]:
            if not re.search(rf"\b{key}\b", told):
                book.faults.append(f"{path}: *{name}* has {key}, too")


def main():
    book = Book(sys.argv[2])
    if sys.argv[1] == "answers":
        check_answers(book, *sys.argv[3:])
    elif sys.argv[1] == "params":
        check_params(book, *sys.argv[3:])
    elif sys.argv[1] == "sources":
        check_sources(book, sys.argv[3:])
    else:
        check_protocol(book, *sys.argv[3:])
    for fault in book.faults:
        print(fault, file=sys.stderr)
    sys.exit(1 if book.faults else 0)


main()
