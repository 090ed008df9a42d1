"""What a job is made of: dictionaries whose members a type checker knows.

Each class is an object of the job's JSON, and makes one: Camera(position=[0, 0, -2], target=[0, 0, 0], fov=50).
Generated from jobs/schema.json by python/update."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, NotRequired, TypeAlias, TypedDict


class JobDocument(TypedDict):
    """A scene, which frames of it to render, how exactly, and where to write them. Metres and seconds; angles in
    degrees unless the key ends in _rad. docs/job_format.md lists the rules that join several keys."""

    # The version of this format.
    version: Literal[1]
    # 1 to 128 bytes without control characters.
    name: str
    # The frames to render, in this order: 1-100, 1-100x2, 1,5,10-20, 100-1.
    frames: str
    # Frames a second, at most 1000 and 6 decimals, or [numerator, denominator].
    fps: float | Sequence[int]
    # The time of frame 0, s.
    time_offset: NotRequired[float]
    # [width, height] in pixels, at most 67108864 in all.
    resolution: Sequence[int]
    camera: Camera
    lights: NotRequired[Sequence[Light]]
    # Radiance behind everything. With a background the picture is opaque; without one its alpha channel is its opacity.
    background: NotRequired[Radiance]
    scene: NotRequired[Scene]
    # A method and its numbers, or a tolerance, or the one word draft; a tolerance of 0.01 if absent.
    quality: NotRequired[Quality]
    output: Output
    # Which frames come first: the first, the last, the middle one, or every n-th. The rest follows as written.
    order: NotRequired[Sequence[Literal["first", "last", "middle"] | int]]
    # Seconds that the farm lets one frame take; its own setting if absent.
    frame_limit: NotRequired[float]
    # Jobs of higher priority are rendered first. Those above 100 are for administrators.
    priority: NotRequired[int]
    # The name of a pool of the farm, or a tag of some: only their workers render the job. Any worker if absent.
    pool: NotRequired[str]
    # Jobs of the same farm that come first: this one begins when all have succeeded, or are over.
    after: NotRequired[Sequence[int] | AfterJobs]
    # For people: 1 to 1000 bytes without control characters, which lists, and headers of files, tell.
    comment: NotRequired[str]
    # For people, likewise: words of 1 to 64 bytes without a comma, none twice.
    tags: NotRequired[Sequence[str]]
    # Whom the farm tells what becomes of the job.
    notify: NotRequired[Sequence[NotifyTo | NotifyWebhook]]


class Camera(TypedDict):
    """A pinhole camera."""

    position: Position
    # The point in the middle of the picture.
    target: Position
    # Up in the picture; [0, 1, 0] if absent.
    up: NotRequired[Direction]
    # Vertical, degrees.
    fov: Fov
    # [near, far]: distances along the ray between which media count; 0 to infinity if absent.
    clip: NotRequired[Sequence[float]]
    # Flips the picture's x.
    mirror: NotRequired[bool]
    # How long the shutter is open from the frame's time on, in frames; the samples' times are spread evenly over it.
    shutter: NotRequired[float]


class MovingVectorStart(TypedDict):
    # The value at time 0.
    start: Sequence[float]
    # Change per second.
    rate: Sequence[float]


class MovingVectorLissajous(TypedDict):
    # center + amplitude sin(frequency_rad speed t + phase_rad), for each axis separately
    lissajous: MovingVectorLissajousNumbers


class MovingVectorLissajousNumbers(TypedDict):
    """center + amplitude sin(frequency_rad speed t + phase_rad), for each axis separately"""

    center: Sequence[float]
    amplitude: Sequence[float]
    # Radians per second.
    frequency_rad: Sequence[float]
    # [0, 0, 0] if absent.
    phase_rad: NotRequired[Sequence[float]]
    # 1 if absent.
    speed: NotRequired[float]


class MovingVectorKeys(TypedDict):
    # Pairs [time, value], ascending in time.
    keys: Sequence[Sequence[float | Sequence[float]]]
    interpolation: NotRequired[Literal["linear", "smooth", "hold"]]


class Orbit(TypedDict):
    # A circle, counter-clockwise seen from the axis' tip.
    orbit: OrbitNumbers


class OrbitNumbers(TypedDict):
    """A circle, counter-clockwise seen from the axis' tip."""

    # [0, 0, 0] if absent.
    center: NotRequired[Sequence[float]]
    # m
    radius: float
    # Along the axis, m; 0 if absent.
    height: NotRequired[float]
    # [0, 1, 0] if absent.
    axis: NotRequired[Sequence[float]]
    # Seconds per revolution; negative: clockwise.
    period: float
    # 0 if absent.
    phase_deg: NotRequired[float]


