"""A cloud of soft balls as 64^3 voxels over [-1, 1]^3, in the files that the compared renderers read."""

GRID = 64


def lobes(np):
    """The density, indexed [z, y, x]: 0 at the grid's faces, 1 at its densest."""
    c = (np.arange(GRID) + 0.5) / GRID
    z, y, x = np.meshgrid(c, c, c, indexing="ij")
    density = np.zeros((GRID, GRID, GRID))
    for (cx, cy, cz), radius, height in [((0.4, 0.45, 0.5), 0.33, 1), ((0.65, 0.6, 0.4), 0.25, 0.8), ((0.5, 0.7, 0.65), 0.2, 1)]:
        square = (x - cx) ** 2 + (y - cy) ** 2 + (z - cz) ** 2
        density += height * np.clip(1 - square / radius**2, 0, None) ** 2
    return density / density.max()


def write_nrrd_and_vdb(np, folder):
    """Writes grid.nrrd for march-worker and grid.vdb for Blender; returns the 16 bits of both."""
    stored = np.round(lobes(np) * 65535).astype(np.uint16)
    spacing = 2 / GRID
    with open(f"{folder}/grid.nrrd", "wb") as out:
        out.write((f"NRRD0004\ntype: uint16\ndimension: 3\nspace dimension: 3\nsizes: {GRID} {GRID} {GRID}\n"
                   f"space directions: ({spacing},0,0) (0,{spacing},0) (0,0,{spacing})\n"
                   f"space origin: ({spacing / 2 - 1},{spacing / 2 - 1},{spacing / 2 - 1})\nendian: little\nencoding: raw\n\n").encode())
        out.write(stored.astype("<u2").tobytes())
    write_vdb(np, f"{folder}/grid.vdb", stored / 65535, spacing, [spacing / 2 - 1] * 3)
    return stored


def write_vdb(np, path, voxels, spacing, origin):
    """Voxels [z, y, x], the first one's centre at `origin`. Blender 3.4 shows voxels half a voxel too far along each axis."""
    import pyopenvdb

    grid = pyopenvdb.FloatGrid()
    grid.copyFromArray(np.ascontiguousarray(voxels.transpose(2, 1, 0), dtype=np.float32))
    grid.name = "density"
    grid.transform = pyopenvdb.createLinearTransform(voxelSize=spacing)
    grid.transform.translate([float(x) - spacing / 2 for x in origin])
    pyopenvdb.write(path, [grid])
