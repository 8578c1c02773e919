#!/bin/sh
# farfield-merge: parts against the whole, fine ground in coarse ground, parts cut from a pack, refusals, random draws.
exec /usr/bin/python3 "$(dirname "$0")/merge.py"
