// Extents as surfaces and outlines. An extent is a positive definite matrix X; its ellipsoid is c + L u, L L' = X, |u| = 1.

/** The lower triangle L of X, from the upper triangle of X row by row (`xx, xy, xz, yy, yz, zz`, in the plane `xx, xy, yy`); null where X is not positive definite. */
function root(upper) {
  if (!upper || !upper.every(isNumber)) return null;
  const n = upper.length === 6 ? 3 : 2;
  const x = (i, j) => (i > j ? x(j, i) : upper[n === 3 ? [0, 3, 5][i] + (j - i) : [0, 2][i] + (j - i)]);
  const l = Array.from({ length: n }, () => new Array(n).fill(0));
  for (let i = 0; i < n; i++)
    for (let j = 0; j <= i; j++) {
      let sum = x(i, j);
      for (let k = 0; k < j; k++) sum -= l[i][k] * l[j][k];
      if (i === j && !(sum > 0)) return null;
      l[i][j] = i === j ? Math.sqrt(sum) : sum / l[j][j];
    }
  return l;
}

/** No half axis is longer than this. */
const reach = (upper) => Math.sqrt(upper.length === 6 ? upper[0] + upper[3] + upper[5] : upper[0] + upper[2]);

const rings = 12, sides = 24;

/** Vertices and triangles of the ellipsoids of some entries, as one surface. */
function surfaces(entries) {
  const mesh = { x: [], y: [], z: [], i: [], j: [], k: [] };
  for (const { centre, extent } of entries) {
    const l = root(extent);
    if (!l || l.length !== 3) continue;
    const base = mesh.x.length;
    for (let r = 0; r <= rings; r++)
      for (let s = 0; s < sides; s++) {
        const polar = (Math.PI * r) / rings, turn = (2 * Math.PI * s) / sides;
        const u = [Math.sin(polar) * Math.cos(turn), Math.sin(polar) * Math.sin(turn), Math.cos(polar)];
        ["x", "y", "z"].forEach((axis, a) => mesh[axis].push(centre[a] + l[a][0] * u[0] + l[a][1] * u[1] + l[a][2] * u[2]));
      }
    for (let r = 0; r < rings; r++)
      for (let s = 0; s < sides; s++) {
        const a = base + r * sides + s, b = base + r * sides + ((s + 1) % sides);
        mesh.i.push(a, b); mesh.j.push(b, b + sides); mesh.k.push(a + sides, a + sides);
      }
  }
  return mesh;
}

/** Outlines of ellipses in the plane, as one line with gaps. */
function outlines(entries) {
  const line = { x: [], y: [] };
  for (const { centre, extent } of entries) {
    const l = root(extent);
    if (!l) continue;
    for (let s = 0; s <= 2 * sides; s++) {
      const turn = (Math.PI * s) / sides;
      line.x.push(centre[0] + l[0][0] * Math.cos(turn));
      line.y.push(centre[1] + l[1][0] * Math.cos(turn) + l[1][1] * Math.sin(turn));
    }
    line.x.push(null); line.y.push(null);
  }
  return line;
}
