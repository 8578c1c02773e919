// export_mesh.mjs CESIUM FOLDER POINTS [METRES]: reads the meshes in FOLDER with Cesium's own terrain provider (the npm package @cesium/engine in
// CESIUM), over HTTP, and compares heights at POINTS ("longitude latitude metres metres-to-the-rim", one a line) at every zoom for which
// layer.json states an error, which for the finest
// is METRES at most. Prints "ok - what" / "not ok - what".
import fs from 'node:fs';
import http from 'node:http';
import path from 'node:path';
import { pathToFileURL } from 'node:url';

const [cesium, folder, pointsFile, finest] = process.argv.slice(2);
const C = await import(pathToFileURL(path.join(cesium, 'node_modules/@cesium/engine/index.js')));
const layer = JSON.parse(fs.readFileSync(path.join(folder, 'layer.json')));
const packed = layer.encoding === 'gzip';
let failures = 0;

function result(holds, what, ...more) {
    console.log(`${holds ? 'ok' : 'not ok'} - ${what}`);
    for (const line of more) console.log(`#   ${line}`);
    if (!holds) failures++;
}

const server = http.createServer((request, answer) => {
    const file = path.join(folder, decodeURIComponent(request.url.split('?')[0]));
    if (!fs.existsSync(file) || fs.statSync(file).isDirectory()) return answer.writeHead(404).end();
    const head = { 'Content-Type': 'application/octet-stream' };
    if (packed && file.endsWith('.terrain')) head['Content-Encoding'] = 'gzip';
    answer.writeHead(200, head).end(fs.readFileSync(file));
});
await new Promise(ready => server.listen(0, '127.0.0.1', ready));
const provider = await C.CesiumTerrainProvider.fromUrl(`http://127.0.0.1:${server.address().port}/`, { requestVertexNormals: true });
const scheme = provider.tilingScheme;
const tiles = new Map();

async function tile(x, y, level) { // y from the north, as Cesium counts
    const key = `${level}/${x}/${y}`;
    if (!tiles.has(key)) {
        const asked = provider.getTileDataAvailable(x, y, level) ? provider.requestTileGeometry(x, y, level) : undefined;
        tiles.set(key, asked ? await asked : null);
    }
    return tiles.get(key);
}

result(await tile(0, 0, 0) && await tile(1, 0, 0), 'Cesium reads both tiles of zoom 0');
result(provider.hasVertexNormals === (layer.extensions || []).includes('octvertexnormals'), 'and sees normals where there are some');

// ---- heights ----
const points = fs.readFileSync(pointsFile, 'utf8').trim().split('\n').map(line => line.split(' ').map(Number));
let zooms = 0;
for (let level = layer.maxzoom; level >= 0; level--) {
    const bound = layer.errors_m[level];
    if (bound === null) continue;
    const cell = 180 / 64 / 2 ** level * 111320; // metres; nearer to the rim a cell has points without ground
    let worst = 0, sum = 0, count = 0, missing = 0;
    for (const [longitude, latitude, height, rim] of points) {
        if (rim < 1.5 * cell) continue;
        const at = C.Cartographic.fromDegrees(longitude, latitude), to = scheme.positionToTileXY(at, level);
        const data = await tile(to.x, to.y, level);
        if (!data) { missing++; continue; }
        const off = data.interpolateHeight(scheme.tileXYToRectangle(to.x, to.y, level), at.longitude, at.latitude) - height;
        worst = Math.max(worst, Math.abs(off));
        sum += off * off;
        count++;
    }
    if (!count && !missing) continue;
    zooms++;
    result(!missing && worst <= bound + 0.05, `zoom ${level}: heights at ${count} points are within the stated ${bound} m`,
        `${worst.toFixed(3)} m at most, ${Math.sqrt(sum / count).toFixed(3)} m rms, ${missing} without a tile`);
}
if (finest) result(layer.errors_m[layer.maxzoom] <= Number(finest), `the finest zoom states no more than ${finest} m`);
result(zooms >= 3, `${zooms} zooms were compared`);

// ---- what tiles say of themselves ----
let pairs = 0, unlike = 0, outside = 0, hidden = 0, unsound = 0;
const side = (data, indices, values) => [...indices].map(i => [values[i], data._minimumHeight + (data._maximumHeight - data._minimumHeight) * data._heightValues[i] / 32767])
    .sort((a, b) => a[0] - b[0]);
const alike = (a, b, step) => a.length === b.length && a.every((p, i) => p[0] === b[i][0] && Math.abs(p[1] - b[i][1]) <= step);
for (const [key, data] of tiles) {
    if (!data) continue;
    const [level, x, y] = key.split('/').map(Number), rectangle = scheme.tileXYToRectangle(x, y, level);
    const count = data._uValues.length, places = [];
    for (let i = 0; i < count; i++)
        places.push(C.Cartesian3.fromRadians(C.Math.lerp(rectangle.west, rectangle.east, data._uValues[i] / 32767), C.Math.lerp(rectangle.south, rectangle.north, data._vValues[i] / 32767),
            C.Math.lerp(data._minimumHeight, data._maximumHeight, data._heightValues[i] / 32767)));
    const sphere = data._boundingSphere;
    if (places.some(p => C.Cartesian3.distance(p, sphere.center) > sphere.radius * (1 + 1e-9) + 0.01)) outside++;
    const culling = new C.EllipsoidalOccluder(C.Ellipsoid.WGS84).computeHorizonCullingPoint(C.Rectangle.center(rectangle) && C.Cartesian3.fromRadians(
        (rectangle.west + rectangle.east) / 2, (rectangle.south + rectangle.north) / 2, (data._minimumHeight + data._maximumHeight) / 2), places);
    const ours = data._horizonOcclusionPoint;
    if (culling && C.Cartesian3.magnitude(culling) < 50 && C.Cartesian3.distance(culling, ours) > 1e-5 * C.Cartesian3.magnitude(culling)) hidden++;
    let area = 0;
    for (let t = 0; t < data._indices.length; t += 3) {
        const [a, b, c] = [0, 1, 2].map(k => data._indices[t + k]), u = data._uValues, v = data._vValues;
        const twice = (u[b] - u[a]) * (v[c] - v[a]) - (u[c] - u[a]) * (v[b] - v[a]);
        area += twice > 0 ? twice : NaN;
    }
    if (!(Math.abs(area / 2 / 32767 ** 2 - 1) < 1e-9)) unsound++;
    const step = other => (Math.max(data._maximumHeight - data._minimumHeight, other._maximumHeight - other._minimumHeight)) / 32767 + 1e-3;
    const east = tiles.get(`${level}/${x + 1}/${y}`), north = tiles.get(`${level}/${x}/${y - 1}`);
    if (east) { pairs++; unlike += !alike(side(data, data._eastIndices, data._vValues), side(east, east._westIndices, east._vValues), step(east)); }
    if (north) { pairs++; unlike += !alike(side(data, data._northIndices, data._uValues), side(north, north._southIndices, north._uValues), step(north)); }
}
result(pairs > 0 && !unlike, `the sides of ${pairs} pairs of tiles have the same vertices`, `${unlike} have not`);
result(!outside, 'spheres hold their tiles');
result(!hidden, 'points of the horizon are those that Cesium would compute');
result(!unsound, 'triangles cover each tile once, none of them upside down');
server.close();
process.exit(failures ? 1 : 0);
