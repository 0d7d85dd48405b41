"""FBX 7.4 with a character, its blendshapes, and the animation of a take.

One mesh in centimetres with vertex colours, materials and their textures, which are embedded; a
blendshape channel for each shape, and a curve in percent for each channel.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import count
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from faceedit_app.characters.base_colors import material_color, png_of, srgb
from faceedit_app.characters.fbx_joints import bone_children, cluster_children
from faceedit_app.characters.fbx_records import FILE_ID, fbx_content
from faceedit_app.characters.fbx_textures import texture_children, video_children
from faceedit_app.characters.fbx_tree import Record
from faceedit_app.characters.scene import Scene
from faceedit_app.characters.turning import HEAD_JOINT
from faceedit_app.core.arrays import Doubles, Floats, Pixels
from faceedit_app.core.rig import Rig

_TICKS = 46_186_158_000  # of KTime in a second
_CENTIMETRES = 100.0
_PERCENT = 100.0
_STILL = 1e-7  # metres
_LINEAR = 0x4  # interpolation of keys
_CUSTOM_RATE = 14  # of TimeMode
_NO_DATE = "1970-01-01 10:00:00:000"  # what FILE_ID stands for: the same take gives the same bytes

_Id = np.int64


def scene_fbx(scene: Scene, name: str) -> bytes:
    """A scene as binary FBX.

    Args:
        name: of the animation.
    """
    return fbx_content(_Writer(scene, name).records())


def _record(name: str, *values: Any, children: list[Record] | None = None) -> Record:
    return Record(name, values, tuple(children or ()))


def _property(*values: Any) -> Record:
    return Record("P", values)


def _properties(*properties: Record) -> Record:
    return Record("Properties70", (), properties)


def _named(name: str, kind: str) -> str:
    return f"{name}\0\1{kind}"


class _Writer:
    """Collects the objects of a file and their connections."""

    def __init__(self, scene: Scene, name: str) -> None:
        self._scene, self._name = scene, name
        self._ids = count(1_000_000)
        self._objects: list[Record] = []
        self._connections: list[Record] = []
        ticks = np.round(scene.times * _TICKS).astype(np.int64)
        self._ticks, self._end = ticks, _Id(ticks[-1])

    def records(self) -> list[Record]:
        """The top-level records."""
        geometry = self._mesh()
        channels, bone = self._shapes(geometry), self._skin(geometry)
        self._animate(channels, bone)
        return [*self._head(), *self._body()]

    def _add(self, kind: str, label: str, form: str, *children: Record) -> _Id:
        number = _Id(next(self._ids))
        self._objects.append(_record(kind, number, label, form, children=list(children)))
        return number

    def _connect(self, child: _Id, parent: _Id, use: str = "") -> None:
        values: tuple[Any, ...] = ("OP", child, parent, use) if use else ("OO", child, parent)
        self._connections.append(Record("C", values))

    # --- the mesh ----------------------------------------------------------------------------

    def _mesh(self) -> _Id:
        rig = self._scene.rig
        model = self._add(
            "Model",
            _named(rig.name, "Model"),
            "Mesh",
            _record("Version", 232),
            _properties(
                _property("InheritType", "enum", "", "", 1),
                _property("DefaultAttributeIndex", "int", "Integer", "", 0),
            ),
            _record("Shading", True),
            _record("Culling", "CullingOff"),
        )
        self._connect(model, _Id(0))
        last = rig.faces.astype(np.int32)
        polygons = last.copy()
        polygons[:, -1] = ~last[:, -1]  # the last corner of a polygon is marked by its complement
        geometry = self._add(
            "Geometry",
            _named(rig.name, "Geometry"),
            "Mesh",
            _record("GeometryVersion", 124),
            _record("Vertices", _flat(rig.neutral)),
            _record("PolygonVertexIndex", polygons.ravel()),
            *_layers(rig),
        )
        self._connect(geometry, model)
        pictures = [self._picture(k, picture) for k, picture in enumerate(rig.textures)]
        for material in rig.materials:
            mean = srgb(material_color(rig, material))
            number = self._add(
                "Material",
                _named(material.name, "Material"),
                "",
                _record("Version", 102),
                _record("ShadingModel", "phong"),
                _properties(
                    _property("DiffuseColor", "Color", "", "A", *(float(x) for x in mean)),
                    _property("Shininess", "Number", "", "A", 100.0 * (1 - material.roughness)),
                ),
            )
            self._connect(number, model)
            if material.texture is not None:
                self._connect(pictures[material.texture], number, "DiffuseColor")
        return geometry

    def _picture(self, k: int, picture: Pixels) -> _Id:
        """Add a picture; returns its texture."""
        name = f"texture{k + 1}"
        file = f"{name}.png"
        texture = self._add("Texture", _named(name, "Texture"), "", *texture_children(file))
        video = self._add(
            "Video", _named(file, "Video"), "Clip", *video_children(file, png_of(picture))
        )
        self._connect(video, texture)
        return texture

    def _shapes(self, geometry: _Id) -> list[_Id]:
        """Add the blendshapes; returns their channels."""
        scene = self._scene
        deformer = self._add(
            "Deformer", _named(scene.rig.name, "Deformer"), "BlendShape", _record("Version", 100)
        )
        self._connect(deformer, geometry)
        channels = []
        for name, moves in zip(scene.shapes, scene.rig.deltas, strict=True):
            moved = np.flatnonzero(np.abs(moves).max(axis=1) > _STILL).astype(np.int32)
            if not len(moved):  # readers want at least one vertex
                moved = np.zeros(1, np.int32)
            channel = self._add(
                "Deformer",
                _named(name, "SubDeformer"),
                "BlendShapeChannel",
                _record("Version", 100),
                _record("DeformPercent", 0.0),
                _record("FullWeights", np.array([_PERCENT])),
            )
            shape = self._add(
                "Geometry",
                _named(name, "Geometry"),
                "Shape",
                _record("Version", 100),
                _record("Indexes", moved),
                _record("Vertices", _flat(moves[moved])),
                _record("Normals", np.zeros(3 * len(moved))),
            )
            self._connect(channel, deformer)
            self._connect(shape, channel)
            channels.append(channel)
        return channels

    def _skin(self, geometry: _Id) -> _Id | None:
        """Add the joints of the body and the head, if the head turns; returns the head's."""
        turning = self._scene.turning
        if turning is None:
            return None
        skin = self._add(
            "Deformer", _named("Skin", "Deformer"), "Skin",
            _record("Version", 101), _record("Link_DeformAcuracy", 50.0),
        )  # fmt: skip
        self._connect(skin, geometry)
        share = turning.share.astype(np.float64)
        body = self._joint(skin, "body", np.zeros(3), 1.0 - share)
        head = self._joint(skin, HEAD_JOINT, turning.pivot * _CENTIMETRES, share)
        self._connect(body, _Id(0))
        self._connect(head, body)
        return head

    def _joint(self, skin: _Id, name: str, place: Doubles, share: Doubles) -> _Id:
        """Add a joint at a place (3,) in centimetres, which vertices follow by their share."""
        bone = self._add("Model", _named(name, "Model"), "LimbNode", *bone_children(place))
        limb = _record("TypeFlags", "Skeleton")
        self._connect(
            self._add("NodeAttribute", _named(name, "NodeAttribute"), "LimbNode", limb), bone
        )
        children = cluster_children(place, share)
        cluster = self._add("Deformer", _named(name, "SubDeformer"), "Cluster", *children)
        self._connect(cluster, skin)
        self._connect(bone, cluster)
        return bone

    # --- the animation -----------------------------------------------------------------------

    def _animate(self, channels: list[_Id], bone: _Id | None) -> None:
        spans = [
            _property(f"{when}{edge}", "KTime", "Time", "", at)
            for when in ("Local", "Reference")
            for edge, at in (("Start", _Id(0)), ("Stop", self._end))
        ]
        stack = self._add(
            "AnimationStack", _named(self._name, "AnimStack"), "", _properties(*spans)
        )
        layer = self._add("AnimationLayer", _named("BaseLayer", "AnimLayer"), "")
        self._connect(layer, stack)
        percent = _PERCENT * self._scene.weights
        for channel, values in zip(channels, percent.T, strict=True):
            parts = {"DeformPercent": values}
            self._animate_property(layer, channel, "DeformPercent", "DeformPercent", parts)
        if bone is not None and self._scene.turning is not None:
            angles = Rotation.from_matrix(self._scene.turning.matrices).as_euler("xyz")
            angles = np.degrees(np.unwrap(angles, axis=0))
            parts = dict(zip("XYZ", angles.T, strict=True))
            self._animate_property(layer, bone, "Lcl Rotation", "R", parts)

    def _animate_property(
        self, layer: _Id, owner: _Id, target: str, label: str, parts: Mapping[str, Doubles | Floats]
    ) -> None:
        """Add a curve for each part (T,) of a property of an object."""
        values = [
            _property(f"d|{part}", "Number", "", "A", float(curve[0]))
            for part, curve in parts.items()
        ]
        node = self._add(
            "AnimationCurveNode", _named(label, "AnimCurveNode"), "", _properties(*values)
        )
        self._connect(node, layer)
        self._connect(node, owner, target)
        for part, keys in parts.items():
            curve = self._add(
                "AnimationCurve",
                _named("", "AnimCurve"),
                "",
                _record("Default", float(keys[0])),
                _record("KeyVer", 4009),
                _record("KeyTime", self._ticks),
                _record("KeyValueFloat", keys.astype("<f4")),
                _record("KeyAttrFlags", np.array([_LINEAR], np.int32)),
                _record("KeyAttrDataFloat", np.zeros(4, np.float32)),
                _record("KeyAttrRefCount", np.array([len(keys)], np.int32)),
            )
            self._connect(curve, node, f"d|{part}")

    # --- the frame around them ---------------------------------------------------------------

    def _head(self) -> list[Record]:
        zero = [(unit, 0) for unit in ("Hour", "Minute", "Second", "Millisecond")]
        stamp = [("Version", 1000), ("Year", 1970), ("Month", 1), ("Day", 1), *zero]
        axes = [
            _property(axis, "int", "Integer", "", value)
            for axis, value in (
                ("UpAxis", 1), ("UpAxisSign", 1), ("FrontAxis", 2), ("FrontAxisSign", 1),
                ("CoordAxis", 0), ("CoordAxisSign", 1), ("OriginalUpAxis", 1),
                ("OriginalUpAxisSign", 1),
            )
        ]  # fmt: skip
        settings = _properties(
            *axes,
            _property("UnitScaleFactor", "double", "Number", "", 1.0),
            _property("OriginalUnitScaleFactor", "double", "Number", "", 1.0),
            _property("TimeMode", "enum", "", "", _CUSTOM_RATE),
            _property("TimeSpanStart", "KTime", "Time", "", _Id(0)),
            _property("TimeSpanStop", "KTime", "Time", "", self._end),
            _property("CustomFrameRate", "double", "Number", "", float(self._scene.rate)),
        )
        active = _property("ActiveAnimStackName", "KString", "", "", self._name)
        document = _record(
            "Document", _Id(999), "", "Scene",
            children=[
                _properties(_property("SourceObject", "object", "", ""), active),
                _record("RootNode", _Id(0)),
            ],
        )  # fmt: skip
        return [
            _record(
                "FBXHeaderExtension",
                children=[
                    _record("FBXHeaderVersion", 1003),
                    _record("FBXVersion", 7400),
                    _record("EncryptionType", 0),
                    _record("CreationTimeStamp", children=[_record(*part) for part in stamp]),
                    _record("Creator", "FaceEdit"),
                ],
            ),
            _record("FileId", FILE_ID),
            _record("CreationTime", _NO_DATE),
            _record("Creator", "FaceEdit"),
            _record("GlobalSettings", children=[_record("Version", 1000), settings]),
            _record("Documents", children=[_record("Count", 1), document]),
            _record("References"),
        ]

    def _body(self) -> list[Record]:
        kinds = [record.name for record in self._objects]
        counts = {"GlobalSettings": 1} | {kind: kinds.count(kind) for kind in dict.fromkeys(kinds)}
        types = [
            _record("ObjectType", kind, children=[_record("Count", number)])
            for kind, number in counts.items()
        ]
        total = _record("Count", sum(counts.values()))
        take = [
            _record("FileName", f"{self._name}.tak"),
            _record("LocalTime", _Id(0), self._end),
            _record("ReferenceTime", _Id(0), self._end),
        ]
        return [
            _record("Definitions", children=[_record("Version", 100), total, *types]),
            _record("Objects", children=self._objects),
            _record("Connections", children=self._connections),
            _record(
                "Takes",
                children=[
                    _record("Current", self._name),
                    _record("Take", self._name, children=take),
                ],
            ),
        ]


