"""Every export is read back by a program of other people's and held against result.json.

Run by `cargo xtask test --only exports`, which installs the readers (requirements.txt) and names the
companion program in SNELLIUS_CLI.
"""

import json
import os
import struct
import subprocess
import sys
import tempfile
import unittest
from html.parser import HTMLParser
from pathlib import Path

import laspy
import numpy as np
import pye57
import pygltflib
import trimesh
from plyfile import PlyData
from pye57 import libe57
from pypcd4 import PointCloud

ROOT = Path(__file__).resolve().parent.parent.parent
FORMATS = "json,ply,vessel-ply,csv,object-csv,pcd,las,e57,glb,stl,obj,html"
MEASURES = ["sigma_x", "sigma_y", "sigma_z", "ray_distance"]
HOSTILE = 'a]]><b>"\'&amp;</title><script>alert(1)</script>\n# x\u0000y'


def snellius(*arguments):
    subprocess.run(
        [os.environ["SNELLIUS_CLI"], *map(str, arguments)], check=True, stderr=subprocess.DEVNULL
    )


def listed(value):
    """What a view of a spot laser and one of a line laser have, as a list."""
    if not value:
        return []
    return value if isinstance(value[0], list) else [value]


class Truth:
    """What result.json says, point by point."""

    def __init__(self, result):
        rows = []
        for number, view in enumerate(result["views"]):
            distances = view["ray_distance"]
            distances = distances if isinstance(distances, list) else [distances]
            points = zip(listed(view["object"]), listed(view["object_sigma"]), distances)
            rows += [[*p, *s, l, view["sweep"], number] for p, s, l in points]
        table = np.array(rows)
        self.places = table[:, :3]
        self.columns = dict(zip([*MEASURES, "scan", "view"], table[:, 3:].T))
        self.vessel = np.array([p for v in result["views"] for p in listed(v["vessel"])])
        self.index = result["media"]["inside"]["value"]
        self.name = result["scan"]


class Exports:
    """A folder of exports and what they ought to hold."""

    def __init__(self, folder):
        self.folder = folder
        self.result = json.loads((folder / "result.json").read_text())
        self.truth = Truth(self.result)

    def path(self, name):
        return str(self.folder / name)

    def bytes(self, name):
        return (self.folder / name).read_bytes()


def setUpModule():
    global CASES, SCRATCH
    SCRATCH = tempfile.TemporaryDirectory()
    scratch = Path(SCRATCH.name)
    for sample in ["tank-paper", "jar", "line"]:
        snellius("reconstruct", ROOT / f"samples/{sample}.zip", "-o", scratch / sample, "-f", FORMATS)
    result = json.loads((scratch / "tank-paper/result.json").read_text())
    result["scan"] = HOSTILE
    result["warnings"] = [HOSTILE]
    result["views"][0]["id"] = HOSTILE
    (scratch / "hostile.json").write_text(json.dumps(result))
    snellius("export", scratch / "hostile.json", "-o", scratch / "hostile", "-f", FORMATS)
    CASES = [Exports(scratch / name) for name in ["tank-paper", "jar", "line", "hostile"]]


def tearDownModule():
    SCRATCH.cleanup()


def for_every_case(test):
    def run(self):
        for case in CASES:
            with self.subTest(case.folder.name):
                test(self, case)

    return run


