"""Makes every number and picture of docs/papers.md.

    python3 docs/data/make.py TRACKLOOM [FOLDER]

TRACKLOOM is a release build of the program. The campaigns of its preset `papers` are left in FOLDER (a temporary one unless said); what no
campaign can say is measured beside them, two at a time; then the tables of docs/data are written, and the pictures of docs/pictures drawn. Campaigns give the same bytes on every machine. Times and memory are those of the machine at hand: liang2009-growth, liang2009-space,
cai-fuzzy-times, wang-bat-times and the rows "time". One row is one number, one file a preset.
"""

import csv
import json
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import cai_fuzzy
import huo2008
import liang2009
import wang_bat
from campaign import COLUMNS

DATA = Path(__file__).resolve().parent
ROOT = DATA.parent.parent
PAPERS = [liang2009, cai_fuzzy, huo2008, wang_bat]
# Of each table what prints it: an example or a benchmark, and its arguments.
PRINTED = {
    "liang2009-growth": ("liang_growth",),
    "cai-fuzzy-errors": ("cai_tables", "--genetic"),
    "cai-fuzzy-times": ("cai_tables", "10", "--times"),
    "wang-bat-times": ("sonar",),
}


def main(trackloom, folder):
    programs = built()
    with ThreadPoolExecutor(2) as pool:
        beside = pool.submit(made_beside, trackloom, folder, programs)
        # The last of the alphabet take longest.
        names = sorted(campaigns(trackloom), reverse=True)
        runs = [pool.submit(finished, trackloom, "run", "--preset", name, "--out", folder / name) for name in names]
        for run in runs:
            run.result()
        rows = [row for paper in PAPERS for row in paper.campaign_rows(folder)]
        write(rows + beside.result())
    finished(programs["paper_pictures"], folder, DATA.parent / "pictures")


def campaigns(trackloom):
    """Names of the presets that the tables are of: what `trackloom run --preset papers` runs one after the other."""
    for path in DATA.glob("*.csv"):
        found = subprocess.run([trackloom, "presets", path.stem], capture_output=True, text=True)
        if found.returncode == 0 and "grid" in json.loads(found.stdout):
            yield path.stem


def built():
    """Programs of the domain by name: examples, and the benchmark in the same build."""
    told = finished("cargo", "build", "--release", "--locked", "--workspace", "--examples", "--bench", "sonar",
                    "--message-format", "json")
    artefacts = [json.loads(line) for line in told.splitlines()]
    return {found["target"]["name"]: found["executable"] for found in artefacts if found.get("executable")}


def made_beside(trackloom, folder, programs):
    """The rows of what is not a campaign; what examples print is left in the folder, too."""
    rows = []
    for table, (name, *arguments) in PRINTED.items():
        text = finished(programs[name], *arguments)
        (folder / f"{table}.csv").write_text(text)
        rows += csv.DictReader(text.splitlines())
    return rows + list(liang2009.of_jobs(trackloom)) + list(huo2008.plain_rows())


def finished(*command):
    """What a command prints; what it says on the way is not held back."""
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True, cwd=ROOT).stdout


def write(rows):
    tables = {}
    for row in rows:
        tables.setdefault(row["preset"], []).append(row)
    for preset, found in tables.items():
        with open(DATA / f"{preset}.csv", "w", newline="") as file:
            writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
            writer.writeheader()
            writer.writerows(found)


if __name__ == "__main__":
    program = Path(sys.argv[1]).resolve()
    if len(sys.argv) > 2:
        Path(sys.argv[2]).mkdir(parents=True, exist_ok=True)
        main(program, Path(sys.argv[2]).resolve())
    else:
        with tempfile.TemporaryDirectory() as made:
            main(program, Path(made))
