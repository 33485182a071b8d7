#!/usr/bin/env python3
"""What libasterix reads of the ASTERIX files that trackloom's encoder writes, beside the values that were given to it.

Usage: tests/formats/read_asterix.py FOLDER, the folder being what `TRACKLOOM_ASTERIX_OUT` named for the test `files_for_other_programs`.
"""

import json
import math
import sys
from pathlib import Path

from asterix.base import Bits, ParsingMode, RawDatablock
from asterix.generated import Cat_001_1_4, Cat_021_2_7, Cat_034_1_29, Cat_048_1_32, Cat_062_1_21

NM, FOOT, DAY_S = 1852.0, 0.3048, 86400
compared = 0


def records(path, category):
    """Every record of a file."""
    for block in RawDatablock.parse(Bits.from_bytes(path.read_bytes())):
        assert block.get_category() == category.cv_category
        rest = block.get_raw_records()
        while len(rest):
            record, rest = parsed(rest, category.cv_uap)
            yield record


def parsed(octets, uap):
    """A record and what follows it. Of category 001 it is read as a plot and as a track: as that of which it says to be."""
    kinds = uap.cv_uaps.values() if hasattr(uap, "cv_uaps") else [uap.cv_record]
    ways = [kind.parse(ParsingMode.StrictParsing, octets) for kind in kinds]
    ways = [way for way in ways if not isinstance(way, ValueError)]
    return next(way for way in ways if len(kinds) == 1 or is_what_it_says(way[0]))


def is_what_it_says(record):
    is_track = "161" in type(record).cv_items_dict
    return (value(record, "020", "TYP") == 1) == is_track


def value(record, *names):
    """A value by the names of item and subitems: a quantity, a text or a number; None where it lacks."""
    found = record
    for name in names:
        found = found.get_item(name)
        if found is None:
            return None
        found = found.variation
    content = getattr(found, "content", None)
    if content is None:
        return found
    for read in ("as_quantity", "as_string"):
        if hasattr(content, read):
            return getattr(content, read)()
    return content.as_uint()


def same(what, found, wanted, step=0.0):
    """Equal, or within half a step of it."""
    global compared
    compared += 1
    if wanted is None or found is None or not step:
        assert found == wanted, (what, found, wanted)
    else:
        assert abs(found - wanted) <= step * 0.5000001 + 1e-9, (what, found, wanted, step)


def pair(what, record, names, wanted, step):
    for name, part in zip(names[1], wanted or (None, None)):
        same(what, value(record, *names[0], name), part, step)


def polar(what, record, item, names, wanted, step):
    """A length and an angle in 2^-16 of a turn."""
    length, angle = wanted or (None, None)
    same(what, value(record, item, names[0]), length and length / NM, step)
    found = value(record, item, names[1])
    if angle is None:
        return same(what, found, None)
    apart = (found - math.degrees(angle) + 180) % 360 - 180
    same(what, apart, 0.0, 360 / 65536)


def source(record, wanted):
    same("source", [value(record, "010", "SAC"), value(record, "010", "SIC")], wanted["source"])


def callsign(wanted):
    return wanted and wanted.ljust(8)


def octal(wanted):
    return None if wanted is None else f"{wanted:04o}"


def flag(found):
    return bool(found)


def track(record, wanted):
    source(record, wanted)
    same("time", value(record, "070"), wanted["time_s"] % DAY_S, 1 / 128)
    same("number", value(record, "040"), wanted["number"])
    pair("place", record, (["105"], ["LAT", "LON"]), (wanted["lat_deg"], wanted["lon_deg"]), 180 / 2**25)
    pair("plane", record, (["100"], ["X", "Y"]), wanted["place_m"], 0.5)
    pair("velocity", record, (["185"], ["VX", "VY"]), wanted["velocity_mps"], 0.25)
    same("mode A", value(record, "060", "MODE3A"), octal(wanted["mode_a"]))
    same("callsign", value(record, "245", "CHR"), callsign(wanted["callsign"]))
    same("address", value(record, "380", "ADR"), wanted["address"])
    same("downlinked", value(record, "380", "ID"), callsign(wanted["callsign"]))
    levels = wanted["pressure_altitude_m"]
    same("level", value(record, "136"), levels and levels / FOOT / 100, 0.25)
    height = wanted["geometric_altitude_m"]
    same("height", value(record, "130"), height and height / FOOT, 6.25)
    rate = wanted["vertical_rate_mps"]
    same("rate", value(record, "220"), rate and rate / FOOT * 60, 6.25)
    same("tentative", value(record, "080", "CNF"), int(wanted["status"] == "tentative"))
    same("end", flag(value(record, "080", "TSE")), wanted["ends"])
    same("begin", flag(value(record, "080", "TSB")), wanted["begins"])
    same("coasted", flag(value(record, "080", "CST")), wanted["status"] == "coasted")
    accuracy(record, wanted)