class MovingNumberStart(TypedDict):
    # The value at time 0.
    start: float
    # Change per second.
    rate: float


class MovingNumberLissajous(TypedDict):
    # center + amplitude sin(frequency_rad speed t + phase_rad)
    lissajous: MovingNumberLissajousNumbers


class MovingNumberLissajousNumbers(TypedDict):
    """center + amplitude sin(frequency_rad speed t + phase_rad)"""

    center: float
    amplitude: float
    # Radians per second.
    frequency_rad: float
    # 0 if absent.
    phase_rad: NotRequired[float]
    # 1 if absent.
    speed: NotRequired[float]


class MovingNumberKeys(TypedDict):
    # Pairs [time, value], ascending in time.
    keys: Sequence[Sequence[float]]
    interpolation: NotRequired[Literal["linear", "smooth", "hold"]]


class PointLight(TypedDict):
    kind: Literal["point"]
    # inverse_square: intensity is in W/sr; none: intensity is the irradiance everywhere, W/m^2.
    falloff: NotRequired[Literal["inverse_square", "none"]]
    intensity: Radiance
    position: Position


class SunLight(TypedDict):
    kind: Literal["sun"]
    # Irradiance, W/m^2.
    intensity: Radiance
    # The direction in which its light travels.
    direction: Direction


class SpotLight(TypedDict):
    """A point that shines into a cone."""

    kind: Literal["spot"]
    # W/sr, inside the inner cone.
    intensity: Radiance
    position: Position
    # The direction in which its light travels in the middle.
    direction: Direction
    # Half of the inner cone's angle, degrees; from here on its light fades smoothly.
    inner: Inner
    # Half of the outer cone's angle, degrees; beyond there is none of its light.
    outer: Outer


class SphereLight(TypedDict):
    """A ball of even radiance, dark inside. It casts no shadow and is not seen."""

    kind: Literal["sphere"]
    # W/sr, seen from afar.
    intensity: Radiance
    # Its middle.
    position: Position
    # m
    radius: Size


class EvenDome(TypedDict):
    """Light from all directions, infinitely far away."""

    kind: Literal["dome"]
    radiance: Radiance
    visible: NotRequired[bool]


class GradientDome(TypedDict):
    """A dome between two colours, linear in the cosine to its axis."""

    kind: Literal["dome"]
    gradient: GradientDomeGradient
    visible: NotRequired[bool]


class GradientDomeGradient(TypedDict):
    # Radiance from where the axis points.
    along: Radiance
    # Radiance from the other end.
    against: Radiance
    # [0, 1, 0] if absent.
    axis: NotRequired[Direction]


class ImageDome(TypedDict):
    """A dome that shows an image in latitude and longitude."""

    kind: Literal["dome"]
    # An EXR file's path, relative to the job file: linear radiance, its first row at the top.
    file: str
    # By what the image is multiplied; 1 if absent.
    scale: NotRequired[Radiance]
    rotate: NotRequired[ImageDomeRotate]
    visible: NotRequired[bool]


class ImageDomeRotate(TypedDict):
    # [0, 1, 0] if absent.
    axis: NotRequired[Direction]
    # Degrees.
    angle: Angle


class Scene(TypedDict):
    # How often light scatters; once if absent.
    scattering: NotRequired[SceneScattering]
    # Where media overlap, they add.
    media: NotRequired[Sequence[Medium]]
    # Solids. Where they overlap, only the later one exists.
    objects: NotRequired[Sequence[Object]]


