#!/bin/sh
# farfield-export --region … -o OUT.ffp: parts of packs, compared with the whole: records, heights, images, sizes and flights.
exec /usr/bin/python3 "$(dirname "$0")/export_region.py"