def accuracy(record, wanted):
    covariance = wanted["covariance_m2"]
    if covariance:
        xx, xy, yy = covariance
        pair("sigma", record, (["500", "APC"], ["X", "Y"]), (math.sqrt(xx), math.sqrt(yy)), 0.5)
        same("covariance", value(record, "500", "COV"), math.copysign(math.sqrt(abs(xy)), xy), 0.5)
    pair("sigma of velocity", record, (["500", "ATV"], ["X", "Y"]), wanted["velocity_sigma_mps"], 0.25)


def transponder(record, wanted, level):
    same("mode A", value(record, "070", "MODE3A"), octal(wanted["mode_a"]))
    feet = wanted["level_ft"]
    same("level", value(record, "090", level), None if feet is None else feet / 100)


def plot_048(record, wanted):
    source(record, wanted)
    same("time", value(record, "140"), wanted["time_s"] % DAY_S, 1 / 128)
    same("type", value(record, "020", "TYP"), wanted["detection"])
    polar("place", record, "040", ("RHO", "THETA"), wanted["place"], 1 / 256)
    transponder(record, wanted, "FL")
    same("address", value(record, "220"), wanted["address"])
    same("callsign", value(record, "240"), callsign(wanted["callsign"]))
    same("number", value(record, "161", "TRN"), wanted["number"])
    motion("200", ("GSP", "HDG"), record, wanted)
    if wanted["number"] is not None:
        same("tentative", flag(value(record, "170", "CNF")), wanted["is_tentative"])
        same("end", flag(value(record, "170", "TRE")), wanted["ends"])


def motion(item, names, record, wanted):
    polar("motion", record, item, names, wanted["motion"], 2**-14)


def plot_001(record, wanted):
    source(record, wanted)
    same("time", value(record, "141"), wanted["time_s"] % DAY_S % 512, 1 / 128)
    same("type", value(record, "020", "SSRPSR"), wanted["detection"])
    polar("place", record, "040", ("RHO", "THETA"), wanted["place"], 1 / 128)
    transponder(record, wanted, "HGT")
    same("is a track", value(record, "020", "TYP"), int(wanted["number"] is not None))
    if wanted["number"] is not None:
        same("number", value(record, "161"), wanted["number"])
        same("end", flag(value(record, "170", "TRE")), wanted["ends"])
        motion("200", ("GSP", "HDG"), record, wanted)


def adsb(record, wanted):
    source(record, wanted)
    same("time", value(record, "073"), wanted["time_s"] % DAY_S, 1 / 128)
    pair("place", record, (["131"], ["LAT", "LON"]), (wanted["lat_deg"], wanted["lon_deg"]), 180 / 2**30)
    same("address", value(record, "080"), wanted["address"])
    height = wanted["geometric_altitude_m"]
    same("height", value(record, "140"), height and height / FOOT, 6.25)
    feet = wanted["level_ft"]
    same("level", value(record, "145"), None if feet is None else feet / 100)
    same("ground", flag(value(record, "040", "GBS")), wanted["is_on_ground"])
    same("accuracy", value(record, "090", "NACP"), wanted["nacp"])
    same("mode A", value(record, "070", "MODE3A"), octal(wanted["mode_a"]))
    same("callsign", value(record, "170"), callsign(wanted["callsign"]))
    motion("160", ("GS", "TA"), record, wanted)


def mark(record, wanted):
    source(record, wanted)
    same("time", value(record, "030"), wanted["time_s"] % DAY_S, 1 / 128)
    same("type", value(record, "000"), wanted["kind"])
    same("sector", value(record, "020"), wanted["sector"] * 360 / 256)
    same("rotation", value(record, "041"), wanted["rotation_s"], 1 / 128)
    lat, lon, height = wanted["site"] or (None, None, None)
    pair("site", record, (["120"], ["LAT", "LON"]), (lat, lon), 180 / 2**23)
    same("height", value(record, "120", "HGT"), height, 1)


CATEGORIES = {
    "062": (Cat_062_1_21, track),
    "048": (Cat_048_1_32, plot_048),
    "001": (Cat_001_1_4, plot_001),
    "021": (Cat_021_2_7, adsb),
    "034": (Cat_034_1_29, mark),
}


def main(folder):
    for name, (category, compare) in CATEGORIES.items():
        wanted = json.loads((folder / f"{name}.json").read_text())
        found = list(records(folder / f"{name}.ast", category))
        assert len(found) == len(wanted) > 0, (name, len(found), len(wanted))
        for record, values in zip(found, wanted):
            compare(record, values)
        print(f"category {name}: {len(found)} records, {compared} values so far")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
