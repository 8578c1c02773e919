"""Exported tiles in a map, run by export_map.sh."""
import base64
import glob
import http.server
import json
import os
import signal
import sys
import tarfile
import threading

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "rig"))
from rasters import *

HERE = os.path.dirname(os.path.abspath(__file__))
WAIT_S = 240
OWNER = "U.S. Geological Survey <i>& others</i>"
NAME = "MapLibre shows exported tiles as terrain; its heights are the ground's, within what was told"


def skip(why):
    print("ok - %s # skip %s" % (NAME, why))
    shutil.rmtree(work, ignore_errors=True)
    raise SystemExit(0)


def find_chromium():
    for name in ("chromium", "chromium-browser", "google-chrome"):
        if shutil.which(name):
            return shutil.which(name)
    return skip("no Chromium (Debian's package chromium)")


def find_maplibre():
    """The folder of the npm package's scripts."""
    kept = os.path.abspath("build/npm")
    for folder in (os.environ.get("MAPLIBRE", ""), kept + "/package/dist"):
        if folder and os.path.exists(folder + "/maplibre-gl.mjs"):
            return folder
    if not shutil.which("npm"):
        skip("no npm to fetch maplibre-gl with")
    os.makedirs(kept, exist_ok=True)
    try:
        done = subprocess.run(["npm", "pack", "--silent", "maplibre-gl@6"], cwd=kept, stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=120)
    except subprocess.TimeoutExpired:
        skip("npm does not answer")
    archives = glob.glob(kept + "/maplibre-gl-*.tgz")
    if done.returncode or not archives:
        skip("npm cannot fetch maplibre-gl")
    with tarfile.open(archives[0]) as archive:
        archive.extractall(kept)
    return kept + "/package/dist"


def find_trinidad():
    """The demo's ground, or None where it cannot be fetched."""
    try:
        done = subprocess.run([os.path.join(HERE, "../../tools/scripts/trinidad.sh"), "build/demo"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, timeout=120)
    except subprocess.TimeoutExpired:
        return None
    return done.stdout.strip() if done.returncode == 0 else None


def choose_raster():
    """(path, options of the bake)"""
    if os.environ.get("RASTER"):
        return os.environ["RASTER"], ()
    trinidad = find_trinidad()
    if trinidad:  # whole metres, kept as 3.28 times as many
        return trinidad, ("--scale", 0.3048780488)
    print("# no Trinidad to be had: hills")
    rows, columns = np.mgrid[0:400, 0:500]
    hills = 700 + 350 * np.sin(columns / 23) * np.cos(rows / 31) + 120 * np.sin(columns / 9 + rows / 14)
    return put("hills.tif", hills.astype(np.float32), place=(520000, 60, 0, 4140000, 0, -60), reference="EPSG:32613"), ()


def make_ground():
    """A pack, its tiles, and (longitude, latitude, height) at samples of it, in groups."""
    raster, options = choose_raster()
    for program, arguments in (("bake", (os.path.abspath(raster), "-o", "map.ffp", "--attribution", OWNER, *options)), ("export", ("map.ffp", "-o", "map.tif")), ("export", ("map.ffp", "-o", "tiles/"))):
        done = run(program, *arguments)
        assert done.returncode == 0, done.stderr
    print("# " + done.stderr.strip())
    raster = gdal.Open(os.path.join(work, "map.tif"))
    band, place = raster.GetRasterBand(1), raster.GetGeoTransform()
    heights = band.ReadAsArray() * (band.GetScale() or 1) + (band.GetOffset() or 0)
    if options:
        assert 4250 < heights.max() < 4374, heights.max()  # metres: Blanca Peak, which samples 80 m apart miss
    wgs84 = osr.SpatialReference()
    wgs84.ImportFromEPSG(4326)
    wgs84.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
    way = osr.CoordinateTransformation(raster.GetSpatialRef(), wgs84)
    groups = []
    for down in (0.5, 0.15, 0.85):
        for across in (0.5, 0.12, 0.88):
            middle_column, middle_row = int(across * heights.shape[1]), int(down * heights.shape[0])
            points = []
            for j in range(-20, 21, 4):
                for i in range(-20, 21, 4):
                    row, column = middle_row + j, middle_column + i
                    at = way.TransformPoint(place[0] + (column + 0.5) * place[1], place[3] + (row + 0.5) * place[5])
                    points.append((at[0], at[1], heights[row, column]))
            groups.append(points)
    return sorted(groups, key=lambda points: max(point[2] for point in points), reverse=True)  # the picture is of the highest


class Handler(http.server.BaseHTTPRequestHandler):
    scripts, ask, answer, ready = "", b"", None, threading.Event()

    def do_GET(self):
        name = self.path.split("?")[0]
        if name == "/ask.json":
            return self.give(self.ask, "application/json")
        folder = work if name.startswith("/tiles/") and not name.endswith(".html") else HERE if name.endswith(".html") else self.scripts
        path = os.path.join(folder, os.path.basename(name) if folder != work else name[1:])
        if not os.path.isfile(path):
            return self.send_error(404)
        kinds = {".html": "text/html", ".mjs": "text/javascript", ".css": "text/css", ".png": "image/png", ".json": "application/json"}
        return self.give(open(path, "rb").read(), kinds.get(os.path.splitext(path)[1], "application/octet-stream"))

    def give(self, data, kind):
        self.send_response(200)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(data)))
        self.end_headers()
        self.wfile.write(data)

    def do_POST(self):
        answer = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
        if Handler.answer is None or "heights" in answer:
            Handler.answer = answer
        self.give(b"", "text/plain")
        Handler.ready.set()

    def log_message(self, *_):
        pass