class SceneScattering(TypedDict):
    """How often light scatters; once if absent."""

    # The light of lamps and domes scatters at most so often, in media and at diffuse surfaces alike; emitted light once
    # less.
    orders: int | Literal["all"]


class CoefficientsMedium(TypedDict):
    """Extinction is (sigma_s + sigma_a) times density."""

    density: Density
    # Scattering per metre and unit of density.
    sigma_s: NotRequired[Coefficient]
    # Absorption per metre and unit of density.
    sigma_a: NotRequired[Coefficient]
    # Radiance per metre and unit of density.
    emission: NotRequired[Radiance]
    # Blackbody emission, for grids from .nvdb or .vdb files.
    blackbody: NotRequired[CoefficientsMediumBlackbody]
    phase: NotRequired[Sequence[Lobe]]


class FoldFractal(TypedDict):
    kind: Literal["fold_fractal"]
    bounds: NotRequired[Bounds]
    iterations: int
    # m
    offset: Length
    # m
    radius: Length
    # Per iteration; 0 if absent.
    rotate_x_rad: NotRequired[Angle]
    # Per iteration; 0 if absent.
    rotate_y_rad: NotRequired[Angle]
    exponent: Exponent
    scale: Length


class SphereBounds(TypedDict):
    kind: Literal["sphere"]
    # [0, 0, 0] if absent.
    center: NotRequired[Position]
    # m
    radius: Size
    # m; 0 if absent.
    falloff: NotRequired[Length]


class BoxBounds(TypedDict):
    kind: Literal["box"]
    # [0, 0, 0] if absent.
    center: NotRequired[Position]
    # Its sides along the world's axes, m.
    size: Sides
    # m; 0 if absent.
    falloff: NotRequired[Length]


class SlabBounds(TypedDict):
    kind: Literal["slab"]
    # [0, 0, 0] if absent.
    center: NotRequired[Position]
    # [0, 1, 0] if absent.
    normal: NotRequired[Direction]
    # m
    thickness: Size
    # m; 0 if absent.
    falloff: NotRequired[Length]


class Homogeneous(TypedDict):
    """Constant everywhere, or everywhere inside its bounds."""

    kind: Literal["homogeneous"]
    bounds: NotRequired[Bounds]
    # 1 if absent.
    scale: NotRequired[Length]


class Noise(TypedDict):
    """Octaves of Perlin noise."""

    kind: Literal["noise"]
    bounds: NotRequired[Bounds]
    # Lattice cells per metre.
    frequency: Size
    octaves: NotRequired[int]
    # Ratio of an octave's frequency to that of the one before; 2 if absent.
    lacunarity: NotRequired[Lacunarity]
    # Each octave has lacunarity^-H times the amplitude of the one before; 1 if absent.
    H: NotRequired[Hurst]
    # Towards 1 the density fills space, towards -1 it vanishes; 0 if absent.
    bias: NotRequired[Bias]
    # remap: max((1 + noise) / 2, 0); clip: max(noise, 0); absolute: the sum of the octaves' absolute values,
    # turbulence.
    mode: NotRequired[Literal["remap", "clip", "absolute"]]
    # In lattice cells; [0, 0, 0] if absent.
    offset: NotRequired[Lattice]
    rotate: NotRequired[NoiseRotate]
    # 1 if absent.
    scale: NotRequired[Length]


class NoiseRotate(TypedDict):
    # [0, 1, 0] if absent.
    axis: NotRequired[Direction]
    # Degrees.
    angle: Angle


class Grid(TypedDict):
    """Voxels from a file."""

    kind: Literal["grid"]
    bounds: NotRequired[Bounds]
    file: str
    # The grid of a .nvdb or .vdb file; its first if absent.
    grid: NotRequired[str]
    # Voxels along x, y and z of a .raw file; from its name if absent.
    size: NotRequired[Sequence[int]]
    # The type of a .raw file's voxels; from its name if absent.
    type: NotRequired[Literal["uint8", "uint16", "int16", "float32"]]
    # The byte order of a .raw file.
    byte_order: NotRequired[Literal["little", "big"]]
    # Bytes before the first voxel of a .raw file.
    skip_bytes: NotRequired[int]
    # The sides of a voxel, m; from the file if absent.
    spacing: NotRequired[Sequence[float]]
    interpolation: NotRequired[Literal["linear", "nearest"]]
    # The position of the grid's middle; from the file if absent.
    center: NotRequired[Position]
    # Density per value; 1 if absent.
    scale: NotRequired[Length]