class ReadBack(unittest.TestCase):
    def assert_says_what_it_is(self, text, truth):
        for part in ["Snellius ", "world frame", f"refractive index inside: {truth.index} (given)"]:
            self.assertIn(part, text)

    def assert_columns(self, found, truth, **tolerance):
        for name, expected in truth.columns.items():
            np.testing.assert_allclose(found[name], expected, err_msg=name, **tolerance)

    @for_every_case
    def test_ply_by_plyfile(self, case):
        ply = PlyData.read(case.path("object.ply"))
        vertex = ply["vertex"]
        self.assertEqual(vertex.count, len(case.truth.places))
        places = np.stack([vertex[axis] for axis in "xyz"], axis=1)
        np.testing.assert_array_equal(places, case.truth.places)
        self.assert_columns(vertex, case.truth, rtol=0)
        self.assert_says_what_it_is("\n".join(ply.comments), case.truth)
        self.assertIn("unit mm", "\n".join(ply.comments))
        wall = PlyData.read(case.path("vessel.ply"))["vertex"]
        places = np.stack([wall[axis] for axis in "xyz"], axis=1)
        np.testing.assert_array_equal(places, case.truth.vessel)

    @for_every_case
    def test_csv_by_numpy(self, case):
        table = np.genfromtxt(
            case.path("object.csv"), delimiter=",", skip_header=4, names=True, encoding="utf-8"
        )
        places = np.stack([table[axis] for axis in "xyz"], axis=1)
        np.testing.assert_array_equal(places, case.truth.places)
        self.assert_columns(table, case.truth, rtol=0)
        text = case.bytes("object.csv").decode()
        self.assert_says_what_it_is(text, case.truth)
        self.assertIn("unit mm", text)

    @for_every_case
    def test_pcd_by_pypcd4(self, case):
        cloud = PointCloud.from_path(case.path("object.pcd"))
        self.assertEqual(cloud.fields, ("x", "y", "z", *MEASURES, "scan", "view"))
        np.testing.assert_allclose(cloud.numpy("xyz"), case.truth.places, rtol=1e-6)
        found = {name: cloud.numpy([name])[:, 0] for name in case.truth.columns}
        self.assert_columns(found, case.truth, rtol=1e-6)
        header = case.bytes("object.pcd").split(b"DATA")[0].decode()
        self.assert_says_what_it_is(header, case.truth)
        self.assertIn("unit mm", header)

    @for_every_case
    def test_las_by_laspy(self, case):
        las = laspy.read(case.path("object.las"))
        self.assertEqual((str(las.header.version), las.header.point_format.id), ("1.4", 6))
        self.assertEqual(las.header.point_count, len(case.truth.places))
        # A tenth of a micrometre is the file's resolution.
        np.testing.assert_allclose(las.xyz, case.truth.places, rtol=0, atol=0.51e-4)
        np.testing.assert_allclose(las.header.mins, case.truth.places.min(axis=0), atol=1e-4)
        self.assert_columns(las, case.truth, rtol=0)
        np.testing.assert_array_equal(las.point_source_id, case.truth.columns["scan"] + 1)
        about, wkt = [
            next(v for v in las.vlrs if v.record_id == record) for record in (3, 2112)
        ]
        self.assert_says_what_it_is(about.record_data_bytes().decode(), case.truth)
        self.assertIn('UNIT["millimetre",0.001]', wkt.string)
        self.assertTrue(las.header.generating_software.startswith("Snellius "))
        self.assertIsNone(las.header.creation_date, "the same bytes tomorrow")

    @for_every_case
    def test_e57_by_pye57(self, case):
        with pye57.E57(case.path("object.e57")) as file:
            self.assertEqual(file.scan_count, 1)
            header = file.get_header(0)
            self.assertEqual(header.point_count, len(case.truth.places))
            self.assert_says_what_it_is(header["description"].value(), case.truth)
            self.assertIn("unit m ", header["description"].value())
            lengths = ["cartesianX", "cartesianY", "cartesianZ"]
            lengths += [f"snellius:{name}" for name in MEASURES]
            names = [*lengths, "snellius:scan", "snellius:view"]
            found = self.e57_fields(file, header, names)
            # The standard's unit is the metre.
            found |= {name: found[name] * 1000 for name in lengths}
            places = np.stack([found[name] for name in lengths[:3]], axis=1)
            np.testing.assert_allclose(places, case.truth.places, rtol=1e-12)
            own = {name.removeprefix("snellius:"): found[name] for name in names}
            self.assert_columns(own, case.truth, rtol=1e-12)
            raw = file.read_scan_raw(0, ignore_unsupported_fields=True)
            np.testing.assert_allclose(raw["cartesianX"] * 1000, case.truth.places[:, 0])

    def e57_fields(self, file, header, names):
        arrays = {name: np.empty(header.point_count) for name in names}
        buffers = libe57.VectorSourceDestBuffer()
        for name, array in arrays.items():
            buffers.append(
                libe57.SourceDestBuffer(file.image_file, name, array, len(array), True, True)
            )
        header.points.reader(buffers).read()
        return arrays

    @for_every_case
    def test_glb_by_pygltflib(self, case):
        glb = pygltflib.GLTF2().load(case.path("scene.glb"))
        self.assert_says_what_it_is("\n".join(glb.asset.extras["about"]), case.truth)
        self.assertEqual(glb.nodes[glb.scenes[0].nodes[0]].scale, [0.001] * 3)
        meshes = {mesh.name: mesh.primitives[0] for mesh in glb.meshes}
        self.assertEqual({"object points", "object surface", "vessel wall"}, set(meshes))
        points = meshes["object points"]
        self.assertEqual(points.mode, pygltflib.POINTS)
        places = self.accessor(glb, points.attributes.POSITION)
        np.testing.assert_allclose(places, case.truth.places, rtol=1e-6)
        extra = {
            "ray_distance": points.attributes._RAY_DISTANCE,
            "scan": points.attributes._SCAN,
            "view": points.attributes._VIEW,
        }
        for name, accessor in extra.items():
            found = self.accessor(glb, accessor)[:, 0]
            np.testing.assert_allclose(found, case.truth.columns[name], rtol=1e-6)
        sigma = self.accessor(glb, points.attributes._SIGMA)
        np.testing.assert_allclose(sigma[:, 2], case.truth.columns["sigma_z"], rtol=1e-6)
        glass = glb.materials[meshes["vessel wall"].material]
        self.assertEqual(glass.alphaMode, "BLEND")
        self.assertLess(glass.pbrMetallicRoughness.baseColorFactor[3], 0.5)

    def accessor(self, glb, number):
        accessor = glb.accessors[number]
        view = glb.bufferViews[accessor.bufferView]
        self.assertEqual(accessor.componentType, pygltflib.FLOAT)
        width = {"SCALAR": 1, "VEC3": 3}[accessor.type]
        floats = struct.unpack_from(
            f"<{accessor.count * width}f", glb.binary_blob(), view.byteOffset
        )
        values = np.array(floats).reshape(-1, width)
        if accessor.max is not None:
            np.testing.assert_allclose(accessor.max, values.max(axis=0))
            np.testing.assert_allclose(accessor.min, values.min(axis=0))
        return values

    @for_every_case
    def test_glb_by_trimesh_is_in_metres(self, case):
        scene = trimesh.load_scene(case.path("scene.glb"))
        self.assertEqual(len(scene.geometry), 3)
        low, high = scene.bounds
        everything = np.concatenate([case.truth.places, case.truth.vessel]) / 1000
        self.assertTrue((low <= everything.min(axis=0) + 1e-6).all())
        self.assertTrue((high >= everything.max(axis=0) - 1e-6).all())
        # The wall reaches a centimetre beyond its points, and is not a thousand times as large.
        size = np.linalg.norm(high - low)
        self.assertLess(size, 1.5 * np.linalg.norm(np.ptp(everything, axis=0)) + 0.05)

    @for_every_case
    def test_stl_and_obj_by_trimesh(self, case):
        stl = trimesh.load_mesh(case.path("surface.stl"))
        obj = trimesh.load_mesh(case.path("surface.obj"), process=False)
        self.assertEqual(len(stl.faces), len(obj.faces))
        self.assertGreater(len(obj.faces), len(case.truth.places) // 2)
        np.testing.assert_allclose(stl.area, obj.area, rtol=1e-5)
        known = {tuple(place) for place in case.truth.places}
        self.assertTrue(all(tuple(vertex) in known for vertex in obj.vertices))
        self.assertTrue(obj.is_winding_consistent)
        self.assert_says_what_it_is(case.bytes("surface.obj").decode(), case.truth)
        self.assertIn(b"unit mm", case.bytes("surface.obj"))
        header = case.bytes("surface.stl")[:80].decode()
        for part in ["Snellius ", "mm, world frame", f"{case.truth.index} (given)"]:
            self.assertIn(part, header)
        self.assertFalse(header.startswith("solid"), "readers would take it for text")

    def test_the_box_has_its_faces_in_the_surface(self):
        # The sample's box stands turned by 45 degrees: its faces look 45 degrees past the wall's normal.
        case = CASES[0]
        mesh = trimesh.load_mesh(case.path("surface.obj"), process=False)
        normal = np.array(case.result["vessel"]["normal"])
        degrees = np.degrees(np.arccos(np.clip(mesh.face_normals @ normal, -1, 1)))
        self.assertTrue((degrees < 90).all(), "every triangle faces the rig")
        on_a_face = np.isclose(degrees, 45, atol=4)
        self.assertGreater(on_a_face.mean(), 0.7, degrees)

    @for_every_case
    def test_report_by_a_html_parser(self, case):
        report = Report()
        report.feed(case.bytes("report.html").decode())
        self.assertNotIn("script", report.tags)
        self.assertFalse(report.addresses, "a report loads nothing")
        places, wall = len(case.truth.places), len(case.truth.vessel)
        expected = {
            "Top view, with refraction": drawn(places) + drawn(wall),
            "Top view, without refraction": drawn(places) + drawn(wall),
            "Bird's-eye view": drawn(places + wall),
            "Wall residuals": drawn(wall),
        }
        # A line laser's light paths always meet: it has no figure of ray distances.
        if case.truth.columns["ray_distance"].max() > 1e-9:
            expected["Ray distances"] = places
        dots = {title.split(":")[0]: count for title, count in report.figures.items()}
        self.assertEqual(dots, expected)
        rows = len(case.result["views"])
        self.assertGreaterEqual(report.tags.count("tr"), rows)
        self.assertEqual(report.title.split(), case.truth.name.replace("\0", " ").split())
        self.assert_says_what_it_is(report.text, case.truth)
        self.assertIn("unit mm", report.text)


def drawn(count):
    """How many of so many dots a figure shows: no more than it needs."""
    most = 4000
    return -(-count // max(1, -(-count // most)))


class Report(HTMLParser):
    """What a page says and holds."""

    def __init__(self):
        super().__init__()
        self.tags, self.addresses, self.text, self.title = [], [], "", ""
        # The dots of each figure, by its title.
        self.figures, self.figure = {}, None

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        if tag == "circle":
            self.figures[self.figure] += 1
        self.addresses += [value for name, value in attributes if name in ("src", "href")]

    def handle_data(self, data):
        self.text += data
        if self.tags[-2:] == ["svg", "title"]:
            self.figure = data
            self.figures[data] = 0
        elif self.tags[-1] == "title":
            self.title += data


if __name__ == "__main__":
    outcome = unittest.main(exit=False, verbosity=2).result
    failed = len(outcome.failures) + len(outcome.errors)
    passed = outcome.testsRun - failed
    ok = "ok" if outcome.wasSuccessful() else "FAILED"
    # In cargo's words, so that xtask counts these tests among the others.
    print(f"test result: {ok}. {passed} passed; {failed} failed; {len(outcome.skipped)} ignored")
    sys.exit(not outcome.wasSuccessful())
