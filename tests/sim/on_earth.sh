#!/bin/sh
# Latitudes and longitudes in programs: --at, --to, columns of a flight, corners of a pack, against GDAL.
exec /usr/bin/python3 "$(dirname "$0")/on_earth.py"