class Glsl(TypedDict):
    """The user's function float density(vec3 p, float t) in GLSL; p in metres, t in seconds."""

    kind: Literal["glsl"]
    bounds: Bounds
    # A path, relative to the job file.
    file: NotRequired[str]
    # The text itself, in place of a file.
    source: NotRequired[str]
    # A bound: |density(p) - density(q)| <= lipschitz |p - q|, and density is negative outside; unknown if absent.
    lipschitz: NotRequired[float]
    # An upper bound of density(); tracking with delta and ratio needs it.
    majorant: NotRequired[float]
    # 1 if absent.
    scale: NotRequired[Length]


class CoefficientsMediumBlackbody(TypedDict):
    """Blackbody emission, for grids from .nvdb or .vdb files."""

    # The grid of temperature, in the density's file.
    grid: str
    # Kelvin per unit of the grid's value.
    kelvin: Length
    # 1 if absent.
    intensity: NotRequired[Intensity]


class HenyeyGreensteinLobe(TypedDict):
    kind: NotRequired[Literal["henyey_greenstein"]]
    # Mean cosine, forward positive.
    g: Cosine
    # 1 if absent.
    weight: NotRequired[Share]


class RayleighLobe(TypedDict):
    kind: Literal["rayleigh"]
    # 1 if absent.
    weight: NotRequired[Share]


class TransferMedium(TypedDict):
    """A medium whose transfer function says how it absorbs and emits light."""

    density: TransferGrid


class TransferGrid(TypedDict):
    """Voxels from a file, with a transfer function."""

    kind: Literal["grid"]
    bounds: NotRequired[Bounds]
    file: str
    # The grid of a .nvdb or .vdb file; its first if absent.
    grid: NotRequired[str]
    # Voxels along x, y and z of a .raw file; from its name if absent.
    size: NotRequired[Sequence[int]]
    # The type of a .raw file's voxels; from its name if absent.
    type: NotRequired[Literal["uint8", "uint16", "int16", "float32"]]
    # The byte order of a .raw file.
    byte_order: NotRequired[Literal["little", "big"]]
    # Bytes before the first voxel of a .raw file.
    skip_bytes: NotRequired[int]
    # The sides of a voxel, m; from the file if absent.
    spacing: NotRequired[Sequence[float]]
    interpolation: NotRequired[Literal["linear", "nearest"]]
    # The position of the grid's middle; from the file if absent.
    center: NotRequired[Position]
    # Points [value, r, g, b, a], ascending in value: linear colour that is not premultiplied, and opacity over
    # unit_distance.
    transfer_function: Sequence[Sequence[float]]
    # m
    unit_distance: Size


class SphereObject(TypedDict):
    kind: Literal["sphere"]
    center: Position
    # m
    radius: Size
    material: Material


class Matte(TypedDict):
    """Lambertian reflection."""

    kind: Literal["diffuse"]
    # Multiplied by the texture; beside one, 1 if absent.
    albedo: NotRequired[Reflectance]
    texture: NotRequired[Texture]


class Texture(TypedDict):
    """An image that covers the surface in tiles; around a sphere it goes once."""

    # A path, relative to the job file.
    file: str
    # The size of a tile, m: its width, or [across, up]. For all shapes but spheres.
    size: NotRequired[float | Sequence[float]]
    filter: NotRequired[Literal["linear", "nearest"]]
    # If absent, srgb for a .png file and linear for an .exr file.
    color_space: NotRequired[Literal["srgb", "linear"]]