def show(chromium):
    """What the page answers."""
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    browser = subprocess.Popen([chromium, "--headless=new", "--no-sandbox", "--no-first-run", "--disable-dev-shm-usage", "--use-gl=angle", "--use-angle=swiftshader",
                                "--enable-unsafe-swiftshader", "--window-size=700,600", "--user-data-dir=" + os.path.join(work, "profile"),
                                "http://127.0.0.1:%d/tiles/export_map.html" % server.server_port], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
    Handler.ready.wait(WAIT_S)
    os.killpg(browser.pid, signal.SIGKILL)
    browser.wait()
    server.shutdown()
    return Handler.answer


def judge(groups, answer):
    assert answer, "the page did not answer within %d s" % WAIT_S
    assert "heights" in answer, answer
    told = json.load(open(os.path.join(work, "tiles/tiles.json")))
    picture = base64.b64decode(answer["picture"].split(",")[1])
    if os.environ.get("PICTURE"):
        open(os.environ["PICTURE"], "wb").write(picture)
    gdal.FileFromMemBuffer("/vsimem/picture", picture)
    colours = gdal.Open("/vsimem/picture").ReadAsArray()[:3].astype(int)
    wanted = np.array([height for points in groups for _, _, height in points])
    assert OWNER in answer["attribution"], answer["attribution"]
    assert None not in answer["heights"], answer["heights"]
    off = np.array(answer["heights"]) - wanted
    print("# %d heights: %.3f m rms, %.3f m at most, %.3f m told; heights %.0f to %.0f m" % (len(off), (off**2).mean()**0.5, abs(off).max(), told["error_m"], wanted.min(), wanted.max()))
    assert abs(off).max() <= told["error_m"] + 0.01, (abs(off).max(), told)
    rms = float(told["description"].split(" m rms")[0].split()[-1])  # of the finest zoom, all over the ground
    assert os.environ.get("RASTER") or (off**2).mean()**0.5 <= 1.5 * rms + 0.01, (off, told)
    assert colours.std() > 10, "the picture is of one colour"


chromium, scripts = find_chromium(), find_maplibre()
groups = make_ground()
Handler.scripts = scripts
# A zoom where the map surely has loaded the finest tiles: its terrain takes those of a zoom or two below its own.
zoom = json.load(open(os.path.join(work, "tiles/tiles.json")))["maxzoom"] + 2
Handler.ask = json.dumps({"zoom": zoom, "groups": [{"center": points[len(points) // 2][:2], "points": [point[:2] for point in points]} for points in groups]}).encode()


@case(NAME)
def _():
    judge(groups, show(chromium))


finish()
