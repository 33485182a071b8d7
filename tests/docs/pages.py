"""What the pages and the API document say a user can do, taken out of them.

Convention of the pages:
- A fenced block that is `sh`, or has no language and whose lines begin with a program, holds commands. In a block without a language
  what follows three spaces is a description; `#` begins a comment. A command that goes on ends with a backslash or an open quote.
- `trackloom run …` in backticks within a paragraph is a command, too.
- A `json` block with a `kind` is a job file. Others are parts of one: PARTS says of what.
- `…` stands for the id that the answers before have: of the last dataset after `"dataset_id": "`, else of the last job.
- What a `text` block shows is what the command before it prints, line by line.
- A job file is called as the page calls it last before the block, `job.json` where it does not.
- Files that a page names are made beforehand (see run.py); `127.0.0.1:8080` is the service under test.
"""

import json
import re

PROGRAMS = ("trackloom ", "curl ", "cargo ", "tests/", "export ")


def blocks(text):
    """Language and content of each fenced block."""
    return [(match[1].strip(), match[2]) for match in re.finditer(r"^```([^\n]*)\n(.*?)^```$", text, re.M | re.S)]


def items(text):
    """What a page has, in order: ("command", it), ("output", it) or ("json", it, the name of its file)."""
    found = []
    for block in re.finditer(r"^```([^\n]*)\n(.*?)^```$", text, re.M | re.S):
        language, content = block[1].strip(), block[2]
        first = next((line for line in content.splitlines() if line.strip() and not line.startswith("#")), "")
        if language == "sh" or (language == "" and first.startswith(PROGRAMS)):
            found += [("command", command) for command in commands_of_block(content, is_described=language == "")]
        elif language == "text":
            found.append(("output", content))
        elif language == "json":
            names = re.findall(r"`([\w-]+\.json)`", text[:block.start()].rsplit("\n\n", 2)[-2])
            found.append(("json", content.strip(), names[-1] if names else "job.json"))
    prose = re.sub(r"^```.*?^```$", "", text, flags=re.M | re.S)
    return found + [("command", inline) for inline in re.findall(r"`(trackloom run [^`]+)`", prose)]


def commands_of_block(content, is_described):
    found, open_command = [], ""
    for line in content.splitlines():
        if not open_command and (not line.strip() or line.startswith("#")):
            continue
        if is_described:
            line = re.split(r" {3,}", line)[0]
        line = re.sub(r"\s+# .*$", "", line)
        open_command += line.removesuffix("\\") + ("\n" if not line.endswith("\\") else " ")
        if not line.endswith("\\") and open_command.count("'") % 2 == 0:
            found.append(open_command.strip())
            open_command = ""
    return found


def examples(document):
    """Path, name and body of every example of a request body in the API document."""
    for path, item in document["paths"].items():
        for operation in item.values():
            if not isinstance(operation, dict):
                continue
            for media in operation.get("requestBody", {}).get("content", {}).values():
                for name, example in (media.get("examples") or {}).items():
                    yield path, name, json.loads(json.dumps(example["value"]))
