#!/bin/sh
# Exported tiles in a map: MapLibre (npm's maplibre-gl) in headless Chromium shows them as terrain and answers what heights it has there.
# Skipped where there is no Chromium, or the npm package can neither be found (MAPLIBRE=DIR, build/npm) nor fetched. The ground is the demo's
# (Trinidad, hills where it cannot be fetched) or RASTER=FILE; PICTURE=FILE.png keeps the picture.
exec /usr/bin/python3 "$(dirname "$0")/export_map.py"