class Shiny(TypedDict):
    """Lambertian reflection below a surface that reflects as a mirror."""

    kind: Literal["diffuse"]
    # Multiplied by the texture; beside one, 1 if absent.
    albedo: NotRequired[Reflectance]
    texture: NotRequired[Texture]
    # This share, times that of fresnel, is reflected as by a mirror.
    specular: Share
    fresnel: NotRequired[Literal["exact", "schlick", "none"]]
    # 1.5 if absent.
    ior: NotRequired[Ior]
    # Share at normal incidence; from ior if absent.
    f0: NotRequired[Share]
    # Share at grazing incidence; 1 if absent.
    f90: NotRequired[Share]
    roughness: NotRequired[Share]


class Mirror(TypedDict):
    kind: Literal["mirror"]
    # 1 if absent.
    reflectance: NotRequired[Reflectance]
    roughness: NotRequired[Share]


class Dielectric(TypedDict):
    """Glass or water: refracts and reflects."""

    kind: Literal["dielectric"]
    # Index of refraction; that of air is 1.
    ior: Ior
    fresnel: NotRequired[Literal["exact", "schlick", "none"]]
    # Share at normal incidence; from ior if absent.
    f0: NotRequired[Share]
    # Share at grazing incidence; 1 if absent.
    f90: NotRequired[Share]
    roughness: NotRequired[Share]
    # The medium that fills it.
    interior: NotRequired[Medium | EvenMedium]


class EvenMedium(TypedDict):
    """A medium whose density is 1 everywhere."""

    # Scattering per metre.
    sigma_s: NotRequired[Coefficient]
    # Absorption per metre.
    sigma_a: NotRequired[Coefficient]
    # Radiance per metre.
    emission: NotRequired[Radiance]
    phase: NotRequired[Sequence[Lobe]]


class BoxObject(TypedDict):
    kind: Literal["box"]
    center: Position
    # Its sides along the world's axes, m.
    size: Sides
    material: Material


class PlaneObject(TypedDict):
    """The half-space behind a plane."""

    kind: Literal["plane"]
    # Any point of the plane.
    point: Position
    # Points out of the solid; [0, 1, 0] if absent.
    normal: NotRequired[Direction]
    material: Material


class UnionObject(TypedDict):
    """One solid of several shapes."""

    kind: Literal["union"]
    of: Sequence[Shape]
    material: Material


class SphereShape(TypedDict):
    kind: Literal["sphere"]
    center: Position
    # m
    radius: Size


class BoxShape(TypedDict):
    kind: Literal["box"]
    center: Position
    # Its sides along the world's axes, m.
    size: Sides


class PlaneShape(TypedDict):
    kind: Literal["plane"]
    # Any point of the plane.
    point: Position
    # Points out of the solid; [0, 1, 0] if absent.
    normal: NotRequired[Direction]


class Auto(TypedDict):
    """The planner chooses the cheapest method that keeps the tolerance; 0.01 if absent."""

    method: NotRequired[Literal["auto"]]
    # The largest allowed relative RMSE of a frame.
    tolerance: NotRequired[float]
    # A frame that no setting within reach keeps fails, or is published and marked as missed.
    on_miss: NotRequired[Literal["fail", "publish"]]
    samples: NotRequired[int]
    max_depth: NotRequired[int]
    min_throughput: NotRequired[float]
    # As with a method, where it is stated; else the measured error alone judges what cut paths lose.
    max_cut: NotRequired[float]


class Riemann(TypedDict):
    """A Riemann sum with right endpoints. Needs camera.clip."""

    method: Literal["riemann"]
    step: float
    # Steps along a shadow ray.
    light_steps: int
    min_transmittance: NotRequired[float]
    pixels: NotRequired[Pixels]
    samples: NotRequired[int]


class Pixels(TypedDict):
    """Which pixels are traced: a lattice, refined where the picture asks for it; the others are interpolated. If
    absent, every pixel is traced. Not with jittered, tracking or rough surfaces, and not beside max_cut."""

    # Of the first lattice, px.
    stride: NotRequired[Literal[2, 4, 8, 16, 32, 64]]
    # The doubt of the interpolation, relative to the RMS of the picture, above which a pixel is traced.
    threshold: float