def _layers(rig: Rig) -> list[Record]:
    """Smoothing, vertex colours, texture coordinates and materials of the faces."""
    corners = rig.faces.astype(np.int32).ravel()
    materials = np.zeros(len(rig.faces), np.int32)
    for number, material in enumerate(rig.materials):
        materials[material.start : material.stop] = number
    colors = np.concatenate([srgb(rig.colors[:, :3]), rig.colors[:, 3:]], axis=1)
    layers = {
        "Smoothing": ("ByPolygon", "Direct", [("Smoothing", np.ones(len(rig.faces), np.int32))]),
        "Color": (
            "ByPolygonVertex", "IndexToDirect",
            [("Colors", colors.ravel().astype("<f8")), ("ColorIndex", corners)],
        ),
        "Material": ("AllSame", "IndexToDirect", [("Materials", np.zeros(1, np.int32))])
        if len(rig.materials) < 2
        else ("ByPolygon", "IndexToDirect", [("Materials", materials)]),
    }  # fmt: skip
    if rig.uv is not None:
        uv = rig.uv.astype("<f8") * [1, -1] + [0, 1]  # FBX counts from the lower left corner
        layers["UV"] = (
            "ByPolygonVertex", "IndexToDirect", [("UV", uv.ravel()), ("UVIndex", corners)],
        )  # fmt: skip
    elements = [
        _record(
            f"LayerElement{kind}", 0,
            children=[
                _record("Version", 101),
                _record("Name", kind),
                _record("MappingInformationType", mapping),
                _record("ReferenceInformationType", reference),
                *(_record(*array) for array in arrays),
            ],
        )
        for kind, (mapping, reference, arrays) in layers.items()
    ]  # fmt: skip
    uses = [
        _record(
            "LayerElement",
            children=[_record("Type", f"LayerElement{kind}"), _record("TypedIndex", 0)],
        )
        for kind in layers
    ]
    return [*elements, _record("Layer", 0, children=[_record("Version", 100), *uses])]


def _flat(points: Floats) -> Doubles:
    """Points (N, 3) in metres as FBX lists them."""
    flat: Doubles = points.astype("<f8").ravel() * _CENTIMETRES
    return flat
