#!/bin/sh
# farfield-export: levels, regions, images, voids and map tiles, each compared with a surface that is known everywhere.
exec /usr/bin/python3 "$(dirname "$0")/export.py"