class Midpoint(TypedDict):
    """The midpoint rule with an exact exponential in each segment; skips empty space, ends at bounds."""

    method: Literal["midpoint", "jittered", "preintegrated"]
    step: NotRequired[float]
    step_voxels: NotRequired[float]
    # Step along shadow rays, m; required where they march.
    light_step: NotRequired[float]
    # Step along shadow rays.
    light_step_voxels: NotRequired[float]
    min_transmittance: NotRequired[float]
    roulette: NotRequired[Roulette]
    pixels: NotRequired[Pixels]
    scatter_grid: NotRequired[int]
    scatter_from: NotRequired[Literal["lights", "nodes"]]
    similar_after: NotRequired[int]
    paths: NotRequired[int]
    samples: NotRequired[int]
    max_depth: NotRequired[int]
    min_throughput: NotRequired[float]
    max_cut: NotRequired[float]


class Roulette(TypedDict):
    """Russian roulette: a ray whose transmittance is below `below` survives with the probability `survive`; its light
    is then divided by that."""

    below: float
    survive: float


class Equiangular(TypedDict):
    """For homogeneous media without falloff, in closed form; points are distributed for a point light's 1 / r^2."""

    method: Literal["equiangular"]
    # Points for each light and interval of a ray.
    points: int
    pixels: NotRequired[Pixels]
    scatter_grid: NotRequired[int]
    scatter_from: NotRequired[Literal["lights", "nodes"]]
    similar_after: NotRequired[int]
    paths: NotRequired[int]
    samples: NotRequired[int]
    max_depth: NotRequired[int]
    min_throughput: NotRequired[float]
    max_cut: NotRequired[float]


class Adaptive(TypedDict):
    """Midpoint with segments of limited optical depth."""

    method: Literal["adaptive"]
    # Largest optical depth of a segment.
    depth_step: float
    step: NotRequired[float]
    step_voxels: NotRequired[float]
    # Step along shadow rays, m; required where they march.
    light_step: NotRequired[float]
    # Step along shadow rays.
    light_step_voxels: NotRequired[float]
    min_transmittance: NotRequired[float]
    roulette: NotRequired[Roulette]
    pixels: NotRequired[Pixels]
    scatter_grid: NotRequired[int]
    scatter_from: NotRequired[Literal["lights", "nodes"]]
    similar_after: NotRequired[int]
    paths: NotRequired[int]
    samples: NotRequired[int]
    max_depth: NotRequired[int]
    min_throughput: NotRequired[float]
    max_cut: NotRequired[float]


class Gauss(TypedDict):
    """Gauss-Legendre quadrature in each segment, also towards lights."""

    method: Literal["gauss"]
    # Nodes in a segment.
    order: NotRequired[int]
    step: NotRequired[float]
    step_voxels: NotRequired[float]
    # Step along shadow rays, m; required where they march.
    light_step: NotRequired[float]
    # Step along shadow rays.
    light_step_voxels: NotRequired[float]
    min_transmittance: NotRequired[float]
    pixels: NotRequired[Pixels]
    scatter_grid: NotRequired[int]
    scatter_from: NotRequired[Literal["lights", "nodes"]]
    similar_after: NotRequired[int]
    paths: NotRequired[int]
    samples: NotRequired[int]
    max_depth: NotRequired[int]
    min_throughput: NotRequired[float]
    max_cut: NotRequired[float]


class Cached(TypedDict):
    """Midpoint whose transmittances come from a grid for each light; for scenes without objects."""

    method: Literal["cached"]
    step: NotRequired[float]
    step_voxels: NotRequired[float]
    # Cells along each side of a light's grid.
    light_grid: int
    # Largest optical depth of a segment; if absent, all segments have the length of step.
    depth_step: NotRequired[float]
    # Cells along the longest side of the grid that a noise or glsl density is baked into; none if absent.
    density_grid: NotRequired[int]
    min_transmittance: NotRequired[float]
    pixels: NotRequired[Pixels]
    scatter_grid: NotRequired[int]
    scatter_from: NotRequired[Literal["lights", "nodes"]]
    similar_after: NotRequired[int]
    paths: NotRequired[int]
    samples: NotRequired[int]
    max_depth: NotRequired[int]
    min_throughput: NotRequired[float]
    max_cut: NotRequired[float]


