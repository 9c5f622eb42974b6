use serde_json::{Value, json};

use super::header::header;
use super::mesh::object_mesh;
use super::points::object_points;
use super::{Mesh, ReconstructionResult};
use crate::VERSION;
use crate::vessel::{MeshNode, WallMesh};

/// Vessel and object as binary glTF 2.0: the measured part of the wall translucent, its two faces as one
/// mesh; the object's points with their standard deviation, ray distance, scan and view; and the surface
/// between the scan lines, where the points allow one.
///
/// glTF's unit is the metre: the coordinates are millimetres, and the root node makes metres of them. The
/// axes are the scan's world frame.
pub fn scene_glb(result: &ReconstructionResult) -> Vec<u8> {
    let mut buffer = Buffer::default();
    let mut meshes = vec![json!({
        "name": "object points",
        "primitives": [points(result, &mut buffer)],
    })];
    if let Some(surface) = object_mesh(result) {
        meshes.push(json!({
            "name": "object surface",
            "primitives": [surface_of(&surface, &mut buffer)],
        }));
    }
    if let Some(wall) = result.wall_mesh() {
        meshes.push(json!({
            "name": "vessel wall",
            "primitives": [wall_faces(&wall, &mut buffer)],
        }));
    }
    let parts = meshes.iter().enumerate();
    let mut nodes: Vec<Value> = parts
        .map(|(number, mesh)| json!({ "name": mesh["name"], "mesh": number }))
        .collect();
    let children: Vec<usize> = (0..nodes.len()).collect();
    nodes
        .push(json!({ "name": result.scan, "scale": [0.001, 0.001, 0.001], "children": children }));
    let document = json!({
        "asset": {
            "version": "2.0",
            "generator": format!("Snellius {VERSION}"),
            "extras": { "about": header(result) },
        },
        "scene": 0,
        "scenes": [{ "nodes": [children.len()] }],
        "nodes": nodes,
        "meshes": meshes,
        "materials": [
            material("object points", [0.85, 0.25, 0.1, 1.0]),
            material("object surface", [0.75, 0.7, 0.62, 1.0]),
            material("glass", [0.6, 0.8, 0.9, 0.25]),
        ],
        "buffers": [{ "byteLength": buffer.bytes.len() }],
        "bufferViews": buffer.views,
        "accessors": buffer.accessors,
    });
    container(&document, buffer.bytes)
}

const POINTS: usize = 0;
const SURFACE: usize = 1;
const GLASS: usize = 2;

fn material(name: &str, colour: [f64; 4]) -> Value {
    let is_translucent = colour[3] < 1.0;
    json!({
        "name": name,
        "alphaMode": if is_translucent { "BLEND" } else { "OPAQUE" },
        "doubleSided": true,
        "pbrMetallicRoughness": {
            "baseColorFactor": colour,
            "metallicFactor": 0.0,
            "roughnessFactor": if is_translucent { 0.1 } else { 0.8 },
        },
    })
}

fn points(result: &ReconstructionResult, buffer: &mut Buffer) -> Value {
    let points: Vec<_> = object_points(result).collect();
    let attribute = |buffer: &mut Buffer, value: fn(&super::points::ObjectPoint) -> f64| {
        let values: Vec<[f64; 1]> = points.iter().map(|p| [value(p)]).collect();
        buffer.floats("SCALAR", &values)
    };
    let places: Vec<[f64; 3]> = points.iter().map(|p| p.place).collect();
    let sigmas: Vec<[f64; 3]> = points.iter().map(|p| p.sigma).collect();
    json!({
        "mode": 0,
        "material": POINTS,
        "attributes": {
            "POSITION": buffer.floats("VEC3", &places),
            "_SIGMA": buffer.floats("VEC3", &sigmas),
            "_RAY_DISTANCE": attribute(buffer, |p| p.ray_distance),
            "_SCAN": attribute(buffer, |p| f64::from(p.scan)),
            "_VIEW": attribute(buffer, |p| f64::from(p.view)),
        },
    })
}

fn surface_of(mesh: &Mesh, buffer: &mut Buffer) -> Value {
    json!({
        "mode": 4,
        "material": SURFACE,
        "attributes": { "POSITION": buffer.floats("VEC3", &mesh.vertices) },
        "indices": buffer.corners(&mesh.triangles),
    })
}

