#!/usr/bin/env python3
"""Whether the pages hold together: links lead to files and headings that are there, every page stands in the contents, sentences are short.

Usage: links.py   (from anywhere; needs nothing but Python)
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
CONTENTS = DOCS / "README.md"
# Sentences of more words, and the share of them that is too many.
WORDS, SHARE = 30, 0.05


def prose(text):
    """A page without its blocks of code and tables."""
    text = re.sub(r"^```.*?^```$", "", text, flags=re.M | re.S)
    text = re.sub(r"<!--.*?-->", "", text, flags=re.S)
    return "\n".join(line for line in text.splitlines() if not line.startswith(("|", "    ")))


def anchors(path):
    """The anchors of a page's headings, as those who show Markdown make them."""
    text = re.sub(r"^```.*?^```$", "", path.read_text(), flags=re.M | re.S)
    found = set(re.findall(r'<a id="([^"]+)">', text))
    for heading in re.findall(r"^#+ (.*)$", text, re.M):
        plain = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading).lower()
        found.add(re.sub(r"[^\w\- ]", "", plain).strip().replace(" ", "-"))
    return found


def dead_links(page):
    text = re.sub(r"^```.*?^```$", "", page.read_text(), flags=re.M | re.S)
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if target.startswith(("http://", "https://", "/")):
            continue
        name, _, anchor = target.partition("#")
        path = (page.parent / name).resolve() if name else page
        if not path.exists():
            yield f"{page.relative_to(ROOT)}: there is no {target}"
        elif anchor and path.suffix == ".md" and anchor not in anchors(path):
            yield f"{page.relative_to(ROOT)}: {path.name} has no heading #{anchor}"


def sentences(text):
    text = re.sub(r"`[^`]*`", "code", prose(text))
    text = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", text)
    # A heading and an item of a list are sentences of their own.
    parts = re.split(r"(?:[.:;!?](?=\s|$))|\n\s*\n|\n\s*(?:[-*]|\d+\.)\s|^#+ ", text, flags=re.M)
    return [part.split() for part in parts if part.split()]


def main():
    pages = [ROOT / "README.md", *sorted(DOCS.glob("*.md")), *sorted((DOCS / "decisions").glob("*.md"))]
    faults = [fault for page in pages for fault in dead_links(page)]
    listed = set(re.findall(r"\]\((\w[\w-]*\.md)\)", CONTENTS.read_text()))
    for page in DOCS.glob("*.md"):
        if page != CONTENTS and page.name not in listed:
            faults.append(f"docs/README.md does not list {page.name}")
    book = [ROOT / "README.md", *DOCS.glob("*.md")]
    counted = [len(words) for page in book for words in sentences(page.read_text())]
    long = sum(count > WORDS for count in counted)
    print(f"{len(pages)} pages, {len(counted)} sentences, {long} of more than {WORDS} words ({100 * long / len(counted):.1f} %)")
    if long > SHARE * len(counted):
        faults.append(f"{long} sentences have more than {WORDS} words")
    if faults:
        sys.exit("\n".join(faults))


main()