class Tracking(TypedDict):
    """Unbiased random estimates, by collisions with a majorant."""

    method: Literal["tracking"]
    estimator: Literal["delta", "ratio"]
    roulette: NotRequired[Roulette]
    samples: NotRequired[int]


class TrackingMarched(TypedDict):
    """Random estimates from jittered marches."""

    method: Literal["tracking"]
    estimator: Literal["debiased", "jackknife"]
    step: NotRequired[float]
    step_voxels: NotRequired[float]
    # Step along shadow rays, m; required where they march.
    light_step: NotRequired[float]
    # Step along shadow rays.
    light_step_voxels: NotRequired[float]
    roulette: NotRequired[Roulette]
    samples: NotRequired[int]


class Paths(TypedDict):
    """Random paths of all orders of scattering, without bias but for a light_grid: their noise is all of the
    error."""

    method: Literal["paths"]
    # Random paths of a pixel.
    paths: int
    light_grid: NotRequired[PathLightGrid]
    # Step of a march that shows what is seen without scattering, m; without one, paths show it, too.
    step: NotRequired[float]
    # Step of that march.
    step_voxels: NotRequired[float]
    samples: NotRequired[int]
    max_cut: NotRequired[float]


class PathsSparse(TypedDict):
    """Random paths of a part of the pixels, and a march that shows what is seen without scattering."""

    method: Literal["paths"]
    # Random paths of a traced pixel.
    paths: int
    light_grid: NotRequired[PathLightGrid]
    # Step of the march, m; required where density varies.
    step: NotRequired[float]
    # Step of the march.
    step_voxels: NotRequired[float]
    samples: NotRequired[int]
    pixels: Pixels


class Output(TypedDict):
    # A path below the output root, with one run of # or one %0Nd for the frame's number in the file's name.
    path: str
    pixel: NotRequired[Literal["half", "float"]]
    compression: NotRequired[Literal["none", "rle", "zips", "zip", "piz"]]
    # Z: depth, m. transmittance: that of the media, a colour.
    aovs: NotRequired[Sequence[Literal["Z", "transmittance"]]]
    # What to do with a file that exists: verify keeps it if it is whole and this job's, else renders it again.
    existing: NotRequired[Literal["verify", "overwrite", "fail"]]


class AfterJobs(TypedDict):
    jobs: Sequence[int]
    # over: whether they succeeded or not.
    when: NotRequired[Literal["succeeded", "over"]]


class NotifyTo(TypedDict):
    on: Sequence[Literal["done", "failed", "waiting", "missed"]]
    # The name of a target in the settings of march-web.
    to: str


class NotifyWebhook(TypedDict):
    on: Sequence[Literal["done", "failed", "waiting", "missed"]]
    # An address that gets a POST, where the farm allows jobs to name some.
    webhook: str