/// Both faces of a wall as one mesh. The inner face's normals point into the liquid.
fn wall_faces(wall: &WallMesh, buffer: &mut Buffer) -> Value {
    let (mut places, mut normals, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
    let mut face = |place: fn(&MeshNode) -> [f64; 3], sign: f64| {
        let mut number_of = vec![None; wall.nodes.len()];
        for (index, node) in wall.nodes.iter().enumerate() {
            if let Some(node) = node {
                number_of[index] = Some(places.len() as u32);
                places.push(place(node));
                normals.push((node.normal * sign).into());
            }
        }
        for row in 0..wall.rows - 1 {
            for column in 0..wall.columns - 1 {
                let first = row * wall.columns + column;
                let cell = [
                    first,
                    first + 1,
                    first + wall.columns + 1,
                    first + wall.columns,
                ];
                if let [Some(a), Some(b), Some(c), Some(d)] = cell.map(|at| number_of[at]) {
                    triangles.extend(if sign > 0.0 {
                        [[a, b, c], [a, c, d]]
                    } else {
                        [[a, c, b], [a, d, c]]
                    });
                }
            }
        }
    };
    face(|node| node.outer.to_array(), 1.0);
    face(|node| node.inner.to_array(), -1.0);
    json!({
        "mode": 4,
        "material": GLASS,
        "attributes": {
            "POSITION": buffer.floats("VEC3", &places),
            "NORMAL": buffer.floats("VEC3", &normals),
        },
        "indices": buffer.corners(&triangles),
    })
}

/// The binary part, and what the JSON part says of it.
#[derive(Default)]
struct Buffer {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Buffer {
    /// Adds vectors as 32-bit floats, with their bounds; gives the accessor's number.
    fn floats<const N: usize>(&mut self, kind: &str, vectors: &[[f64; N]]) -> usize {
        const FLOAT: u32 = 5126;
        const ARRAY: u32 = 34962;
        let vectors: Vec<[f32; N]> = vectors.iter().map(|v| v.map(|x| x as f32)).collect();
        let mut bounds = json!({});
        if let Some(first) = vectors.first() {
            let (mut low, mut high) = (*first, *first);
            for vector in &vectors {
                low = std::array::from_fn(|i| low[i].min(vector[i]));
                high = std::array::from_fn(|i| high[i].max(vector[i]));
            }
            bounds = json!({ "min": low.to_vec(), "max": high.to_vec() });
        }
        let count = vectors.len();
        let bytes = vectors.iter().flatten().flat_map(|x| x.to_le_bytes());
        self.add(bytes.collect(), ARRAY, kind, FLOAT, count, bounds)
    }

    /// Adds the corners of triangles; gives the accessor's number.
    fn corners(&mut self, triangles: &[[u32; 3]]) -> usize {
        const UNSIGNED: u32 = 5125;
        const ELEMENTS: u32 = 34963;
        let bytes = triangles.iter().flatten().flat_map(|v| v.to_le_bytes());
        let count = 3 * triangles.len();
        self.add(
            bytes.collect(),
            ELEMENTS,
            "SCALAR",
            UNSIGNED,
            count,
            json!({}),
        )
    }

    fn add(
        &mut self,
        bytes: Vec<u8>,
        target: u32,
        kind: &str,
        component: u32,
        count: usize,
        bounds: Value,
    ) -> usize {
        self.views.push(json!({
            "buffer": 0,
            "byteOffset": self.bytes.len(),
            "byteLength": bytes.len(),
            "target": target,
        }));
        let mut accessor = json!({
            "bufferView": self.views.len() - 1,
            "componentType": component,
            "count": count,
            "type": kind,
        });
        for (key, value) in bounds.as_object().into_iter().flatten() {
            accessor[key] = value.clone();
        }
        self.bytes.extend(bytes);
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }
}

/// The file: a header of 12 bytes and two chunks, each a multiple of four bytes long.
fn container(document: &Value, mut binary: Vec<u8>) -> Vec<u8> {
    let mut json = document.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    binary.resize(binary.len().next_multiple_of(4), 0);
    let length = 12 + 8 + json.len() + 8 + binary.len();
    let mut file = Vec::with_capacity(length);
    file.extend(b"glTF");
    file.extend(2_u32.to_le_bytes());
    file.extend((length as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", json), (b"BIN\0", binary)] {
        file.extend((chunk.len() as u32).to_le_bytes());
        file.extend(kind);
        file.extend(chunk);
    }
    file
}
