#!/bin/sh
# Images of any make over the ground: palettes, greys, bits, alpha, masks and nodata.
exec /usr/bin/python3 "$(dirname "$0")/bake_colours.py"
