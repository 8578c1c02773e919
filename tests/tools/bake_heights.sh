#!/bin/sh
# What the heights of a raster mean: voids, units, scales, encoded colours.
exec /usr/bin/python3 "$(dirname "$0")/bake_heights.py"