MovingVector: TypeAlias = MovingVectorStart | MovingVectorLissajous | MovingVectorKeys
# [x, y, z], m, or an object that moves it.
Position: TypeAlias = Sequence[float] | MovingVector | Orbit
# [x, y, z], any length but 0, or an object that moves it.
Direction: TypeAlias = Sequence[float] | MovingVector
MovingNumber: TypeAlias = MovingNumberStart | MovingNumberLissajous | MovingNumberKeys
Fov: TypeAlias = float | MovingNumber
# A number or [r, g, b], or an object that moves it.
Radiance: TypeAlias = float | Sequence[float] | MovingNumber | MovingVector
Inner: TypeAlias = float | MovingNumber
Outer: TypeAlias = float | MovingNumber
Size: TypeAlias = float | MovingNumber
Angle: TypeAlias = float | MovingNumber
Light: TypeAlias = PointLight | SunLight | SpotLight | SphereLight | EvenDome | GradientDome | ImageDome
Length: TypeAlias = float | MovingNumber
Sides: TypeAlias = Sequence[float] | MovingVector
# Outside the density is 0; inside it rises smoothly over the length of falloff.
Bounds: TypeAlias = SphereBounds | BoxBounds | SlabBounds
Exponent: TypeAlias = float | MovingNumber
Lacunarity: TypeAlias = float | MovingNumber
Hurst: TypeAlias = float | MovingNumber
Bias: TypeAlias = float | MovingNumber
Lattice: TypeAlias = Sequence[float] | MovingVector
Density: TypeAlias = FoldFractal | Homogeneous | Noise | Grid | Glsl
# A number or [r, g, b], or an object that moves it.
Coefficient: TypeAlias = float | Sequence[float] | MovingNumber | MovingVector
Intensity: TypeAlias = float | MovingNumber
Cosine: TypeAlias = float | MovingNumber
Share: TypeAlias = float | MovingNumber
Lobe: TypeAlias = HenyeyGreensteinLobe | RayleighLobe
# Where media overlap, they add.
Medium: TypeAlias = CoefficientsMedium | TransferMedium
# A number or [r, g, b], or an object that moves it.
Reflectance: TypeAlias = float | Sequence[float] | MovingNumber | MovingVector
Ior: TypeAlias = float | MovingNumber
Material: TypeAlias = Matte | Shiny | Mirror | Dielectric
Shape: TypeAlias = SphereShape | BoxShape | PlaneShape
Object: TypeAlias = SphereObject | BoxObject | PlaneObject | UnionObject
# Cells along each side of a light's grid, from which paths take the light of suns, points and spots, with an error that
# falls with the cells; if absent or 0, flights are tracked to them.
PathLightGrid: TypeAlias = Literal[0] | int
# A method and its numbers, or a tolerance, or the one word draft; a tolerance of 0.01 if absent.
Quality: TypeAlias = (
    Literal["draft"] | Auto | Riemann | Midpoint | Equiangular | Adaptive | Gauss | Cached | Tracking |
    TrackingMarched | Paths | PathsSparse
)

__all__ = [
    "Adaptive",
    "AfterJobs",
    "Angle",
    "Auto",
    "Bias",
    "Bounds",
    "BoxBounds",
    "BoxObject",
    "BoxShape",
    "Cached",
    "Camera",
    "Coefficient",
    "CoefficientsMedium",
    "CoefficientsMediumBlackbody",
    "Cosine",
    "Density",
    "Dielectric",
    "Direction",
    "Equiangular",
    "EvenDome",
    "EvenMedium",
    "Exponent",
    "FoldFractal",
    "Fov",
    "Gauss",
    "Glsl",
    "GradientDome",
    "GradientDomeGradient",
    "Grid",
    "HenyeyGreensteinLobe",
    "Homogeneous",
    "Hurst",
    "ImageDome",
    "ImageDomeRotate",
    "Inner",
    "Intensity",
    "Ior",
    "JobDocument",
    "Lacunarity",
    "Lattice",
    "Length",
    "Light",
    "Lobe",
    "Material",
    "Matte",
    "Medium",
    "Midpoint",
    "Mirror",
    "MovingNumber",
    "MovingNumberKeys",
    "MovingNumberLissajous",
    "MovingNumberLissajousNumbers",
    "MovingNumberStart",
    "MovingVector",
    "MovingVectorKeys",
    "MovingVectorLissajous",
    "MovingVectorLissajousNumbers",
    "MovingVectorStart",
    "Noise",
    "NoiseRotate",
    "NotifyTo",
    "NotifyWebhook",
    "Object",
    "Orbit",
    "OrbitNumbers",
    "Outer",
    "Output",
    "PathLightGrid",
    "Paths",
    "PathsSparse",
    "Pixels",
    "PlaneObject",
    "PlaneShape",
    "PointLight",
    "Position",
    "Quality",
    "Radiance",
    "RayleighLobe",
    "Reflectance",
    "Riemann",
    "Roulette",
    "Scene",
    "SceneScattering",
    "Shape",
    "Share",
    "Shiny",
    "Sides",
    "Size",
    "SlabBounds",
    "SphereBounds",
    "SphereLight",
    "SphereObject",
    "SphereShape",
    "SpotLight",
    "SunLight",
    "Texture",
    "Tracking",
    "TrackingMarched",
    "TransferGrid",
    "TransferMedium",
    "UnionObject",
]
